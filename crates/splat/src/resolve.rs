//! Accumulators to pictures: running sums, and each level upsampled onto the next finer one.

use crate::canvas::{Accumulator, Level, Row, Word};
use std::ops::Range;

/// A pixel holds more light than its integers are sure to hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Overflow;

/// Sums of red, green, blue and coverage of some pixel rows, each 1 for a pixel of radiance 1.
pub struct Lines {
    stride: usize,
    /// Row by row, a column of border on either side.
    pixels: Vec<[f32; 4]>,
}

impl Lines {
    /// The rows without their border.
    pub fn rows(&self) -> impl Iterator<Item = &[[f32; 4]]> {
        self.pixels.chunks_exact(self.stride).map(|line| &line[1..line.len() - 1])
    }

    /// Adds the light, not the coverage, of lines of the same size.
    pub fn add_light(&mut self, more: &Self) {
        for (pixel, more) in self.pixels.iter_mut().zip(&more.pixels) {
            (0..3).for_each(|c| pixel[c] += more[c]);
        }
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

/// The pixel rows `rows` of a sum; `None` if they are black.
pub fn lines<W: Word>(
    accumulator: &Accumulator<W>,
    quanta: Quanta,
    rows: Range<i32>,
) -> Result<Option<Lines>, Overflow> {
    let is_touched =
        |level: &Level<W>, rows: &Range<i32>| with_halo(level, rows).any(|row| level.row(row).is_some());
    let ranges: Vec<_> = (0..accumulator.levels.len() as i32)
        .map(|k| if k == 0 { rows.clone() } else { (rows.start >> k) - 1..((rows.end - 1) >> k) + 2 })
        .collect();
    let levels = || accumulator.levels.iter().zip(&ranges);
    let Some(coarsest) = levels().rposition(|(level, rows)| is_touched(level, rows)) else {
        return Ok(None);
    };
    let mut above: Option<(Lines, Range<i32>)> = None;
    for (level, rows) in levels().take(coarsest + 1).rev() {
        let stride = level.width + 2;
        let mut here = match &above {
            Some((coarse, coarse_rows)) => upsampled(coarse, coarse_rows, rows, stride),
            None => Lines { stride, pixels: vec![[0.0; 4]; stride * rows.len()] },
        };
        for row in with_halo(level, rows) {
            let first = (row - rows.start) as usize * stride;
            level
                .row(row)
                .map_or(Ok(()), |row| integrate(&row, quanta, &mut here.pixels[first..first + stride]))?;
        }
        above = Some((here, rows.clone()));
    }
    Ok(above.map(|(lines, _)| lines))
}

/// Adds the pixels of a row to a line.
#[inline(always)]
fn integrate<W: Word>(row: &Row<W>, quanta: Quanta, line: &mut [[f32; 4]]) -> Result<(), Overflow> {
    let quantum = quanta.quantum as f32;
    let (mut sum, mut covered, mut largest) = ([W::default(); 4], 0i64, 0i64);
    // What leaves the picture ends in a column behind it.
    let pixels = line.iter_mut().skip(row.columns.start);
    for (pixel, difference) in pixels.zip(row.differences) {
        for c in 0..4 {
            sum[c] = sum[c].plus(difference[c]);
            pixel[c] += sum[c].float() * quantum;
        }
        covered = covered.wrapping_add(sum[3].wide());
        largest = largest.max(sum[3].wide());
    }
    if covered == row.total && largest <= quanta.largest_coverage { Ok(()) } else { Err(Overflow) }
}

/// Those of `rows` that a level has.
fn with_halo<W: Word>(level: &Level<W>, rows: &Range<i32>) -> Range<i32> {
    rows.start.max(-1)..rows.end.min(level.height as i32 + 1)
}

/// Bilinear: a fine pixel lies a quarter of a coarse one off its centre. Both begin with column −1.
fn upsampled(coarse: &Lines, coarse_rows: &Range<i32>, rows: &Range<i32>, stride: usize) -> Lines {
    const NEAR: f32 = 0.75;
    const FAR: f32 = 0.25;
    let mix = |a: &[f32; 4], b: &[f32; 4]| -> [f32; 4] { std::array::from_fn(|c| NEAR * a[c] + FAR * b[c]) };
    let black = vec![[0f32; 4]; coarse.stride];
    let line_of = |row: i32| {
        let first = (row - coarse_rows.start) as usize * coarse.stride;
        if coarse_rows.contains(&row) { &coarse.pixels[first..first + coarse.stride] } else { &black }
    };
    let mut mixed = black.clone();
    let mut pixels = Vec::with_capacity(stride * rows.len() + 1);
    for row in rows.clone() {
        // A fine row's coarse one, and the neighbour it leans to.
        let (near, far) = (line_of(row >> 1), line_of((row >> 1) + if row & 1 == 0 { -1 } else { 1 }));
        for ((out, near), far) in mixed.iter_mut().zip(near).zip(far) {
            *out = mix(near, far);
        }
        // Fine columns −1 and 0 lie between the coarse ones −1 and 0, and so on.
        let first = pixels.len();
        let between = mixed.windows(2).take(stride.div_ceil(2));
        pixels.extend(between.flat_map(|pair| [mix(&pair[0], &pair[1]), mix(&pair[1], &pair[0])]));
        pixels.truncate(first + stride);
    }
    Lines { stride, pixels }
}

#[cfg(test)]
mod tests {
    use super::*;
    use salf::tree::LEVELS;

    const FINE: Quanta = Quanta { quantum: 1.0 / 1024.0, largest_coverage: i64::MAX };

    fn part(accumulator: &Accumulator<i32>, rows: Range<i32>) -> Vec<[f32; 4]> {
        let black = vec![[0.0; 4]; accumulator.levels[0].width * rows.len()];
        let lines = lines(accumulator, FINE, rows).unwrap();
        lines.map_or(black, |lines| lines.rows().flatten().copied().collect())
    }

    fn whole(accumulator: &Accumulator<i32>) -> Vec<[f32; 4]> {
        part(accumulator, 0..accumulator.levels[0].height as i32)
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
            assert_eq!(
                part(&accumulator, rows.clone()),
                lines[rows.start as usize * 64..rows.end as usize * 64]
            );
        }
    }
}
