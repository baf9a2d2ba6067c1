//! The current state of a render: the picture and its standard error.

use lens::{Exposure, Picture, Vignette};
use numerics::luminance;
use rayon::prelude::*;

/// A picture with the standard error of every number in it.
///
/// The error is estimated from the scatter of the passes, each of which is a picture of its own (Student's
/// t with `passes` − 1 degrees of freedom; at least 31 for 32 samples a pixel and more). Independent passes'
/// scatter gives the standard error without bias. Passes of low discrepancy are more evenly spread together
/// than each alone, so that their scatter gives too large an error, never too small a one on average.
///
/// A pixel in which every pass is the same has the error 0, whether it is exact or what it lacks is so rare
/// that no sample has found it.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Radiance and coverage, conserved: the mean of all samples.
    pub picture: Picture,
    /// The standard error of each radiance and coverage in `picture`; infinite after fewer than two passes.
    pub standard_error: Picture,
    /// The standard error of each pixel's luminance (Rec. 709), whose channels err together.
    pub luminance_error: Vec<f32>,
    /// The standard error of radiance over coverage, which err together; infinite like `standard_error`.
    pub normalised_error: Vec<[f32; 3]>,
    /// The standard error of luminance over coverage.
    pub normalised_luminance_error: Vec<f32>,
    /// Samples a pixel so far.
    pub samples_per_pixel: u32,
    /// Passes so far.
    pub passes: u32,
}

impl Estimate {
    /// The standard error of each channel of `picture.exposed(exposure)`, row by row; infinite before the second
    /// pass.
    pub fn error_of(&self, exposure: Exposure) -> &[[f32; 3]] {
        match exposure {
            Exposure::Conserve => &self.standard_error.radiance,
            Exposure::Normalise => &self.normalised_error,
        }
    }

    /// The estimate as a lens darkens it: `vignette` gives the factors of each pixel, by its index.
    pub(super) fn darkened(mut self, vignette: impl Fn(usize) -> Vignette) -> Self {
        for k in 0..self.luminance_error.len() {
            let at = vignette(k);
            for picture in [&mut self.picture, &mut self.standard_error] {
                picture.radiance[k] = picture.radiance[k].map(|light| light * at.angle);
                picture.coverage[k] = at.coverage(picture.coverage[k]);
                if let Some(colours) = &mut picture.colour_coverage {
                    colours[k] = colours[k].map(|covered| at.coverage(covered));
                }
            }
            self.luminance_error[k] *= at.angle;
            self.normalised_error[k] = self.normalised_error[k].map(|error| error * at.angle * at.rims);
            self.normalised_luminance_error[k] *= at.angle * at.rims;
        }
        self
    }

    /// The root of the mean squared standard error over all pixels and channels: the RMSE to expect of
    /// `picture.exposed(exposure)` against an exact one. 0 for a picture without pixels.
    pub fn expected_rmse(&self, exposure: Exposure) -> f64 {
        let errors = self.error_of(exposure);
        let squares = errors.iter().flatten().map(|&error| f64::from(error).powi(2));
        (squares.sum::<f64>() / (3 * errors.len()).max(1) as f64).sqrt()
    }
}

/// Means and scatter of passes in one pixel, by Welford's updates with weights (West 1979): passes that are
/// all the same have exactly no scatter.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Moments {
    /// Red, green, blue, luminance, coverage.
    mean: [f64; 5],
    /// Σ w·(x − mean)².
    squares: [f64; 5],
    /// Σ w·(x − mean)·(coverage − its mean).
    with_coverage: [f64; 4],
}

impl Moments {
    /// Adds a pass of mean red, green, blue and coverage; `share` is what part of all samples so far it has.
    fn add(&mut self, [r, g, b, coverage]: [f64; 4], weight: f64, share: f64) {
        let x = [r, g, b, luminance([r, g, b]), coverage];
        let before: [f64; 5] = std::array::from_fn(|c| x[c] - self.mean[c]);
        for c in 0..5 {
            self.mean[c] += before[c] * share;
            self.squares[c] += weight * before[c] * (x[c] - self.mean[c]);
        }
        let coverage = coverage - self.mean[4];
        for (sum, before) in self.with_coverage.iter_mut().zip(before) {
            *sum += weight * before * coverage;
        }
    }

    /// The variances of radiance and of luminance over coverage where the sums vary by `scale` times the scatter:
    /// to first order (var L − 2r·cov(L, C) + r²·var C)/C² for r = L/C. 0 where nothing is covered.
    fn ratio_variances(&self, scale: f64) -> [f64; 4] {
        let coverage = self.mean[4];
        if coverage <= 0.0 {
            return [0.0; 4];
        }
        std::array::from_fn(|c| {
            let ratio = self.mean[c] / coverage;
            let scatter =
                self.squares[c] - 2.0 * ratio * self.with_coverage[c] + ratio.powi(2) * self.squares[4];
            (scatter.max(0.0) * scale) / coverage.powi(2)
        })
    }
}

/// All pixels' moments.
pub(super) struct Statistics {
    width: u32,
    height: u32,
    pixels: Vec<Moments>,
    /// Those of red and of blue over their own coverage, where it is not green's.
    colours: Option<[Vec<Moments>; 2]>,
    pub samples: u32,
    pub passes: u32,
}

impl Statistics {
    /// Statistics of a picture of `width` × `height` px, without a sample.
    pub fn new(width: u32, height: u32) -> Self {
        let pixels = vec![Moments::default(); width as usize * height as usize];
        Self { width, height, pixels, colours: None, samples: 0, passes: 0 }
    }

    /// Adds a pass of `samples` samples a pixel; `means` holds the pass's mean of red, green, blue and coverage for
    /// every pixel.
    pub fn add(&mut self, samples: u32, means: impl IndexedParallelIterator<Item = [f64; 4]>) {
        self.samples += samples;
        self.passes += 1;
        let weight = f64::from(samples);
        let share = weight / f64::from(self.samples);
        self.pixels.par_iter_mut().zip(means).for_each(|(moments, x)| moments.add(x, weight, share));
    }

    /// Adds the coverage of red and blue of the pass that was [added](Self::add) last, whose radiance `means` holds, too.
    pub fn add_colours(
        &mut self,
        samples: u32,
        means: impl IndexedParallelIterator<Item = [f64; 4]>,
        coverage: impl IndexedParallelIterator<Item = [f64; 2]>,
    ) {
        let (weight, count) = (f64::from(samples), self.pixels.len());
        let share = weight / f64::from(self.samples);
        let empty = || [(); 2].map(|()| vec![Moments::default(); count]);
        let [red, blue] = self.colours.get_or_insert_with(empty);
        let pixels = red.par_iter_mut().zip(blue).zip(means.zip(coverage));
        pixels.for_each(|((red, blue), ([r, _, b, _], [red_coverage, blue_coverage]))| {
            red.add([r, r, r, red_coverage], weight, share);
            blue.add([b, b, b, blue_coverage], weight, share);
        });
    }

    /// The weighted mean of the passes and its standard error, which is infinite before the second pass.
    pub fn estimate(&self) -> Estimate {
        let mut picture = Picture::black(self.width, self.height);
        let mut standard_error = picture.clone();
        let mut luminance_error = vec![f32::INFINITY; self.pixels.len()];
        let mut normalised_error = vec![[f32::INFINITY; 3]; self.pixels.len()];
        let mut normalised_luminance_error = luminance_error.clone();
        // The variance of the mean: Σw(x − mean)²/((passes − 1)·Σw).
        let freedom = f64::from(self.passes.saturating_sub(1)) * f64::from(self.samples);
        let has_error = freedom > 0.0;
        let error = |variance: f64| if has_error { variance.sqrt() as f32 } else { f32::INFINITY };
        for (k, moments) in self.pixels.iter().enumerate() {
            let [r, g, b, _, coverage] = moments.mean.map(|x| x as f32);
            (picture.radiance[k], picture.coverage[k]) = ([r, g, b], coverage);
            let [r, g, b, luminance, coverage] = moments.squares.map(|squares| error(squares / freedom));
            (standard_error.radiance[k], standard_error.coverage[k]) = ([r, g, b], coverage);
            luminance_error[k] = luminance;
            if has_error {
                let [r, g, b, luminance] = moments.ratio_variances(1.0 / freedom).map(error);
                (normalised_error[k], normalised_luminance_error[k]) = ([r, g, b], luminance);
            }
        }
        if let Some(colours) = &self.colours {
            let pixels = 0..self.pixels.len();
            let of_pixel = |k: usize| colours.each_ref().map(|moments| moments[k].mean[4] as f32);
            picture.colour_coverage = Some(pixels.clone().map(of_pixel).collect());
            let of_pixel =
                |k: usize| colours.each_ref().map(|moments| error(moments[k].squares[4] / freedom));
            standard_error.colour_coverage = Some(pixels.clone().map(of_pixel).collect());
            for k in pixels.filter(|_| has_error) {
                for (c, moments) in [(0, &colours[0]), (2, &colours[1])] {
                    normalised_error[k][c] = error(moments[k].ratio_variances(1.0 / freedom)[0]);
                }
                // As if colours erred together: more than they do.
                normalised_luminance_error[k] = luminance(normalised_error[k].map(f64::from)) as f32;
            }
        }
        Estimate {
            picture,
            standard_error,
            luminance_error,
            normalised_error,
            normalised_luminance_error,
            samples_per_pixel: self.samples,
            passes: self.passes,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{hash, unit};

    fn statistics(passes: &[(u32, [f64; 4])]) -> Estimate {
        let mut statistics = Statistics::new(1, 1);
        for &(samples, x) in passes {
            statistics.add(samples, vec![x].into_par_iter());
        }
        statistics.estimate()
    }

    #[test]
    fn errors_are_those_of_the_textbook() {
        let estimate =
            statistics(&[(2, [1.0, 0.0, 7.0, 1.0]), (2, [2.0, 0.0, 7.0, 1.0]), (2, [6.0, 0.0, 7.0, 1.0])]);
        assert_eq!(estimate.picture.radiance, [[3.0, 0.0, 7.0]]);
        // s² = (4 + 1 + 9)/2 = 7, over 3 passes.
        let expected = (7.0f64 / 3.0).sqrt() as f32;
        assert_eq!(estimate.standard_error.radiance, [[expected, 0.0, 0.0]]);
        assert_eq!(estimate.standard_error.coverage, [0.0]);
        assert_eq!(estimate.normalised_error, [[expected, 0.0, 0.0]]);
        let luminance = (0.2126f64.powi(2) * 7.0 / 3.0).sqrt() as f32;
        assert!((estimate.luminance_error[0] - luminance).abs() < 1e-6);
        assert!((estimate.normalised_luminance_error[0] - luminance).abs() < 1e-6);
        assert_eq!((estimate.passes, estimate.samples_per_pixel), (3, 6));
        let rmse = estimate.expected_rmse(Exposure::Conserve);
        assert!((rmse - (7.0f64 / 9.0).sqrt()).abs() < 1e-6, "{rmse}");
    }

    #[test]
    fn one_pass_knows_no_error() {
        let estimate = statistics(&[(5, [1.0, 2.0, 3.0, 1.0])]);
        assert_eq!(estimate.standard_error.radiance, [[f32::INFINITY; 3]]);
        assert_eq!(estimate.normalised_error, [[f32::INFINITY; 3]]);
        assert_eq!(estimate.luminance_error, [f32::INFINITY]);
        assert_eq!(estimate.normalised_luminance_error, [f32::INFINITY]);
    }

    #[test]
    fn luminance_knows_that_its_channels_err_together() {
        let error = |passes: &[(u32, [f64; 4])]| statistics(passes).luminance_error[0];
        let together = error(&[(1, [1.0, 1.0, 1.0, 1.0]), (1, [2.0, 2.0, 2.0, 1.0])]);
        assert!((together - 0.5).abs() < 1e-6, "{together}");
        let apart = error(&[(1, [1.0, 2.0, 1.0, 1.0]), (1, [2.0, 1.0, 2.0, 1.0])]);
        assert!((f64::from(apart) - 0.5 * (0.7152 - 0.2126 - 0.0722)).abs() < 1e-6, "{apart}");
    }

    #[test]
    fn radiance_that_follows_coverage_has_a_sure_ratio() {
        let passes: Vec<_> = (1..9).map(|k| (4, [2.0, 3.0, 0.5, 1.0].map(|c| c * f64::from(k)))).collect();
        let estimate = statistics(&passes);
        assert!(estimate.standard_error.radiance[0][0] > 0.5);
        assert!(estimate.normalised_error[0].iter().all(|error| *error < 1e-6), "{estimate:?}");
    }

    #[test]
    fn errors_tell_the_scatter_of_whole_renders() {
        // Unequal passes of uniform numbers: the mean estimated variance against the variance of estimates.
        let (mut variance, mut scatter) = (0.0, 0.0);
        const RENDERS: u64 = 4000;
        for render in 0..RENDERS {
            let passes: Vec<_> = [4u32, 4, 4, 1]
                .iter()
                .enumerate()
                .map(|(pass, &samples)| {
                    let x = |k: u32| unit(hash([render, pass as u64, u64::from(k)]));
                    let mean = (0..samples).map(x).sum::<f64>() / f64::from(samples);
                    (samples, [mean, 0.0, 0.0, 1.0])
                })
                .collect();
            let estimate = statistics(&passes);
            variance += f64::from(estimate.standard_error.radiance[0][0]).powi(2);
            scatter += (f64::from(estimate.picture.radiance[0][0]) - 0.5).powi(2);
        }
        assert!((variance / scatter - 1.0).abs() < 0.1, "{variance} {scatter}");
        let expected = 1.0 / 12.0 / 13.0;
        assert!((variance / RENDERS as f64 / expected - 1.0).abs() < 0.05, "{variance}");
    }
}
