//! Accumulators to pictures: running sums, and each level upsampled onto the next finer one.

use crate::canvas::{Accumulator, Level, Pixel, Row, Word};
use crate::marks::{Mark, Marks, SPAN, spans};
use crate::widest::with_widest_instructions;
use std::ops::Range;

/// A pixel holds more light than its integers are sure to hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Overflow;

/// A rectangle of pixels of a level, in its rows and columns; −1 is the border.
#[derive(Clone, Debug)]
pub struct Window {
    pub rows: Range<i32>,
    pub columns: Range<i32>,
}

impl Window {
    /// What of a coarser level's pixels this one's are made of.
    fn on_level(&self, level: usize) -> Self {
        let coarse = |fine: &Range<i32>| match level {
            0 => fine.clone(),
            _ => (fine.start >> level) - 1..((fine.end - 1) >> level) + 2,
        };
        Self { rows: coarse(&self.rows), columns: coarse(&self.columns) }
    }

    /// That of it which a level has.
    fn within<W: Word>(self, level: &Level<W>) -> Self {
        let within = |range: Range<i32>, side: usize| range.start.max(-1)..range.end.min(side as i32 + 1);
        Self { rows: within(self.rows, level.height), columns: within(self.columns, level.width) }
    }
}

/// Sums of red, green, blue and coverage of a window's pixels, each 1 for a pixel of radiance 1, row by row.
pub struct Lines {
    window: Window,
    pixels: Vec<[f32; 4]>,
}

/// Room for pixels, used again and again.
#[derive(Default)]
pub struct Room(Vec<Vec<[f32; 4]>>);

impl Room {
    fn take(&mut self) -> Vec<[f32; 4]> {
        let mut pixels = self.0.pop().unwrap_or_default();
        pixels.clear();
        pixels
    }

    /// Lines that nobody needs any more.
    pub fn give_back(&mut self, lines: Lines) {
        self.0.push(lines.pixels);
    }
}

impl Lines {
    fn black(window: Window, mut pixels: Vec<[f32; 4]>) -> Self {
        pixels.resize(window.rows.len() * window.columns.len(), [0.0; 4]);
        Self { window, pixels }
    }

    /// The rows.
    pub fn rows(&self) -> impl Iterator<Item = &[[f32; 4]]> {
        self.pixels.chunks_exact(self.window.columns.len().max(1))
    }

    fn row(&self, row: i32) -> Option<&[[f32; 4]]> {
        let (rows, width) = (&self.window.rows, self.window.columns.len());
        rows.contains(&row).then(|| &self.pixels[(row - rows.start) as usize * width..][..width])
    }

    /// Adds the first `CHANNELS` channels of a level's pixels. If marks are kept of it, columns outside of the window are
    /// those of the last time.
    pub fn add<W: Word, const CHANNELS: usize>(
        &mut self,
        level: &Level<W>,
        quanta: Quanta,
        mut kept: Option<&mut Marks<W>>,
    ) -> Result<(), Overflow> {
        let Window { rows, columns } = &self.window;
        let in_memory = (columns.start + 1) as usize..(columns.end + 1) as usize;
        let mut unkept = Marks::none(0..1, level.columns());
        for (row, line) in rows.clone().zip(self.pixels.chunks_exact_mut(columns.len().max(1))) {
            let (marks, spans) = match &mut kept {
                Some(kept) => (kept.of_row(row), spans(&in_memory)),
                None => {
                    let marks = unkept.of_row(0);
                    let all = 0..marks.len();
                    (marks, all)
                }
            };
            let Some(row) = level.row(row) else {
                marks[spans].fill(Mark::default());
                continue;
            };
            with_widest_instructions(
                #[inline(always)]
                || {
                    let first_span = spans.start;
                    integrate::<W, CHANNELS>(&row, quanta, &in_memory, line, &mut marks[spans], first_span)
                },
            )?;
            let covered: i64 = marks.iter().fold(0, |sum, mark| sum.wrapping_add(mark.covered));
            if covered != row.total {
                return Err(Overflow);
            }
        }
        Ok(())
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

/// The pixels of a sum in a window of the picture; `None` if they are black. `marks` are those of its rows of the finest level.
pub fn lines<W: Word>(
    accumulator: &Accumulator<W>,
    quanta: Quanta,
    window: &Window,
    marks: &mut Marks<W>,
    room: &mut Room,
) -> Result<Option<Lines>, Overflow> {
    let levels = || {
        let levels = accumulator.levels.iter().enumerate();
        levels.map(|(k, level)| (level, window.on_level(k).within(level)))
    };
    let is_touched =
        |(level, mut window): (&Level<W>, Window)| window.rows.any(|row| level.row(row).is_some());
    let Some(coarsest) = levels().rposition(is_touched) else {
        window.rows.clone().for_each(|row| marks.of_row(row).fill(Mark::default()));
        return Ok(None);
    };
    let mut above: Option<Lines> = None;
    for (k, (level, window)) in levels().take(coarsest + 1).enumerate().rev() {
        let mut here = match above.take() {
            Some(coarse) => {
                let pixels = room.take();
                let here = with_widest_instructions(
                    #[inline(always)]
                    || upsampled(&coarse, window.clone(), pixels),
                );
                room.give_back(coarse);
                here
            }
            None => Lines::black(window, room.take()),
        };
        here.add::<W, 4>(level, quanta, (k == 0).then_some(&mut *marks))?;
        above = Some(here);
    }
    Ok(above)
}

/// Adds the pixels of a row of a level in some columns in memory to a line, and sets the marks of the spans from `first_span`
/// on that hold them.
#[inline(always)]
fn integrate<W: Word, const CHANNELS: usize>(
    row: &Row<W>,
    quanta: Quanta,
    window: &Range<usize>,
    line: &mut [[f32; 4]],
    marks: &mut [Mark<W>],
    first_span: usize,
) -> Result<(), Overflow> {
    let quantum = quanta.quantum as f32;
    let mut sum = marks.first().map_or([W::default(); 4], |mark| mark.sum);
    // Of all four, though only coverage is asked for: lanes of one register.
    let mut largest = [W::default(); 4];
    for (span, mark) in (first_span..).zip(marks) {
        let mut covered = [0i64; 4];
        mark.sum = sum;
        let mut pass = |difference: &Pixel<W>| {
            for c in 0..4 {
                sum[c] = sum[c].plus(difference[c]);
                covered[c] = covered[c].wrapping_add(sum[c].wide());
                largest[c] = largest[c].max(sum[c]);
            }
            sum
        };
        let [first, end] = [span * SPAN, (span + 1) * SPAN]
            .map(|column| column.clamp(row.columns.start, row.columns.end) - row.columns.start);
        let [from, to] = [window.start, window.end]
            .map(|column| column.saturating_sub(row.columns.start).clamp(first, end));
        row.differences[first..from].iter().for_each(|difference| {
            pass(difference);
        });
        let line = line.iter_mut().skip((row.columns.start + from).saturating_sub(window.start));
        for (pixel, difference) in line.zip(&row.differences[from..to]) {
            let sum = pass(difference);
            for c in 0..CHANNELS {
                pixel[c] += sum[c].float() * quantum;
            }
        }
        row.differences[to..end].iter().for_each(|difference| {
            pass(difference);
        });
        mark.covered = covered[3];
    }
    if largest[3].wide() <= quanta.largest_coverage { Ok(()) } else { Err(Overflow) }
}

/// Bilinear: a fine pixel lies a quarter of a coarse one off its centre.
#[inline(always)]
fn upsampled(coarse: &Lines, window: Window, mut pixels: Vec<[f32; 4]>) -> Lines {
    const NEAR: f32 = 0.75;
    const FAR: f32 = 0.25;
    let mix = |a: &[f32; 4], b: &[f32; 4]| -> [f32; 4] { std::array::from_fn(|c| NEAR * a[c] + FAR * b[c]) };
    let black = vec![[0f32; 4]; coarse.window.columns.len()];
    let mut mixed = black.clone();
    let (width, first) = (window.columns.len(), window.columns.start);
    // Fine columns 2k − 1 and 2k lie between the coarse ones k − 1 and k.
    let between = ((first + 1) >> 1) - 1 - coarse.window.columns.start;
    let half = usize::from(first & 1 == 0);
    pixels.reserve(width * window.rows.len() + 2);
    for row in window.rows.clone() {
        // A fine row's coarse one, and the neighbour it leans to.
        let rows = [row >> 1, (row >> 1) + if row & 1 == 0 { -1 } else { 1 }];
        let [near, far] = rows.map(|row| coarse.row(row).unwrap_or(&black));
        for ((out, near), far) in mixed.iter_mut().zip(near).zip(far) {
            *out = mix(near, far);
        }
        let end = pixels.len() + width;
        let mut pairs = mixed[between as usize..].windows(2);
        if half == 1 {
            pixels.extend(pairs.next().map(|pair| mix(&pair[1], &pair[0])));
        }
        let pairs = pairs.take((end - pixels.len()).div_ceil(2));
        pixels.extend(pairs.flat_map(|pair| [mix(&pair[0], &pair[1]), mix(&pair[1], &pair[0])]));
        pixels.truncate(end);
    }
    Lines { window, pixels }
}

#[cfg(test)]
mod tests {
    use super::*;
    use salf::tree::LEVELS;

    const FINE: Quanta = Quanta { quantum: 1.0 / 1024.0, largest_coverage: i64::MAX };

    fn part(accumulator: &Accumulator<i32>, window: &Window) -> Vec<[f32; 4]> {
        let black = vec![[0.0; 4]; window.columns.len() * window.rows.len()];
        let level = &accumulator.levels[0];
        let mut marks = Marks::none(-1..level.height as i32 + 1, level.columns());
        let whole = Window { rows: -1..level.height as i32 + 1, columns: -1..level.width as i32 + 1 };
        let mut room = Room::default();
        lines(accumulator, FINE, &whole, &mut marks, &mut room).unwrap();
        let marked = marks.clone();
        let lines = lines(accumulator, FINE, window, &mut marks, &mut room).unwrap();
        assert_eq!(marks, marked);
        lines.map_or(black, |lines| lines.rows().flatten().copied().collect())
    }

    fn whole(accumulator: &Accumulator<i32>) -> Vec<[f32; 4]> {
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
        let mut accumulator = Accumulator::<i32>::new(64, 64, LEVELS);
        let mut canvas = accumulator.canvas();
        canvas.levels[3].add_run(4, 16000, 20800, [1 << 20; 4], 1);
        canvas.levels[1].add_run(13, 48000, 68800, [1 << 20; 4], 1);
        canvas.levels[0].add_run(40, 48000, 68800, [1 << 20; 4], 1);
        drop(canvas);
        let lines = whole(&accumulator);
        let mass: f64 = lines.iter().map(|pixel| pixel[3] as f64).sum();
        let wanted = (300.0 * 64.0 + 1300.0 * 4.0 + 1300.0) / 256.0 * 1024.0;
        assert!((mass / wanted - 1.0).abs() < 1e-4, "{mass} {wanted}");
        for rows in [0..64, 3..4, 30..41, 63..64] {
            for columns in [0..64, 5..6, 10..31, 12..30, 63..64] {
                let window = Window { rows: rows.clone(), columns: columns.clone() };
                let here = columns.start as usize..columns.end as usize;
                let wanted = lines.chunks(64).map(|line| &line[here.clone()]);
                let wanted = wanted.skip(rows.start as usize).take(rows.len()).flatten().copied();
                assert_eq!(part(&accumulator, &window), wanted.collect::<Vec<_>>(), "{window:?}");
            }
        }
    }
}
