//! Accumulators to pictures: running sums, and each level upsampled onto the next finer one.

pub mod balance;
pub mod knots;
pub mod marks;
pub mod partition;
pub mod parts_to_pixels;

use crate::canvas::{Accumulator, Level, Pixel, Row, Word};
use crate::resolve::marks::{Mark, Marks, SPAN, spans};
use numerics::with_widest_simd;
use std::ops::Range;

/// A pixel holds more light than its integers are sure to hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Overflow;

/// A rectangle of pixels of a level, in its rows and columns; −1 is the border.
#[derive(Clone, Debug)]
pub struct Window {
    /// The rows of the level.
    pub rows: Range<i32>,
    /// The columns of the level.
    pub columns: Range<i32>,
}

impl Window {
    /// What of a coarser level's pixels this one's are made of.
    fn on_level(&self, level: usize) -> Self {
        let coarse = |fine: &Range<i32>| match level {
            0 => fine.clone(),
            _ => (fine.start >> level) - MARGIN..((fine.end - 1) >> level) + MARGIN + 1,
        };
        Self { rows: coarse(&self.rows), columns: coarse(&self.columns) }
    }

    /// That of it which a level has.
    fn within<W: Word>(self, level: &Level<W>) -> Self {
        let within = |range: Range<i32>, side: usize| range.start.max(-1)..range.end.min(side as i32 + 1);
        Self { rows: within(self.rows, level.height), columns: within(self.columns, level.width) }
    }
}

/// How many pixels of a coarse level are needed beside those under the requested ones, for upsampling.
pub const MARGIN: i32 = 4;

/// Red, green, blue and coverage, each 1 for a pixel of radiance 1.
pub type Light = [f32; 4];

/// A pixel without light.
pub const BLACK: Light = [0.0; 4];

/// The pixels of a window of a level, row by row.
struct Lines {
    window: Window,
    pixels: Vec<Light>,
}

impl Lines {
    /// A row, or the first or last one if it lies beyond.
    fn nearest_row(&self, row: i32) -> &[Light] {
        let (rows, width) = (&self.window.rows, self.window.columns.len());
        let at = row.clamp(rows.start, rows.end - 1) - rows.start;
        &self.pixels[at as usize * width..][..width]
    }
}

/// Room for pixels, used again and again.
#[derive(Default)]
pub struct Room(Vec<Vec<Light>>);

impl Room {
    /// A list of `count` pixels of any content, reused if possible.
    pub fn take(&mut self, count: usize) -> Vec<Light> {
        let mut pixels = self.0.pop().unwrap_or_default();
        pixels.resize(count, BLACK);
        pixels
    }

    /// Takes a list of pixels for reuse.
    pub fn recycle(&mut self, pixels: Vec<Light>) {
        self.0.push(pixels);
    }
}

/// How integers become numbers.
#[derive(Clone, Copy, Debug)]
pub struct Quanta {
    /// One quantum.
    pub quantum: f64,
    /// A pixel of this coverage, in quanta, may hold a colour that has wrapped.
    pub largest_coverage: i64,
}

impl Quanta {
    /// Of sums in `word_bits` bits with 2^`bits` quanta to a pixel of 1, where no radiance is above `brightest`.
    pub fn new(bits: i32, word_bits: i32, brightest: f64) -> Self {
        let largest = ((word_bits - 1) as f64).exp2() / brightest.max(1.0);
        Self { quantum: (-bits as f64).exp2(), largest_coverage: largest.min(i64::MAX as f64 / 2.0) as i64 }
    }
}

/// The rows of a level's pixels, and of what is coarser, in some columns: each is made when it is read, while it is near.
pub struct LevelRows<'a, W: Word> {
    level: &'a Level<W>,
    quanta: Quanta,
    columns: Columns,
    /// What the coarser levels hold together; `None` if they are black.
    coarser: Option<Lines>,
    /// A row between those of the coarser ones, and a pixel beside either end.
    mixed: Vec<Light>,
    /// The largest coverage of a pixel so far, in quanta, coarser levels' too.
    pub largest: i64,
}

impl<'a, W: Word> LevelRows<'a, W> {
    /// The rows of a sum in a window of the picture.
    ///
    /// # Errors
    /// A sum has overflowed.
    pub fn for_sum(
        accumulator: &'a Accumulator<W>,
        quanta: Quanta,
        window: &Window,
        room: &mut Room,
    ) -> Result<Self, Overflow> {
        let (mut coarser, mut largest): (Option<Lines>, i64) = (None, 0);
        for (k, level) in accumulator.levels.iter().enumerate().skip(1).rev() {
            let window = window.on_level(k).within(level);
            if coarser.is_none() && window.rows.clone().all(|row| level.row(row).is_none()) {
                continue;
            }
            let mut here = Self::new(level, quanta, Columns::unmarked(&window.columns, level), coarser, room);
            let mut pixels = room.take(window.rows.len() * window.columns.len());
            let mut unkept = Marks::empty(0..1, level.columns());
            for (row, line) in window.rows.clone().zip(pixels.chunks_exact_mut(window.columns.len().max(1))) {
                here.read(row, unkept.row(0), line)?;
            }
            largest = largest.max(here.largest);
            here.recycle(room);
            coarser = Some(Lines { window, pixels });
        }
        let finest =
            Self::new(&accumulator.levels[0], quanta, Columns::marked(&window.columns), coarser, room);
        Ok(Self { largest, ..finest })
    }

    fn new(
        level: &'a Level<W>,
        quanta: Quanta,
        columns: Columns,
        coarser: Option<Lines>,
        room: &mut Room,
    ) -> Self {
        let mixed = room.take(coarser.as_ref().map_or(0, |coarser| coarser.window.columns.len() + 2));
        Self { level, quanta, columns, coarser, mixed, largest: 0 }
    }

    /// Gives the lists of pixels back to `room`.
    pub fn recycle(self, room: &mut Room) {
        room.recycle(self.mixed);
        self.coarser.into_iter().for_each(|coarser| room.recycle(coarser.pixels));
    }

    /// Sets `line` to the pixels of row `row`; `marks` are the row's.
    ///
    /// # Errors
    /// A sum has overflowed.
    pub fn read(&mut self, row: i32, marks: &mut [Mark<W>], line: &mut [Light]) -> Result<(), Overflow> {
        match &self.coarser {
            Some(coarser) => with_widest_simd(
                #[inline(always)]
                || upsample(coarser, row, self.columns.in_memory.start as i32 - 1, &mut self.mixed, line),
            ),
            None => line.fill(BLACK),
        }
        let largest = add_row::<W, 4>(self.level, row, &self.columns, self.quanta, marks, line)?;
        self.largest = self.largest.max(largest);
        Ok(())
    }
}

/// Requested columns of a level.
#[derive(Clone)]
pub struct Columns {
    /// Where they lie in memory, behind the border.
    in_memory: Range<usize>,
    /// The spans that are summed.
    spans: Range<usize>,
}

impl Columns {
    /// Of a level whose marks are kept: those outside of these columns are those of the last time.
    pub fn marked(columns: &Range<i32>) -> Self {
        let in_memory = (columns.start + 1) as usize..(columns.end + 1) as usize;
        Self { spans: spans(&in_memory), in_memory }
    }

    /// Of a level that has no marks: rows are summed from their beginning to their end.
    fn unmarked<W: Word>(columns: &Range<i32>, level: &Level<W>) -> Self {
        Self { spans: 0..level.columns().div_ceil(SPAN), ..Self::marked(columns) }
    }
}

/// Adds the first `CHANNELS` channels of a row of a level's pixels in some columns. `marks` are the row's. Returns
/// the largest coverage that was met, in quanta.
///
/// # Errors
/// A sum has overflowed.
pub fn add_row<W: Word, const CHANNELS: usize>(
    level: &Level<W>,
    row: i32,
    Columns { in_memory, spans }: &Columns,
    quanta: Quanta,
    marks: &mut [Mark<W>],
    line: &mut [Light],
) -> Result<i64, Overflow> {
    if let Some(next) = level.row(row + 1) {
        next.prefetch();
    }
    let Some(row) = level.row(row) else {
        marks.fill(Mark::default());
        return Ok(0);
    };
    let largest = with_widest_simd(
        #[inline(always)]
        || integrate::<W, CHANNELS>(&row, quanta, in_memory, line, &mut marks[spans.clone()], spans.start),
    )?;
    let covered: i64 = marks.iter().fold(0, |sum, mark| sum.wrapping_add(mark.covered));
    if covered == row.total { Ok(largest) } else { Err(Overflow) }
}

/// Adds the pixels of a row of a level in some columns in memory to a line, and sets the marks of the spans from `first_span`
/// on that hold them.
#[inline(always)]
fn integrate<W: Word, const CHANNELS: usize>(
    row: &Row<W>,
    quanta: Quanta,
    window: &Range<usize>,
    line: &mut [Light],
    marks: &mut [Mark<W>],
    first_span: usize,
) -> Result<i64, Overflow> {
    let quantum = quanta.quantum as f32;
    let mut running =
        Running { sum: marks.first().map_or([W::default(); 4], |mark| mark.sum), ..Running::default() };
    for (span, mark) in (first_span..).zip(marks) {
        (mark.sum, running.covered) = (running.sum, [0; 4]);
        let (mut at, end) = (span * SPAN, ((span + 1) * SPAN).min(row.differences.len()));
        while at < end {
            let (is_touched, until) = row.stretch(at, end);
            let [from, to] = [window.start, window.end].map(|column| column.clamp(at, until));
            let [first, last] =
                [from, to].map(|column| column.clamp(window.start, window.end) - window.start);
            let line = &mut line[first..last];
            if is_touched {
                // In registers.
                let mut here = running;
                for difference in &row.differences[at..from] {
                    here.pass(difference);
                }
                for (pixel, difference) in line.iter_mut().zip(&row.differences[from..to]) {
                    here.pass(difference);
                    for (light, sum) in pixel.iter_mut().zip(here.sum).take(CHANNELS) {
                        *light += sum.float() * quantum;
                    }
                }
                for difference in &row.differences[to..until] {
                    here.pass(difference);
                }
                running = here;
            } else if running.sum != [W::default(); 4] {
                running.stay(until - at);
                for pixel in line {
                    for (light, sum) in pixel.iter_mut().zip(running.sum).take(CHANNELS) {
                        *light += sum.float() * quantum;
                    }
                }
            }
            at = until;
        }
        mark.covered = running.covered[3];
    }
    let largest = running.largest[3].wide();
    if largest <= quanta.largest_coverage { Ok(largest) } else { Err(Overflow) }
}

/// The running sum of a row. Of all four, though only coverage is asked for: lanes of one register.
#[derive(Clone, Copy, Default)]
struct Running<W> {
    sum: Pixel<W>,
    /// The sum of the sums.
    covered: [i64; 4],
    largest: Pixel<W>,
}

impl<W: Word> Running<W> {
    /// Goes on to the next column.
    #[inline(always)]
    fn pass(&mut self, difference: &Pixel<W>) {
        for (c, difference) in difference.iter().enumerate() {
            self.sum[c] = self.sum[c].plus(*difference);
            self.covered[c] = self.covered[c].wrapping_add(self.sum[c].wide());
            self.largest[c] = self.largest[c].max(self.sum[c]);
        }
    }

    /// Advances by columns without any difference.
    fn stay(&mut self, columns: usize) {
        for c in 0..4 {
            let covered = self.sum[c].wide().wrapping_mul(columns as i64);
            self.covered[c] = self.covered[c].wrapping_add(covered);
        }
    }
}

/// Sets a line to a row of the next finer level, from a column on: cubic, so that what the coarser level holds is hardly
/// blurred any more, and no light is lost: beside a highlight a level may undershoot, by less than a tenth of what its image
/// has there. What lies beyond its border is as it is there.
#[inline(always)]
fn upsample(coarse: &Lines, row: i32, first: i32, mixed: &mut [Light], line: &mut [Light]) {
    // A fine row's coarse one, and toward the neighbour that it leans to.
    let (near, toward) = (row >> 1, if row & 1 == 0 { -1 } else { 1 });
    // One by one, and so in every inner loop: what maps an array is not always inlined.
    let colours = |step: i32| coarse.nearest_row(near + step * toward).as_flattened().iter();
    let around = colours(-1).zip(colours(0)).zip(colours(1).zip(colours(2)));
    let last = mixed.len() - 1;
    let out = mixed[1..last].as_flattened_mut().iter_mut();
    for (out, ((behind, near), (far, beyond))) in out.zip(around) {
        *out = cubic(*behind, *near, *far, *beyond);
    }
    (mixed[0], mixed[last]) = (mixed[1], mixed[last - 1]);
    // Fine columns 2k − 1 and 2k lie between the coarse ones k − 1 and k, which stand one place further back.
    let between = ((first + 1) >> 1) - 1 - coarse.window.columns.start;
    let mixed = &mixed[between as usize..];
    let second = usize::from(first & 1 == 0).min(line.len());
    let (before, line) = line.split_at_mut(second);
    before.iter_mut().for_each(|pixel| [_, *pixel] = two_between::<1>(mixed)[0]);
    /// Coarse pixels whose colours fill whole registers.
    const GROUP: usize = 4;
    let mut groups = line.chunks_exact_mut(2 * GROUP);
    let mut at = second;
    for pixels in &mut groups {
        pixels.copy_from_slice(two_between::<GROUP>(&mixed[at..]).as_flattened());
        at += GROUP;
    }
    for (pixels, around) in groups.into_remainder().chunks_mut(2).zip(mixed[at..].windows(4)) {
        let two = two_between::<1>(around)[0];
        pixels.copy_from_slice(&two[..pixels.len()]);
    }
}

/// The two fine pixels between the second of some coarse ones and the third, and so on.
#[inline(always)]
fn two_between<const COUNT: usize>(coarse: &[Light]) -> [[Light; 2]; COUNT] {
    let colours = |from: usize| coarse[from..from + COUNT].as_flattened().iter();
    let around = colours(0).zip(colours(1)).zip(colours(2).zip(colours(3)));
    let [mut left, mut right] = [[BLACK; COUNT]; 2];
    let out = left.as_flattened_mut().iter_mut().zip(right.as_flattened_mut());
    for ((left, right), ((a, b), (c, d))) in out.zip(around) {
        (*left, *right) = (cubic(*a, *b, *c, *d), cubic(*d, *c, *b, *a));
    }
    let mut pairs = [[BLACK; 2]; COUNT];
    for (pair, both) in pairs.iter_mut().zip(left.into_iter().zip(right)) {
        *pair = [both.0, both.1];
    }
    pairs
}

/// What lies a quarter of the way from `near` to `far`, on the cubic through them and their neighbours (Lagrange).
#[inline(always)]
fn cubic(behind: f32, near: f32, far: f32, beyond: f32) -> f32 {
    let [a, b, c, d] = CUBIC;
    a * behind + b * near + c * far + d * beyond
}

/// Weights of four pixels.
pub const CUBIC: [f32; 4] = [-7.0 / 128.0, 105.0 / 128.0, 35.0 / 128.0, -5.0 / 128.0];

#[cfg(test)]
mod tests {
    use super::*;
    use salf::tree::LEVELS;

    const FINE: Quanta = Quanta { quantum: 1.0 / 1024.0, largest_coverage: i64::MAX };

    fn part(accumulator: &Accumulator<i32>, window: &Window) -> Vec<Light> {
        let level = &accumulator.levels[0];
        let mut marks = Marks::empty(-1..level.height as i32 + 1, level.columns());
        let mut room = Room::default();
        let mut read = |window: &Window, marks: &mut Marks<i32>| {
            let mut rows = LevelRows::for_sum(accumulator, FINE, window, &mut room).unwrap();
            let mut pixels = vec![[7.0; 4]; window.columns.len() * window.rows.len()];
            for (row, line) in window.rows.clone().zip(pixels.chunks_mut(window.columns.len())) {
                rows.read(row, marks.row(row), line).unwrap();
            }
            rows.recycle(&mut room);
            pixels
        };
        let whole = Window { rows: -1..level.height as i32 + 1, columns: -1..level.width as i32 + 1 };
        read(&whole, &mut marks);
        let marked = marks.clone();
        let pixels = read(window, &mut marks);
        assert_eq!(marks, marked);
        pixels
    }

    fn whole(accumulator: &Accumulator<i32>) -> Vec<Light> {
        let level = &accumulator.levels[0];
        part(accumulator, &Window { rows: 0..level.height as i32, columns: 0..level.width as i32 })
    }

    #[test]
    fn a_uniform_level_is_uniform_on_the_picture() {
        for level in 0..LEVELS {
            let mut accumulator = Accumulator::<i32>::new(45, 37, LEVELS);
            let (width, height) =
                (accumulator.levels[level].width as i32, accumulator.levels[level].height as i32);
            let mut canvas = accumulator.canvas();
            for row in -1..=height {
                canvas.levels[level].add_run(row, -4096, (width + 1) << 12, [1024, 512, 0, 1024], 1);
            }
            drop(canvas);
            for pixel in whole(&accumulator) {
                assert_eq!(pixel, [1.0, 0.5, 0.0, 1.0], "level {level}");
            }
        }
    }

    #[test]
    fn parts_equal_the_whole_and_mass_is_kept() {
        let mut accumulator = Accumulator::<i32>::new(600, 64, LEVELS);
        let mut canvas = accumulator.canvas();
        canvas.levels[3].add_run(4, 16000, 20800, [1 << 20; 4], 1);
        canvas.levels[1].add_run(13, 48000, 68800, [1 << 20; 4], 1);
        canvas.levels[0].add_run(40, 48000, 68800, [1 << 20; 4], 1);
        // Behind several marks, and on coarser levels, which have none.
        canvas.levels[0].add_run(40, 2_000_000, 2_200_000, [1 << 10; 4], 1);
        canvas.levels[1].add_run(13, 1_000_000, 1_200_000, [1 << 10; 4], 1);
        drop(canvas);
        let lines = whole(&accumulator);
        let mass: f64 = lines.iter().map(|pixel| pixel[3] as f64).sum();
        let wanted = (300.0 * 64.0 + 1300.0 * 4.0 + 1300.0) / 256.0 * 1024.0 + 5.0 * 200_000.0 / 4096.0;
        assert!((mass / wanted - 1.0).abs() < 1e-4, "{mass} {wanted}");
        for rows in [0..64, 3..4, 30..41, 63..64] {
            for columns in [0..600, 5..6, 10..31, 12..30, 63..64, 120..130, 470..530] {
                let window = Window { rows: rows.clone(), columns: columns.clone() };
                let here = columns.start as usize..columns.end as usize;
                let wanted = lines.chunks(600).map(|line| &line[here.clone()]);
                let wanted = wanted.skip(rows.start as usize).take(rows.len()).flatten().copied();
                assert_eq!(part(&accumulator, &window), wanted.collect::<Vec<_>>(), "{window:?}");
            }
        }
    }
}
