//! Whether two pictures agree within their standard errors.

use crate::{LinearPicture, ProjectError};
use lens::Exposure;
use numerics::luminance;
use serde::Serialize;

/// Maximum distance of two estimates, in standard errors.
const MAX_STANDARD_ERRORS: f64 = 3.0;

/// Maximum relative distance of two numbers due to rounding of floats alone: 2⁻²³.
const RELATIVE_ROUNDING: f64 = 1.0 / (1 << 23) as f64;

/// Message about a picture without finite standard errors.
const NOT_FINITE: &str = "has no finite standard errors";

/// Fractions of the estimates that differ by at most three standard errors of the difference: the root of the sum of
/// both pictures' squared standard errors. For estimates with purely random, normally distributed errors the fraction
/// is 99.73 %.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ZAgreement {
    /// Of all numbers: red, green, blue, and coverage if both pictures have it as their model's sum.
    #[serde(rename = "z_agree")]
    pub values: f64,
    /// Of the pixels, judged by luminance (Rec. 709).
    #[serde(rename = "z_agree_luminance")]
    pub luminance: f64,
    /// Of the pixels, all of whose numbers agree.
    #[serde(rename = "z_agree_pixels")]
    pub pixels: f64,
    /// Root mean square of the differences in standard errors, over those that have any; 1 for random errors.
    #[serde(rename = "z_rms")]
    pub rms: f64,
}

/// Compares two pictures with the standard errors stored in their files (`--aov stderr`); a picture without any
/// counts as exact. Numbers that are not finite agree with nothing.
///
/// # Errors
/// [`ProjectError::SizesDiffer`]; [`ProjectError::Untestable`] if neither picture has standard errors, if any is not
/// finite (they cannot be estimated from a single pass), if exposures differ, or if a picture has some of them but
/// not luminance's.
pub fn z_test(a: &LinearPicture, b: &LinearPicture) -> Result<ZAgreement, ProjectError> {
    let sizes = [[a.width, a.height], [b.width, b.height]];
    if sizes[0] != sizes[1] {
        return Err(ProjectError::SizesDiffer { a: sizes[0], b: sizes[1] });
    }
    let exposure = match (a.exposure, b.exposure) {
        (Some(a), Some(b)) if a != b => {
            return Err(ProjectError::Untestable("one is conserved, the other normalised".into()));
        }
        (a, b) => a.or(b).unwrap_or(Exposure::Conserve),
    };
    let estimates = [PictureEstimate::new(a, exposure)?, PictureEstimate::new(b, exposure)?];
    if estimates.iter().all(|picture| picture.errors.is_none()) {
        return Err(ProjectError::Untestable("neither has standard errors".into()));
    }
    Ok(measure_agreement(&estimates, a.rgb.len()))
}

/// A picture's numbers with their errors.
struct PictureEstimate<'a> {
    rgb: &'a [[f32; 3]],
    /// As the model's sum; `None` for a normalised picture.
    coverage: Option<&'a [f32]>,
    errors: Option<StandardErrors<'a>>,
}

struct StandardErrors<'a> {
    rgb: [&'a [f32]; 3],
    luminance: &'a [f32],
    coverage: Option<&'a [f32]>,
}

impl<'a> PictureEstimate<'a> {
    fn new(picture: &'a LinearPicture, exposure: Exposure) -> Result<Self, ProjectError> {
        let is_conserved = exposure == Exposure::Conserve;
        let group = if is_conserved { "stderr" } else { "stderr.normalised" };
        let layer = |name: &str| picture.layers.get(name).map(Vec::as_slice);
        let errors = |name: &str| layer(&format!("{group}.{name}"));
        let coverage = layer("coverage").filter(|_| is_conserved);
        let layers = ["R", "G", "B", "Y"].map(errors);
        let errors = match layers {
            [Some(r), Some(g), Some(b), Some(luminance)] => {
                let coverage = errors("coverage").filter(|_| is_conserved);
                Some(StandardErrors { rgb: [r, g, b], luminance, coverage })
            }
            [None, None, None, None] => None,
            _ => {
                let which = format!("one has only some of {group}.R, .G, .B and .Y");
                return Err(ProjectError::Untestable(which));
            }
        };
        let all = errors.iter().flat_map(|e| e.rgb.into_iter().chain([e.luminance]).chain(e.coverage));
        if all.flatten().any(|error| !(error.is_finite() && *error >= 0.0)) {
            return Err(ProjectError::Untestable(format!("one {NOT_FINITE}")));
        }
        Ok(Self { rgb: &picture.rgb, coverage, errors })
    }

    /// Red, green, blue and, if present, coverage of a pixel, each with its error.
    fn channel_estimates(&self, pixel: usize) -> [Option<[f64; 2]>; 4] {
        let error = |channel: usize| self.errors.as_ref().map_or(0.0, |e| f64::from(e.rgb[channel][pixel]));
        let [r, g, b] = [0, 1, 2].map(|c| Some([f64::from(self.rgb[pixel][c]), error(c)]));
        // If there are errors, but none of coverage, the error of coverage is not available.
        let coverage = self.coverage.and_then(|coverage| {
            let error = match &self.errors {
                Some(errors) => f64::from(errors.coverage?[pixel]),
                None => 0.0,
            };
            Some([f64::from(coverage[pixel]), error])
        });
        [r, g, b, coverage]
    }

    /// A pixel's luminance and its error.
    fn luminance_estimate(&self, pixel: usize) -> [f64; 2] {
        let [r, g, b] = self.rgb[pixel].map(f64::from);
        let error = self.errors.as_ref().map_or(0.0, |e| f64::from(e.luminance[pixel]));
        [luminance([r, g, b]), error]
    }
}

/// The difference of two estimates of a number.
#[derive(Clone, Copy)]
struct Distance {
    agrees: bool,
    /// In standard errors, squared; `None` if there are none.
    z_squared: Option<f64>,
}

fn distance([a, error_a]: [f64; 2], [b, error_b]: [f64; 2]) -> Distance {
    let (apart, error) = ((a - b).abs(), error_a.hypot(error_b));
    let agrees = apart <= MAX_STANDARD_ERRORS * error + RELATIVE_ROUNDING * a.abs().max(b.abs());
    Distance { agrees, z_squared: (error > 0.0).then(|| (apart / error).powi(2)) }
}

fn measure_agreement([a, b]: &[PictureEstimate; 2], pixels: usize) -> ZAgreement {
    let share = |agree: usize, total: usize| agree as f64 / total.max(1) as f64;
    let [mut numbers, mut agreeing, mut by_luminance, mut by_all, mut scattered] = [0usize; 5];
    let mut squares = 0.0;
    for pixel in 0..pixels {
        let pairs = a.channel_estimates(pixel).into_iter().zip(b.channel_estimates(pixel));
        let mut all_agree = true;
        for pair_distance in pairs.filter_map(|(a, b)| Some(distance(a?, b?))) {
            numbers += 1;
            agreeing += usize::from(pair_distance.agrees);
            all_agree &= pair_distance.agrees;
            if let Some(z_squared) = pair_distance.z_squared {
                scattered += 1;
                squares += z_squared;
            }
        }
        by_all += usize::from(all_agree);
        by_luminance +=
            usize::from(distance(a.luminance_estimate(pixel), b.luminance_estimate(pixel)).agrees);
    }
    ZAgreement {
        values: share(agreeing, numbers),
        luminance: share(by_luminance, pixels),
        pixels: share(by_all, pixels),
        rms: (squares / scattered.max(1) as f64).sqrt(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture of one row whose values are normal about `mean`, with a standard error of 1.
    fn normal(seed: u64, mean: f32) -> LinearPicture {
        const PIXELS: u32 = 20_000;
        // The sum of twelve uniform numbers has the variance 1 (and nothing beyond 6, which does not matter here).
        let mut state = seed;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1u64 << 24) as f32
        };
        let mut value = || mean + (0..12).map(|_| uniform()).sum::<f32>() - 6.0;
        let rgb = (0..PIXELS).map(|_| [value(), value(), value()]).collect();
        let coverage = (0..PIXELS).map(|_| value()).collect();
        let luminance = (0.2126f32.powi(2) + 0.7152f32.powi(2) + 0.0722f32.powi(2)).sqrt();
        let layers = ["R", "G", "B", "coverage", "Y"].map(|name| {
            let error = if name == "Y" { luminance } else { 1.0 };
            (format!("stderr.{name}"), vec![error; PIXELS as usize])
        });
        let layers = layers.into_iter().chain([("coverage".to_string(), coverage)]).collect();
        LinearPicture { width: PIXELS, height: 1, rgb, layers, exposure: Some(Exposure::Conserve) }
    }

    #[test]
    fn random_errors_agree_as_often_as_expected_and_a_shift_does_not() {
        let found = z_test(&normal(1, 5.0), &normal(2, 5.0)).unwrap();
        assert!((found.values - 0.9973).abs() < 1e-3, "{found:?}");
        assert!((found.luminance - 0.9973).abs() < 1.5e-3, "{found:?}");
        assert!((found.pixels - 0.9973f64.powi(4)).abs() < 3e-3, "{found:?}");
        assert!((found.rms - 1.0).abs() < 0.01, "{found:?}");
        // Negative control: half a standard error of the difference off.
        let found = z_test(&normal(1, 5.7), &normal(2, 5.0)).unwrap();
        assert!(found.values < 0.9955 && found.luminance < 0.993 && found.rms > 1.1, "{found:?}");
    }

    #[test]
    fn pictures_without_errors_are_exact_and_two_of_them_cannot_be_tested() {
        let (estimate, exact) = (normal(1, 5.0), {
            let rgb = vec![[5.0; 3]; 20_000];
            LinearPicture { layers: [].into(), exposure: None, rgb, ..normal(2, 5.0) }
        });
        let found = z_test(&estimate, &exact).unwrap();
        assert!((found.values - 0.9973).abs() < 1e-3 && (found.rms - 1.0).abs() < 0.01, "{found:?}");
        assert!(z_test(&exact, &exact).is_err());
    }

    #[test]
    fn what_has_no_error_must_be_equal_but_for_rounding() {
        let certain = |value: f32| {
            let mut picture = normal(1, 5.0);
            picture.rgb.fill([value; 3]);
            picture.layers.values_mut().for_each(|layer| layer.fill(0.0));
            picture
        };
        let shares = |a: f32, b: f32| {
            let found = z_test(&certain(a), &certain(b)).unwrap();
            [found.values, found.luminance, found.pixels]
        };
        let next = f32::from_bits(0.5f32.to_bits() + 1);
        assert_eq!(shares(0.5, next), [1.0; 3]);
        assert_eq!(shares(0.5, 0.5001), [0.25, 0.0, 0.0], "coverage, 0 of both, agrees");
        assert_eq!(shares(0.5, f32::NAN), [0.25, 0.0, 0.0]);
    }

    #[test]
    fn what_cannot_be_tested_is_refused() {
        let good = normal(1, 5.0);
        let broken = |change: fn(&mut LinearPicture)| {
            let mut picture = good.clone();
            change(&mut picture);
            z_test(&picture, &good).unwrap_err().to_string()
        };
        let unknown = broken(|p| p.layers.get_mut("stderr.G").unwrap()[7] = f32::INFINITY);
        assert!(unknown.contains(NOT_FINITE), "{unknown}");
        let some = broken(|p| drop(p.layers.remove("stderr.Y")));
        assert!(some.contains("only some"), "{some}");
        let exposure = broken(|p| p.exposure = Some(Exposure::Normalise));
        assert!(exposure.contains("normalised"), "{exposure}");
        assert!(broken(|p| p.width = 3).contains('3'));
    }
}
