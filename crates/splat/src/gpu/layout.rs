//! How accumulators lie in the card's memory.

/// What a row's total is split into, so that not all threads add to one word.
pub const SLOTS: usize = 8;

/// Where the levels of an accumulator lie in its buffer.
pub struct Layout {
    pub levels: Vec<Level>,
    /// In all.
    pub words: usize,
    /// Pixels of its lines: all levels with their borders.
    pub lines: usize,
}

/// A level of an accumulator.
#[derive(Clone, Copy)]
pub struct Level {
    /// Without the border.
    pub width: usize,
    /// Without the border.
    pub height: usize,
    /// Words before its pixels, and before its totals.
    pub pixels: u32,
    /// See `pixels`.
    pub totals: u32,
    /// Pixels before its lines.
    pub lines: u32,
}

impl Layout {
    /// The layout of sums of a picture of `width` × `height` px, with this many levels and words per pixel.
    pub fn new([width, height]: [usize; 2], levels: usize, words_of_pixel: usize) -> Self {
        let mut layout = Self { levels: Vec::new(), words: 0, lines: 0 };
        for k in 0..levels {
            let [width, height] = [width, height].map(|side| side.div_ceil(1 << k));
            let pixels = layout.words;
            let totals = pixels + (width + 3) * (height + 2) * words_of_pixel;
            layout.words = totals + 2 * SLOTS * (height + 2);
            let lines = layout.lines as u32;
            layout.lines += (width + 2) * (height + 2);
            layout.levels.push(Level { width, height, pixels: pixels as u32, totals: totals as u32, lines });
        }
        layout
    }
}
