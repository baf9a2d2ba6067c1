//! A picture blurred by the image of the aperture: a convolution with its rows, whatever its shape.

use crate::BaselineError;
use lens::Aperture;
use progress::{Cancelled, Progress};
use rayon::prelude::*;

/// Most rows that an aperture is cut to; wider blurs have rows of more than a pixel.
const MAX_ROWS: f64 = 4096.0;

/// A run of the aperture's image: source pixels of one row, seen from the pixel that they are summed to.
struct Run {
    /// The source row, relative to the pixel's.
    row: i64,
    /// Where it starts and ends, px from the pixel's centre.
    span: [f64; 2],
    /// Its share of the open area.
    share: f64,
}

/// The aperture's image of one size.
pub struct ApertureBlur {
    runs: Vec<Run>,
}

impl ApertureBlur {
    /// The image of `aperture` with the signed radius `radius_px` (negative: turned by 180°), for a picture of `height`
    /// rows. `None` at half a pixel and below, where the image is the pixel itself.
    ///
    /// # Errors
    /// The aperture lets no light through.
    pub fn new(aperture: &Aperture, radius_px: f64, height: usize) -> Result<Option<Self>, BaselineError> {
        if radius_px.abs() <= 0.5 {
            return Ok(None);
        }
        let count = (2.0 * radius_px.abs()).ceil().clamp(8.0, MAX_ROWS) as usize;
        let rows = aperture.rows(count);
        let (open_area, row_height) = (rows.open_area(), 2.0 / count as f64);
        if open_area <= 0.0 {
            return Err(BaselineError::ClosedAperture);
        }
        let mut runs = Vec::new();
        // What passes (u, v) on its way to a pixel comes from −u·r beside it and v·r below it.
        let farthest = height as f64;
        for (index, row) in rows.rows.iter().enumerate() {
            let ends = [index, index + 1].map(|k| (-1.0 + k as f64 * row_height) * radius_px + 0.5);
            let (top, bottom) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
            for run in &row.runs {
                let ends = [run.start, run.end].map(|u| -u * radius_px);
                let span = [ends[0].min(ends[1]), ends[0].max(ends[1])];
                let share = (run.end - run.start) * run.transmission * row_height / open_area;
                // Rows farther away than the picture is high are all the same: its first or last.
                let (first, last) = (top.floor().max(-farthest), bottom.floor().min(farthest));
                let (first, last) = (first.min(farthest) as i64, last.max(-farthest) as i64);
                for row in first..=last {
                    let from = if row == first { top } else { row as f64 };
                    let to = if row == last { bottom } else { row as f64 + 1.0 };
                    let part = (to - from) / (bottom - top);
                    if part > 0.0 {
                        runs.push(Run { row, span, share: share * part });
                    }
                }
            }
        }
        Ok(Some(Self { runs }))
    }

    /// Blurs a picture of rows of `width`. What lies outside of it is taken to be like its nearest pixel.
    ///
    /// # Errors
    /// [`Cancelled`] if `progress` asks to stop.
    pub fn apply(
        &self,
        source: &[[f32; 4]],
        width: usize,
        progress: &dyn Progress,
    ) -> Result<Vec<[f32; 4]>, Cancelled> {
        let height = source.len() / width;
        let integrals: Vec<_> = source.par_chunks(width).map(RowIntegral::new).collect();
        let rows: Result<Vec<_>, Cancelled> = (0..height)
            .into_par_iter()
            .map(|y| {
                progress.check()?;
                let mut sums = vec![[0.0f64; 4]; width];
                for run in &self.runs {
                    let row = (y as i64 + run.row).clamp(0, height as i64 - 1);
                    if let Some(integral) = &integrals[row as usize] {
                        let scale = run.share / (run.span[1] - run.span[0]);
                        for (x, sum) in sums.iter_mut().enumerate() {
                            let center = x as f64 + 0.5;
                            let [from, to] = run.span.map(|offset| integral.integral_to(center + offset));
                            (0..4).for_each(|c| sum[c] += (to[c] - from[c]) * scale);
                        }
                    }
                }
                Ok(sums.into_iter().map(|sum| sum.map(|c| c as f32)).collect::<Vec<_>>())
            })
            .collect();
        Ok(rows?.concat())
    }
}

/// The integral along a row of pixels.
struct RowIntegral {
    /// Over the first k pixels.
    sums: Vec<[f64; 4]>,
    first: [f64; 4],
    last: [f64; 4],
}

impl RowIntegral {
    /// `None` for a row of nothing but 0.
    fn new(row: &[[f32; 4]]) -> Option<Self> {
        if row.iter().all(|pixel| *pixel == [0.0; 4]) {
            return None;
        }
        let mut sums = Vec::with_capacity(row.len() + 1);
        let mut sum = [0.0; 4];
        sums.push(sum);
        for pixel in row {
            (0..4).for_each(|c| sum[c] += f64::from(pixel[c]));
            sums.push(sum);
        }
        let [first, last] = [0, row.len() - 1].map(|k| row[k].map(f64::from));
        Some(Self { sums, first, last })
    }

    /// From the row's start to `x` px.
    #[inline(always)]
    fn integral_to(&self, x: f64) -> [f64; 4] {
        let width = self.sums.len() - 1;
        if x <= 0.0 {
            return self.first.map(|c| c * x);
        }
        if x >= width as f64 {
            return std::array::from_fn(|c| self.sums[width][c] + self.last[c] * (x - width as f64));
        }
        let k = x as usize;
        let (a, b, rest) = (&self.sums[k], &self.sums[k + 1], x - k as f64);
        std::array::from_fn(|c| a[c] + (b[c] - a[c]) * rest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lens::{ApertureMask, ApertureShape};
    use progress::Unwatched;
    use std::sync::Arc;

    const SIDE: usize = 61;

    fn blurred_point(aperture: &Aperture, radius_px: f64) -> Vec<f32> {
        let mut source = vec![[0.0; 4]; SIDE * SIDE];
        source[SIDE / 2 * SIDE + SIDE / 2] = [1.0; 4];
        let blur = ApertureBlur::new(aperture, radius_px, SIDE).unwrap().unwrap();
        blur.apply(&source, SIDE, &Unwatched).unwrap().iter().map(|pixel| pixel[0]).collect()
    }

    #[test]
    fn a_point_becomes_the_disc_of_the_radius() {
        for radius in [0.6, 3.0, -7.5, 20.0] {
            let image = blurred_point(&ApertureShape::Disc.into(), radius);
            let sum: f64 = image.iter().map(|&c| f64::from(c)).sum();
            assert!((sum - 1.0).abs() < 1e-5, "{radius}: {sum}");
            let moment: f64 = image
                .iter()
                .enumerate()
                .map(|(k, &c)| {
                    let (x, y) = ((k % SIDE) as f64 - 30.0, (k / SIDE) as f64 - 30.0);
                    f64::from(c) * (x * x + y * y)
                })
                .sum();
            // A disc has the second moment r²/2, the pixel 1/6 where it is small beside the disc.
            let expected = radius * radius / 2.0 + 1.0 / 6.0;
            let is_small = (moment / expected - 1.0).abs() < 0.02;
            assert!(is_small || radius == 0.6, "{radius}: {moment} for {expected}");
        }
    }

    #[test]
    fn far_defocus_is_upright_and_near_defocus_turned() {
        // Open on its upper left.
        let mask =
            ApertureMask { width: 2, height: 2, transmission: vec![1.0, 0.0, 0.0, 0.0], file: String::new() };
        let aperture = ApertureShape::Mask(Arc::new(mask)).into();
        let at = |image: &[f32], x: usize, y: usize| image[y * SIDE + x];
        let far = blurred_point(&aperture, 10.0);
        assert!(at(&far, 25, 25) > 0.009 && at(&far, 35, 35) == 0.0 && at(&far, 35, 25) == 0.0);
        let near = blurred_point(&aperture, -10.0);
        assert!(at(&near, 35, 35) > 0.009 && at(&near, 25, 25) == 0.0);
    }

    #[test]
    fn a_uniform_picture_stays_however_wide_the_blur() {
        for radius in [0.51, 4.2, 90.0, -1e9] {
            let blur = ApertureBlur::new(&ApertureShape::Disc.into(), radius, 9).unwrap().unwrap();
            let found = blur.apply(&[[0.5, 2.0, 0.0, 1.0]; 7 * 9], 7, &Unwatched).unwrap();
            for pixel in found {
                let expected = [0.5, 2.0, 0.0, 1.0];
                (0..4).for_each(|c| assert!((pixel[c] - expected[c]).abs() < 1e-5, "{radius}: {pixel:?}"));
            }
        }
    }
}
