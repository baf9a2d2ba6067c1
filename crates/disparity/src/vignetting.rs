//! Outer views are darker toward their corners, and exposed differently: compensated before anything is matched.
//!
//! A gain of encoded values is a gain of light (a power law preserves products), so a view differs from the reference by a smooth factor:
//! a polynomial of second degree of the position for the logarithm, for each channel, fitted to the quotients of small pictures. Parallax,
//! gloss and hidden places are outliers: Tukey's weights, with a scale from the median (Holland and Welsch, *Robust Regression Using
//! Iteratively Reweighted Least-Squares*, 1977). Once coarse disparities are known the quotients are of the same points.

use crate::planes::Planes;
use numerics::{MAD_OF_NORMAL, upper_median};

/// Terms of the polynomial: 1, x, y, x², x y, y², with x and y in [−1, 1].
const TERMS: usize = 6;

/// Values below this are too dark for a quotient.
const DARK: f32 = 0.03;

/// The approximate number of compared pixels: they determine a gain to a tenth of a percent.
const PLACES: usize = 3000;

/// The least number of pixels for a fit.
const MIN_QUOTIENTS: usize = 60;

/// A gain whose natural logarithm is below this is negligible.
const NEGLIGIBLE_LOG_GAIN: f32 = 0.002;

/// The factor that makes a view as bright as the reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Gain {
    coefficients: [[f64; TERMS]; 3],
}

impl Gain {
    /// The gain of the small picture `view`, where pixel (x, y) of the reference is at (x − d u, y − d v), or at the same place if there are no
    /// disparities. A gain of 1 where too little can be compared.
    pub fn fit(reference: &Planes, view: &Planes, offset: [f32; 2], disparity: Option<&[f32]>) -> Self {
        let (width, height) = (reference.width(), reference.height());
        let mut quotients: [Vec<(f64, [f64; TERMS])>; 3] = Default::default();
        // Pixels spread over the picture; an odd step follows no column.
        let step = (width * height / PLACES) | 1;
        for index in (0..width * height).step_by(step) {
            let (x, y) = ((index % width) as f32, (index / width) as f32);
            let d = disparity.map_or(0.0, |d| d[index]);
            let place = [x - d * offset[0], y - d * offset[1]];
            let Some(there) = view.sample_bilinear(place[0], place[1]) else { continue };
            let own = reference.pixel(index % width, index / width);
            let terms = terms(place[0] / width as f32, place[1] / height as f32);
            for c in 0..3 {
                if own[c] > DARK && there[c] > 0.3 * DARK && own[c] < 0.99 && there[c] < 0.99 {
                    quotients[c].push((f64::from((own[c] / there[c]).ln()), terms));
                }
            }
        }
        let coefficients = quotients.map(|quotients| fit_robustly(&quotients).unwrap_or([0.0; TERMS]));
        Self { coefficients }
    }

    /// The factor of each channel at a place of the view, as shares of its width and height.
    pub fn at(&self, x: f32, y: f32) -> [f32; 3] {
        let terms = terms(x, y);
        self.coefficients.map(|own| {
            let logarithm: f64 = own.iter().zip(terms).map(|(a, b)| a * b).sum();
            // A view that has to be brightened a hundredfold is noise; its weight reflects that.
            logarithm.clamp(-4.6, 4.6).exp() as f32
        })
    }

    /// Whether the gain is 1 within the accuracy of the fit.
    pub fn is_negligible(&self) -> bool {
        let places = (0..25).map(|k| ((k % 5) as f32 / 4.0, (k / 5) as f32 / 4.0));
        places.flat_map(|(x, y)| self.at(x, y)).all(|gain| gain.ln().abs() < NEGLIGIBLE_LOG_GAIN)
    }

    /// Brightens a view; returns its weight: 1 / mean gain², as its noise has grown, at most 1.
    pub fn apply(&self, view: &mut Planes) -> f32 {
        if !self.is_negligible() {
            let (width, height) = (view.width() as f32, view.height() as f32);
            view.scale(|x, y| self.at(x as f32 / width, y as f32 / height));
        }
        let places = (0..81).map(|k| ((k % 9) as f32 / 8.0, (k / 9) as f32 / 8.0));
        let square: f32 =
            places.flat_map(|(x, y)| self.at(x, y)).map(|gain| gain * gain).sum::<f32>() / 243.0;
        (1.0 / square).min(1.0)
    }
}

fn terms(x: f32, y: f32) -> [f64; TERMS] {
    let (x, y) = (2.0 * f64::from(x) - 1.0, 2.0 * f64::from(y) - 1.0);
    [1.0, x, y, x * x, x * y, y * y]
}

/// Iteratively reweighted least squares.
fn fit_robustly(quotients: &[(f64, [f64; TERMS])]) -> Option<[f64; TERMS]> {
    if quotients.len() < MIN_QUOTIENTS {
        return None;
    }
    let mut all: Vec<f64> = quotients.iter().map(|q| q.0).collect();
    let middle = upper_median(&mut all)?;
    let mut coefficients = [middle, 0.0, 0.0, 0.0, 0.0, 0.0];
    for _ in 0..8 {
        let residual = |(value, terms): &(f64, [f64; TERMS])| {
            value - coefficients.iter().zip(terms).map(|(a, b)| a * b).sum::<f64>()
        };
        let mut sizes: Vec<f64> = quotients.iter().map(|q| residual(q).abs()).collect();
        // Tukey's 4.685 standard deviations; a median of 0 (equal pictures) is replaced by the step of 8-bit values.
        let cut = 4.685 * (upper_median(&mut sizes)? / MAD_OF_NORMAL).max(1e-3);
        let mut system = [[0.0; TERMS + 1]; TERMS];
        for quotient in quotients {
            let share = residual(quotient) / cut;
            if share.abs() >= 1.0 {
                continue;
            }
            let weight = (1.0 - share * share).powi(2);
            for (i, row) in system.iter_mut().enumerate() {
                for (value, term) in row.iter_mut().zip(quotient.1) {
                    *value += weight * quotient.1[i] * term;
                }
                row[TERMS] += weight * quotient.1[i] * quotient.0;
            }
        }
        coefficients = solve(system)?;
    }
    Some(coefficients)
}

/// Gaussian elimination with pivots; `None` if the places of the quotients determine no polynomial.
fn solve(mut system: [[f64; TERMS + 1]; TERMS]) -> Option<[f64; TERMS]> {
    let scale = (0..TERMS).map(|i| system[i][i]).fold(0.0, f64::max);
    for i in 0..TERMS {
        let pivot = (i..TERMS).max_by(|&a, &b| system[a][i].abs().total_cmp(&system[b][i].abs()))?;
        system.swap(i, pivot);
        if system[i][i].abs() <= 1e-9 * scale {
            return None;
        }
        let own = system[i];
        for (other, row) in system.iter_mut().enumerate() {
            if other != i {
                let factor = row[i] / own[i];
                row.iter_mut().zip(own).for_each(|(value, own)| *value -= factor * own);
            }
        }
    }
    Some(std::array::from_fn(|i| system[i][TERMS] / system[i][i]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vignette_is_fitted_though_a_quarter_shows_something_else() {
        let colour = |x: usize, y: usize| {
            let wave = |k: f32| 0.5 + 0.2 * ((x as f32 * 0.7 * k).sin() + (y as f32 * 0.9 / k).cos());
            [wave(1.0), wave(1.3), wave(0.7)]
        };
        let reference = Planes::from_fn(60, 40, colour);
        let vignette = |x: f32, y: f32| 0.8 - 0.3 * (x - 0.6).powi(2) - 0.2 * (y - 0.4).powi(2);
        let view = Planes::from_fn(60, 40, |x, y| {
            let other = x < 20 && y > 10;
            let dark = vignette(x as f32 / 60.0, y as f32 / 40.0);
            colour(x, y).map(|v| if other { 0.35 } else { v * dark })
        });
        let gain = Gain::fit(&reference, &view, [1.0, 0.0], None);
        for (x, y) in [(0.5, 0.5), (0.95, 0.9), (0.9, 0.05), (0.1, 0.05)] {
            let error = gain.at(x, y)[1] * vignette(x, y) - 1.0;
            assert!(error.abs() < 0.02, "({x}, {y}): {error}");
        }
        assert!(Gain::fit(&reference, &reference, [1.0, 0.0], None).is_negligible());
        assert!(!gain.is_negligible());
    }
}
