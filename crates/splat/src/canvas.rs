//! Accumulators: a pyramid of pictures of integer differences.
//!
//! Level ℓ has pixels of 2^ℓ. A run of light is written where it starts and where it ends, each as two taps that share one
//! integer; one running sum a row makes the picture of it. Both ends carry the same integer with opposite signs, so that
//! every row of every splat sums to exactly zero beyond its end: nothing leaks, wrapping in between is harmless, order does
//! not matter, and what was added can be taken away.
//!
//! Beside every row stands how much coverage was thrown at it. If the pixels of the row do not sum to that, one of
//! them has wrapped: it is never unseen.

use numerics::prefetch;
use salf::tree::{BLOCK_PX, LEVELS};

/// Bits behind the point of positions: 1/4096 px.
pub const POSITION_BITS: u32 = 12;

/// A pixel, as a position.
pub const PIXEL: i32 = 1 << POSITION_BITS;

/// An integer that differences are summed in.
pub trait Word: Copy + Default + Ord + Send + Sync {
    /// As a wide integer.
    fn wide(self) -> i64;
    /// As a float.
    fn float(self) -> f32;
    /// The sum, wrapping.
    fn plus(self, other: Self) -> Self;
    /// The difference, wrapping.
    fn minus(self, other: Self) -> Self;
    /// What it is made of: an unsigned integer of as many bits.
    type Bits: Copy + Default;
    /// Of a value that fits.
    fn bits(value: u64) -> Self::Bits;
    /// The integer of these bits.
    fn from_bits(bits: Self::Bits) -> Self;
    /// ⌊bits·part/4096⌋ of a value that fits; `part` ≤ 4096.
    fn scaled(bits: Self::Bits, part: u32) -> Self;
}

impl Word for i32 {
    #[inline(always)]
    fn wide(self) -> i64 {
        self as i64
    }
    #[inline(always)]
    fn float(self) -> f32 {
        self as f32
    }
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        self.wrapping_add(other)
    }
    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        self.wrapping_sub(other)
    }
    type Bits = u32;
    #[inline(always)]
    fn bits(value: u64) -> u32 {
        value as u32
    }
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        bits as i32
    }
    #[inline(always)]
    fn scaled(bits: u32, part: u32) -> Self {
        ((bits as u64 * part as u64) >> POSITION_BITS) as i32
    }
}

impl Word for i64 {
    #[inline(always)]
    fn wide(self) -> i64 {
        self
    }
    #[inline(always)]
    fn float(self) -> f32 {
        self as f32
    }
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        self.wrapping_add(other)
    }
    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        self.wrapping_sub(other)
    }
    type Bits = u64;
    #[inline(always)]
    fn bits(value: u64) -> u64 {
        value
    }
    #[inline(always)]
    fn from_bits(bits: u64) -> Self {
        bits as i64
    }
    #[inline(always)]
    fn scaled(bits: u64, part: u32) -> Self {
        ((bits * part as u64) >> POSITION_BITS) as i64
    }
}

/// Bytes that a processor fetches from memory at once.
const LINE: usize = 64;

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
    touched: Vec<Touched>,
}

/// Where a row was ever drawn on: a bit for each patch of its columns in memory that the first tap of an end of a run lies in;
/// the second may be the first column of the next patch.
#[derive(Clone, Copy, Debug, Default)]
struct Touched(u64);

impl Touched {
    /// The bits of a patch's columns, so that as many bits are enough for a row of `columns`: at least 16.
    fn patch_bits(columns: usize) -> u32 {
        columns.div_ceil(u64::BITS as usize).next_power_of_two().ilog2().max(4)
    }

    #[inline(always)]
    fn touch(&mut self, column: usize, patch_bits: u32) {
        self.0 |= 1 << (column >> patch_bits);
    }

    fn patches(self) -> u64 {
        self.0 | self.0 << 1
    }
}

/// A row of a level that was drawn on.
pub struct Row<'a, W> {
    /// The differences of its columns in memory.
    pub differences: &'a [Pixel<W>],
    /// The coverage added to the row.
    pub total: i64,
    /// Which patches of columns may be drawn on: a bit each.
    patches: u64,
    patch_bits: u32,
}

impl<W> Row<'_, W> {
    /// Whether there may be anything from a column on, and up to which one, at most `end`, that is so.
    #[inline(always)]
    pub fn stretch(&self, column: usize, end: usize) -> (bool, usize) {
        let patch = column >> self.patch_bits;
        let patches = self.patches >> patch;
        let is_touched = patches & 1 == 1;
        let count = if is_touched { patches.trailing_ones() } else { patches.trailing_zeros() };
        (is_touched, ((patch + count as usize) << self.patch_bits).min(end))
    }

    /// Asks for the memory of what was drawn on: stretches are too short for a processor to foresee them.
    pub fn prefetch(&self) {
        let (mut patches, pixels) = (self.patches, self.differences);
        while patches != 0 {
            let first = (patches.trailing_zeros() as usize) << self.patch_bits;
            for column in (first..first + (1 << self.patch_bits)).step_by(LINE / size_of::<Pixel<W>>()) {
                prefetch(pixels.get(column));
            }
            patches &= patches - 1;
        }
    }
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
    /// The levels, each of half the columns and rows of the one before.
    pub levels: Vec<Level<W>>,
}

impl<W: Word> Level<W> {
    /// Columns in memory: the border, and one more for the ends of what leaves the picture.
    fn stride(&self) -> usize {
        self.width + 3
    }

    /// Columns in memory that are summed: the picture's, and a border on either side.
    pub fn columns(&self) -> usize {
        self.width + 2
    }

    /// A row, from −1 to its height; `None` if it was never drawn on, or does not exist.
    pub fn row(&self, row: i32) -> Option<Row<'_, W>> {
        let place = (row + 1) as usize;
        let patches = self.touched.get(place)?.patches();
        // What leaves the picture ends in a column behind the border.
        let differences = &self.cells[place * self.stride()..][..self.columns()];
        let patch_bits = Touched::patch_bits(self.stride());
        (patches != 0).then_some(Row { differences, total: self.totals[place], patches, patch_bits })
    }
}

#[cfg(test)]
impl<W: Word> Level<W> {
    /// All pixels, border included, and the totals of the rows, both row by row.
    pub fn all(&self) -> (&[Pixel<W>], &[i64]) {
        (&self.cells, &self.totals)
    }
}

impl<W: Word> Accumulator<W> {
    /// An empty accumulator of `levels` levels, for a picture of `width` × `height` px; each level has half the
    /// columns and rows of the one before.
    pub fn new(width: usize, height: usize, levels: usize) -> Self {
        let level = |k: usize| {
            let [width, height] = [width, height].map(|side| side.div_ceil(1 << k));
            let cells = vec![[W::default(); 4]; (width + 3) * (height + 2)];
            Level {
                width,
                height,
                cells,
                totals: vec![0; height + 2],
                touched: vec![Touched::default(); height + 2],
            }
        };
        Self { levels: (0..levels).map(level).collect() }
    }

    /// The memory that it takes, in bytes.
    pub fn bytes(&self) -> usize {
        self.levels.iter().map(|level| size_of_val(&*level.cells) + size_of_val(&*level.totals)).sum()
    }

    /// Cut into bands that begin at these pixel rows, from 0 on, multiples of the coarsest level's pixel.
    pub fn bands(&mut self, starts: &[u32]) -> Vec<Canvas<'_, W>> {
        let mut canvases: Vec<_> =
            starts.iter().map(|_| Canvas { levels: Vec::with_capacity(LEVELS) }).collect();
        for (k, level) in self.levels.iter_mut().enumerate() {
            let (stride, width, height) = (level.stride(), level.width, level.height as i32);
            let (mut cells, mut totals) = (level.cells.as_mut_slice(), level.totals.as_mut_slice());
            let mut touched = level.touched.as_mut_slice();
            let mut first = -1;
            for (band, canvas) in canvases.iter_mut().enumerate() {
                let end = starts.get(band + 1).map_or(height + 1, |&start| start as i32 >> k);
                let here = (end - first) as usize;
                let (mine, rest) = cells.split_at_mut(here * stride);
                let (my_totals, rest_totals) = totals.split_at_mut(here);
                let (my_touched, rest_touched) = touched.split_at_mut(here);
                (cells, totals, touched) = (rest, rest_totals, rest_touched);
                let patch_bits = Touched::patch_bits(stride);
                let (cells, totals, touched) = (mine, my_totals, my_touched);
                let rows = Rows { first, end, width, patch_bits, cells, totals, touched };
                canvas.levels.push(rows);
                first = end;
            }
        }
        canvases
    }
}

#[cfg(test)]
impl<W: Word> Accumulator<W> {
    /// A canvas over all rows of all levels, to draw on.
    pub fn canvas(&mut self) -> Canvas<'_, W> {
        self.bands(&[0]).remove(0)
    }
}

/// Some rows of each level, to draw on.
pub struct Canvas<'a, W> {
    /// The rows of each level, finest first.
    pub levels: Vec<Rows<'a, W>>,
}

/// Some rows of one level.
pub struct Rows<'a, W> {
    /// The first row; −1 is the border.
    pub first: i32,
    /// The row behind the last one.
    pub end: i32,
    width: usize,
    patch_bits: u32,
    cells: &'a mut [Pixel<W>],
    totals: &'a mut [i64],
    touched: &'a mut [Touched],
}

impl<W: Word> Rows<'_, W> {
    /// The same rows, for a loop to have all that they are at hand.
    #[inline(always)]
    pub fn borrowed(&mut self) -> Rows<'_, W> {
        let Self { first, end, width, patch_bits, ref mut cells, ref mut totals, ref mut touched } = *self;
        Rows { first, end, width, patch_bits, cells, totals, touched }
    }

    /// Sets all pixels of the rows to 0.
    pub fn clear(&mut self) {
        let stride = self.width + 3;
        for (place, touched) in self.touched.iter_mut().enumerate() {
            let row = &mut self.cells[place * stride..][..stride];
            let mut patches = touched.patches();
            while patches != 0 {
                let patch = patches.trailing_zeros() as usize;
                // There may be none behind the last.
                let [first, end] = [patch, patch + 1].map(|patch| (patch << self.patch_bits).min(stride));
                row[first..end].fill([W::default(); 4]);
                patches &= patches - 1;
            }
            self.totals[place] = 0;
            *touched = Touched::default();
        }
    }

    /// The position `x`, in 1/4096 px, moved no further outside than positions need to be told apart.
    #[inline(always)]
    pub fn clamped(&self, x: i32) -> i32 {
        x.clamp(-4 * PIXEL, (self.width as i32 + 4) << POSITION_BITS)
    }

    /// Asks for the memory of the block of pixels about a position (1/4096 px).
    pub fn prefetch_block(&self, [x, y]: [i32; 2]) {
        const SIDE: i32 = BLOCK_PX;
        let [column, row] = [x, y].map(|at| (at >> POSITION_BITS) & -SIDE);
        for row in row.max(self.first)..(row + SIDE).min(self.end) {
            let line = &self.cells[(row - self.first) as usize * (self.width + 3)..];
            // Four pixels a line of the cache.
            for column in (column + 1..column + 1 + SIDE).step_by(4) {
                prefetch(line.get(column as usize));
            }
        }
    }

    /// Whether a column is one of the picture's, or the border's before it (−1).
    #[inline(always)]
    pub fn has_column(&self, column: i32) -> bool {
        (-1..self.width as i32).contains(&column)
    }

    /// Adds (`sign` 1) or takes away (−1) the light of one pixel, as [`Self::add_run`] would; nothing in rows that are not
    /// these.
    #[inline(always)]
    pub fn add_pixel(&mut self, row: i32, column: i32, value: [u64; 4], sign: i32) {
        if !(self.first..self.end).contains(&row) {
            return;
        }
        let place = (row - self.first) as usize;
        // The border is column 0.
        let first = (column + 1) as usize;
        let mut whole = [W::default(); 4];
        for c in 0..4 {
            whole[c] = W::from_bits(W::bits(value[c]));
        }
        let cells = &mut self.cells[place * (self.width + 3) + first..][..2];
        add(&mut cells[0], &whole, sign);
        add(&mut cells[1], &whole, -sign);
        self.touched[place].touch(first, self.patch_bits);
        let (total, thrown) = (&mut self.totals[place], whole[3].wide());
        *total = if sign < 0 { total.wrapping_sub(thrown) } else { total.wrapping_add(thrown) };
    }

    /// Adds (`sign` 1) or takes away (−1) light from `start` to `end` ≥ `start` (1/4096 px) of a row: `value` a pixel.
    #[inline(always)]
    pub fn add_run(&mut self, row: i32, start: i32, end: i32, value: [u64; 4], sign: i32) {
        let stride = self.width + 3;
        let place = (row - self.first) as usize;
        let line = &mut self.cells[place * stride..][..stride];
        let (touched, patch_bits) = (&mut self.touched[place], self.patch_bits);
        let run = Run { start, end, value };
        let [first, second] = run.columns();
        // Columns before the border are far beyond the last one too.
        let total = if first + 1 < line.len() && second + 1 < line.len() {
            let Ends { whole, begun, ended } = run.ends::<W>();
            add(&mut line[first], &begun, sign);
            add(&mut line[first + 1], &remaining_part(&whole, &begun), sign);
            add(&mut line[second], &ended, -sign);
            add(&mut line[second + 1], &remaining_part(&whole, &ended), -sign);
            touched.touch(first, patch_bits);
            touched.touch(second, patch_bits);
            whole[3].wide() * (second as i64 - first as i64) + begun[3].wide() - ended[3].wide()
        } else {
            run.add_beyond(line, touched, patch_bits, sign)
        };
        let row = &mut self.totals[place];
        *row = if sign < 0 { row.wrapping_sub(total) } else { row.wrapping_add(total) };
    }
}

/// Light in a row from `start` to `end`, 1/4096 px: `value` a pixel.
#[derive(Clone, Copy)]
struct Run {
    start: i32,
    end: i32,
    value: [u64; 4],
}

/// A pixel of a run, and what of it falls into the nearer column at either end.
struct Ends<W> {
    whole: Pixel<W>,
    begun: Pixel<W>,
    ended: Pixel<W>,
}

impl Run {
    /// The nearer columns of its ends in memory; the border is column 0. Those before it count as far beyond all.
    #[inline(always)]
    fn columns(&self) -> [usize; 2] {
        [self.start, self.end].map(|at| (((at >> POSITION_BITS) + 1) as u32 as usize).min(usize::MAX - 1))
    }

    #[inline(always)]
    fn ends<W: Word>(&self) -> Ends<W> {
        let (mut bits, mut whole) = ([W::Bits::default(); 4], [W::default(); 4]);
        for c in 0..4 {
            bits[c] = W::bits(self.value[c]);
            whole[c] = W::from_bits(bits[c]);
        }
        Ends { whole, begun: near_part::<W>(&bits, self.start), ended: near_part::<W>(&bits, self.end) }
    }

    /// Adds it to a row from which it extends. Returns the coverage added to the row.
    #[cold]
    #[inline(never)]
    fn add_beyond<W: Word>(
        self,
        line: &mut [Pixel<W>],
        touched: &mut Touched,
        patch_bits: u32,
        sign: i32,
    ) -> i64 {
        let Ends { whole, begun, ended } = self.ends::<W>();
        let last = line.len() - 1;
        let mut throw = |at: i32, near: &Pixel<W>, sign: i32| {
            let far = remaining_part(&whole, near);
            let column = (at >> POSITION_BITS) + 1;
            let [first, second] = [column, column + 1].map(|column| column.clamp(0, last as i32) as usize);
            add(&mut line[first], near, sign);
            add(&mut line[second], &far, sign);
            touched.touch(first, patch_bits);
            near[3].wide() * (last - first) as i64 + far[3].wide() * (last - second) as i64
        };
        throw(self.start, &begun, sign) - throw(self.end, &ended, -sign)
    }
}

/// What of a pixel's `value` falls into the nearer of the two columns that the position `at` lies between.
#[inline(always)]
fn near_part<W: Word>(value: &[W::Bits; 4], at: i32) -> Pixel<W> {
    let part = (PIXEL - (at & (PIXEL - 1))) as u32;
    let mut near = [W::default(); 4];
    for c in 0..4 {
        near[c] = W::scaled(value[c], part);
    }
    near
}

/// What `near` leaves of `whole`.
#[inline(always)]
fn remaining_part<W: Word>(whole: &Pixel<W>, near: &Pixel<W>) -> Pixel<W> {
    let mut rest = [W::default(); 4];
    for c in 0..4 {
        rest[c] = whole[c].minus(near[c]);
    }
    rest
}

#[inline(always)]
fn add<W: Word>(sum: &mut Pixel<W>, pixel: &Pixel<W>, sign: i32) {
    for c in 0..4 {
        sum[c] = if sign < 0 { sum[c].minus(pixel[c]) } else { sum[c].plus(pixel[c]) };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixels<W: Word>(accumulator: &Accumulator<W>, row: i32) -> Option<Vec<[i64; 4]>> {
        let level = &accumulator.levels[0];
        let mut pixels = vec![[0; 4]; level.width + 2];
        let Some(row) = level.row(row) else { return Some(pixels) };
        let (mut sum, mut covered) = ([W::default(); 4], 0);
        for (pixel, difference) in pixels.iter_mut().zip(row.differences) {
            add(&mut sum, difference, 1);
            *pixel = sum.map(W::wide);
            covered += pixel[3];
        }
        (covered == row.total).then_some(pixels)
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
        let bands = accumulator.bands(&[0, 64, 128]);
        assert_eq!(bands.len(), 3);
        for (k, height) in heights.into_iter().enumerate() {
            let rows: Vec<_> = bands.iter().map(|band| (band.levels[k].first, band.levels[k].end)).collect();
            assert_eq!((rows[0].0, rows[2].1), (-1, height + 1));
            assert!(rows.windows(2).all(|pair| pair[0].1 == pair[1].0));
        }
    }
}
