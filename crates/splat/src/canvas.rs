//! Accumulators: a pyramid of pictures of integer differences.
//!
//! Level ℓ has pixels of 2^ℓ. A run of light is written where it starts and where it ends, each as two taps that share one
//! integer; one running sum a row makes the picture of it. Both ends carry the same integer with opposite signs, so that
//! every row of every splat sums to exactly zero beyond its end: nothing leaks, wrapping in between is harmless, order does
//! not matter, and what was added can be taken away.
//!
//! Beside every row stands how much coverage was thrown at it. If the pixels of the row do not sum to that, one of
//! them has wrapped: it is never unseen.

use salf::tree::LEVELS;

/// Bits behind the point of positions: 1/4096 px.
pub const POSITION_BITS: u32 = 12;

/// A pixel, as a position.
pub const PIXEL: i32 = 1 << POSITION_BITS;

/// An integer that differences are summed in.
pub trait Word: Copy + Default + PartialEq + Send + Sync {
    /// As a wide integer.
    fn wide(self) -> i64;
    /// The sum, wrapping.
    fn plus(self, other: Self) -> Self;
    /// ⌊value·(4096 − fraction)/4096⌋ and what that leaves of it, both times `sign`; of a value that fits.
    fn split(value: u64, fraction: u32, sign: i32) -> [Self; 2];
}

impl Word for i32 {
    #[inline(always)]
    fn wide(self) -> i64 {
        self as i64
    }
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        self.wrapping_add(other)
    }
    #[inline(always)]
    fn split(value: u64, fraction: u32, sign: i32) -> [Self; 2] {
        // Both factors have 32 bits.
        let near = ((value & u32::MAX as u64) * (PIXEL as u32 - fraction) as u64) >> POSITION_BITS;
        [(near as i32).wrapping_mul(sign), (value as i32).wrapping_sub(near as i32).wrapping_mul(sign)]
    }
}

impl Word for i64 {
    #[inline(always)]
    fn wide(self) -> i64 {
        self
    }
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        self.wrapping_add(other)
    }
    #[inline(always)]
    fn split(value: u64, fraction: u32, sign: i32) -> [Self; 2] {
        let near = (value * (PIXEL as u32 - fraction) as u64) >> POSITION_BITS;
        [sign as i64 * near as i64, sign as i64 * (value - near) as i64]
    }
}

/// Red, green, blue and coverage.
pub type Pixel<W> = [W; 4];

/// Rows of one level, border included: pixel (−1, −1) comes first.
#[derive(Clone)]
pub struct Level<W> {
    /// Columns without the border.
    pub width: usize,
    /// Rows without the border.
    pub height: usize,
    cells: Vec<Pixel<W>>,
    totals: Vec<i64>,
    /// Rows that were ever drawn on.
    touched: Vec<bool>,
}

/// Levels are equal if they hold the same sums; where they were drawn on does not matter.
impl<W: Word> PartialEq for Level<W> {
    fn eq(&self, other: &Self) -> bool {
        (self.width, self.height) == (other.width, other.height)
            && self.cells == other.cells
            && self.totals == other.totals
    }
}

/// A pyramid of accumulators.
#[derive(Clone, PartialEq)]
pub struct Accumulator<W: Word> {
    pub levels: Vec<Level<W>>,
}

impl<W: Word> Level<W> {
    /// Columns in memory: the border, and one more for the ends of what leaves the picture.
    fn stride(&self) -> usize {
        self.width + 3
    }

    /// A row, from −1 to its height, and the coverage thrown at it; `None` if it was never drawn on.
    pub fn row(&self, row: i32) -> Option<(&[Pixel<W>], i64)> {
        let place = (row + 1) as usize;
        let line = &self.cells[place * self.stride()..(place + 1) * self.stride()];
        self.touched[place].then_some((line, self.totals[place]))
    }
}

#[cfg(test)]
impl<W: Word> Level<W> {
    /// All pixels, border included, and the totals of the rows.
    pub fn all(&self) -> (&[Pixel<W>], &[i64]) {
        (&self.cells, &self.totals)
    }
}

impl<W: Word> Accumulator<W> {
    /// An empty one, of `levels` levels, for a picture of this size.
    pub fn new(width: usize, height: usize, levels: usize) -> Self {
        let level = |k: usize| {
            let [width, height] = [width, height].map(|side| side.div_ceil(1 << k));
            let cells = vec![[W::default(); 4]; (width + 3) * (height + 2)];
            Level { width, height, cells, totals: vec![0; height + 2], touched: vec![false; height + 2] }
        };
        Self { levels: (0..levels).map(level).collect() }
    }

    /// Bytes in memory.
    pub fn bytes(&self) -> usize {
        self.levels.iter().map(|level| size_of_val(&*level.cells) + size_of_val(&*level.totals)).sum()
    }

    /// All of it, to draw on.
    pub fn canvas(&mut self) -> Canvas<'_, W> {
        self.bands(i32::MAX).remove(0)
    }

    /// Cut into bands of `rows` pixel rows each, a multiple of the coarsest level's pixel.
    pub fn bands(&mut self, rows: i32) -> Vec<Canvas<'_, W>> {
        let height = self.levels[0].height as i32;
        let count = (height as usize).div_ceil(rows as usize).max(1) as i32;
        let mut canvases: Vec<_> =
            (0..count).map(|_| Canvas { levels: Vec::with_capacity(LEVELS) }).collect();
        for (k, level) in self.levels.iter_mut().enumerate() {
            let (stride, width, height) = (level.stride(), level.width, level.height as i32);
            let (mut cells, mut totals) = (level.cells.as_mut_slice(), level.totals.as_mut_slice());
            let mut touched = level.touched.as_mut_slice();
            let mut first = -1;
            for (band, canvas) in canvases.iter_mut().enumerate() {
                let is_last = band as i32 + 1 == count;
                let end = if is_last { height + 1 } else { (band as i32 + 1) * (rows >> k) };
                let here = (end - first) as usize;
                let (mine, rest) = cells.split_at_mut(here * stride);
                let (my_totals, rest_totals) = totals.split_at_mut(here);
                let (my_touched, rest_touched) = touched.split_at_mut(here);
                (cells, totals, touched) = (rest, rest_totals, rest_touched);
                let rows = Rows { first, end, width, cells: mine, totals: my_totals, touched: my_touched };
                canvas.levels.push(rows);
                first = end;
            }
        }
        canvases
    }
}

/// Some rows of each level, to draw on.
pub struct Canvas<'a, W> {
    pub levels: Vec<Rows<'a, W>>,
}

/// Some rows of one level.
pub struct Rows<'a, W> {
    /// The first row; −1 is the border.
    pub first: i32,
    /// The row behind the last one.
    pub end: i32,
    width: usize,
    cells: &'a mut [Pixel<W>],
    totals: &'a mut [i64],
    touched: &'a mut [bool],
}

impl<W: Word> Canvas<'_, W> {
    /// Makes it black.
    pub fn clear(&mut self) {
        for rows in &mut self.levels {
            let stride = rows.width + 3;
            for (place, touched) in rows.touched.iter_mut().enumerate().filter(|(_, touched)| **touched) {
                rows.cells[place * stride..(place + 1) * stride].fill([W::default(); 4]);
                rows.totals[place] = 0;
                *touched = false;
            }
        }
    }
}

impl<W: Word> Rows<'_, W> {
    /// A position (1/4096 px) no further outside than needs be told apart.
    #[inline(always)]
    pub fn clamped(&self, x: i32) -> i32 {
        x.clamp(-4 * PIXEL, (self.width as i32 + 4) << POSITION_BITS)
    }

    /// Adds (`sign` 1) or takes away (−1) light from `start` to `end` (1/4096 px) of a row: `value` a pixel.
    #[inline(always)]
    pub fn add_run(&mut self, row: i32, start: i32, end: i32, value: [u64; 4], sign: i32) {
        let stride = self.width + 3;
        let last = stride as i32 - 1;
        let place = (row - self.first) as usize;
        let line = &mut self.cells[place * stride..(place + 1) * stride];
        let mut total = 0;
        for (at, sign) in [(start, sign), (end, -sign)] {
            // The border is column 0.
            let (column, fraction) = ((at >> POSITION_BITS) + 1, (at & (PIXEL - 1)) as u32);
            let (first, second) = (column.clamp(0, last), (column + 1).clamp(0, last));
            let (mut near, mut far) = ([W::default(); 4], [W::default(); 4]);
            for c in 0..4 {
                [near[c], far[c]] = W::split(value[c], fraction, sign);
            }
            add(&mut line[first as usize], &near);
            add(&mut line[second as usize], &far);
            total += near[3].wide() * (last - first) as i64 + far[3].wide() * (last - second) as i64;
        }
        self.totals[place] = self.totals[place].wrapping_add(total);
        self.touched[place] = true;
    }
}

#[inline(always)]
fn add<W: Word>(sum: &mut Pixel<W>, pixel: &Pixel<W>) {
    for c in 0..4 {
        sum[c] = sum[c].plus(pixel[c]);
    }
}

/// The pixels of a row from its differences, border included. `None` if one of them has wrapped.
pub fn integrated<W: Word>(line: &[Pixel<W>], total: i64, pixels: &mut [Pixel<i64>]) -> Option<()> {
    let mut sum = [W::default(); 4];
    let mut covered = 0i64;
    for (pixel, difference) in pixels.iter_mut().zip(line) {
        add(&mut sum, difference);
        for c in 0..4 {
            pixel[c] = sum[c].wide();
        }
        covered = covered.wrapping_add(pixel[3]);
    }
    (covered == total).then_some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixels<W: Word>(accumulator: &Accumulator<W>, row: i32) -> Option<Vec<[i64; 4]>> {
        let level = &accumulator.levels[0];
        let mut pixels = vec![[0; 4]; level.width + 2];
        let Some((line, total)) = level.row(row) else { return Some(pixels) };
        integrated(line, total, &mut pixels)?;
        Some(pixels)
    }

    #[test]
    fn a_run_is_exact_and_leaves_nothing_behind() {
        for (start, end) in
            [(5 << 12, 9 << 12), (21337, 24500), (-50000, 7000), (7000, 90000), (-90000, 90000)]
        {
            let mut accumulator = Accumulator::<i32>::new(20, 4, 1);
            accumulator.canvas().levels[0].add_run(2, start, end, [1000, 7, 0, 100_000], 1);
            let row = pixels(&accumulator, 2).expect("nothing wraps");
            for (x, pixel) in row.iter().enumerate() {
                let left = (x as i32 - 1) * PIXEL;
                let inside = (end.min(left + PIXEL) - start.max(left)).max(0) as i64;
                assert!((pixel[3] - 100_000 * inside / PIXEL as i64).abs() <= 1, "{start} {x}: {pixel:?}");
            }
            assert_eq!(pixels(&accumulator, 1).unwrap(), vec![[0; 4]; 22]);
            accumulator.canvas().levels[0].add_run(2, start, end, [1000, 7, 0, 100_000], -1);
            assert!(accumulator.levels[0].cells.iter().all(|cell| *cell == [0; 4]));
            assert!(accumulator.levels[0].totals.iter().all(|total| *total == 0));
        }
    }

    #[test]
    fn a_wrapped_pixel_is_noticed() {
        let mut accumulator = Accumulator::<i32>::new(20, 4, 1);
        for k in 0..3 {
            assert!(pixels(&accumulator, 0).is_some(), "{k} fit");
            accumulator.canvas().levels[0].add_run(0, 16000, 48000, [0, 0, 0, 3 << 28], 1);
        }
        assert!(pixels(&accumulator, 0).is_none());
        let mut wide = Accumulator::<i64>::new(20, 4, 1);
        (0..3).for_each(|_| wide.canvas().levels[0].add_run(0, 16000, 48000, [0, 0, 0, 3 << 28], 1));
        assert!(pixels(&wide, 0).is_some());
    }

    #[test]
    fn bands_cover_every_row_of_every_level_once() {
        let mut accumulator = Accumulator::<i32>::new(50, 150, LEVELS);
        let heights: Vec<_> = accumulator.levels.iter().map(|level| level.height as i32).collect();
        let bands = accumulator.bands(64);
        assert_eq!(bands.len(), 3);
        for (k, height) in heights.into_iter().enumerate() {
            let rows: Vec<_> = bands.iter().map(|band| (band.levels[k].first, band.levels[k].end)).collect();
            assert_eq!((rows[0].0, rows[2].1), (-1, height + 1));
            assert!(rows.windows(2).all(|pair| pair[0].1 == pair[1].0));
        }
    }
}
