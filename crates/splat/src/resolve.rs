//! Accumulators to pictures: running sums, and each level upsampled onto the next finer one.

use crate::canvas::{Accumulator, Level, Pixel, Word, integrated};
use std::ops::Range;

/// A pixel holds more light than its integers are sure to hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Overflow;

/// Sums of red, green, blue and coverage of some pixel rows, each 1 for a pixel of radiance 1.
pub type Lines = Vec<[f32; 4]>;

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

/// Adds the pixel rows `rows` of a sum to `lines`, which holds them one after another.
pub fn add_rows<W: Word>(
    accumulator: &Accumulator<W>,
    quanta: Quanta,
    rows: Range<i32>,
    lines: &mut Lines,
) -> Result<(), Overflow> {
    let is_touched =
        |level: &Level<W>, rows: &Range<i32>| with_halo(level, rows).any(|row| level.row(row).is_some());
    let ranges: Vec<_> = (0..accumulator.levels.len() as i32)
        .map(|k| if k == 0 { rows.clone() } else { (rows.start >> k) - 1..((rows.end - 1) >> k) + 2 })
        .collect();
    let levels = || accumulator.levels.iter().zip(&ranges);
    let Some(coarsest) = levels().rposition(|(level, rows)| is_touched(level, rows)) else { return Ok(()) };
    let mut pixels = Vec::new();
    let mut above: Option<(Lines, Range<i32>, usize)> = None;
    for (level, rows) in levels().take(coarsest + 1).rev() {
        let stride = level.width + 2;
        let mut here = vec![[0f32; 4]; stride * rows.len()];
        if let Some((coarse, coarse_rows, coarse_stride)) = &above {
            upsample(coarse, coarse_rows, *coarse_stride, &mut here, rows, stride);
        }
        pixels.resize(stride, [0; 4]);
        for row in with_halo(level, rows) {
            let Some((line, total)) = level.row(row) else { continue };
            integrated(line, total, &mut pixels).ok_or(Overflow)?;
            if pixels.iter().any(|pixel| pixel[3] > quanta.largest_coverage) {
                return Err(Overflow);
            }
            let first = (row - rows.start) as usize * stride;
            for (out, pixel) in here[first..first + stride].iter_mut().zip(&pixels) {
                (0..4).for_each(|c| out[c] += pixel[c] as f32 * quanta.quantum as f32);
            }
        }
        above = Some((here, rows.clone(), stride));
    }
    let (finest, _, stride) = above.expect("there is a finest level");
    let width = stride - 2;
    for (line, finest) in lines.chunks_mut(width).zip(finest.chunks(stride)) {
        for (out, pixel) in line.iter_mut().zip(&finest[1..]) {
            (0..4).for_each(|c| out[c] += pixel[c]);
        }
    }
    Ok(())
}

/// Those of `rows` that a level has.
fn with_halo<W: Word>(level: &Level<W>, rows: &Range<i32>) -> Range<i32> {
    rows.start.max(-1)..rows.end.min(level.height as i32 + 1)
}

/// Bilinear: a fine pixel lies a quarter of a coarse one off its centre. Both begin with column −1.
fn upsample(
    coarse: &[Pixel<f32>],
    coarse_rows: &Range<i32>,
    coarse_stride: usize,
    fine: &mut [Pixel<f32>],
    rows: &Range<i32>,
    stride: usize,
) {
    const NEAR: f32 = 0.75;
    const FAR: f32 = 0.25;
    // Each fine pixel's coarse one, and the neighbour it leans to.
    let sources = |at: i32| (at >> 1, (at >> 1) + if at & 1 == 0 { -1 } else { 1 });
    let mut mixed = vec![[0f32; 4]; coarse_stride];
    for (line, row) in fine.chunks_mut(stride).zip(rows.clone()) {
        let (near, far) = sources(row);
        let line_of = |row: i32| {
            let place = row - coarse_rows.start;
            let is_known = coarse_rows.contains(&row);
            is_known.then(|| &coarse[place as usize * coarse_stride..(place as usize + 1) * coarse_stride])
        };
        let zero = [[0f32; 4]; 0];
        let (near, far) = (line_of(near).unwrap_or(&zero), line_of(far).unwrap_or(&zero));
        for (x, out) in mixed.iter_mut().enumerate() {
            let [a, b] = [near, far].map(|line| line.get(x).copied().unwrap_or_default());
            *out = std::array::from_fn(|c| NEAR * a[c] + FAR * b[c]);
        }
        for (x, out) in line.iter_mut().enumerate() {
            let (near, far) = sources(x as i32 - 1);
            let at = |column: i32| mixed.get((column + 1) as usize).copied().unwrap_or_default();
            let [a, b] = [at(near), at(far)];
            *out = std::array::from_fn(|c| NEAR * a[c] + FAR * b[c]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use salf::tree::LEVELS;

    const FINE: Quanta = Quanta { quantum: 1.0 / 1024.0, largest_coverage: i64::MAX };

    fn whole(accumulator: &Accumulator<i32>) -> Lines {
        let (width, height) = (accumulator.levels[0].width, accumulator.levels[0].height);
        let mut lines = vec![[0.0; 4]; width * height];
        add_rows(accumulator, FINE, 0..height as i32, &mut lines).unwrap();
        lines
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
            let mut part = vec![[0.0; 4]; 64 * rows.len()];
            add_rows(&accumulator, FINE, rows.clone(), &mut part).unwrap();
            assert_eq!(part, lines[rows.start as usize * 64..rows.end as usize * 64]);
        }
    }
}
