//! Polynomials of the position in the aperture, by least squares, and their leave-one-out cross-validation.
//!
//! With aᵢ the terms at the position of view i and N = Σ wᵢ aᵢ aᵢᵀ + ridge = L Lᵀ, qᵢ = L⁻¹ aᵢ and z = L⁻¹ Σ wᵢ aᵢ yᵢ: the polynomial of the
//! first n terms is Σ_{t<n} qᵢₜ zₜ at view i, and leaving view i out changes it there by hᵢ = Σ_{t<n} qᵢₜ² times wᵢ eᵢ / (1 − wᵢ hᵢ), eᵢ the
//! residual of yᵢ. As L is triangular and terms are in order of degree, polynomials of all degrees are solved at once.
//!
//! The picture is exact: its own position, the middle, has only the constant term, so that the prediction for a view is the polynomial
//! there minus that in the middle.

use super::observations::Observation;
use numerics::{back_substitute, decompose_positive, forward_substitute, upper_median};
use std::borrow::Cow;

/// Number of degrees, including 0.
pub(super) const DEGREES: usize = 5;
/// Number of terms of the highest.
pub(super) const TERMS: usize = DEGREES * (DEGREES + 1) / 2;

/// The most terms of a polynomial for each view.
const TERMS_A_VIEW: f64 = 0.5;
/// Added to the squares of each term, times the number of views: directions that views do not determine (a row, a
/// cross) get small coefficients.
const RIDGE: f64 = 1e-3;
/// Views with more than so many times the median residual have less weight (Huber 1964).
const OUTLIER_FACTOR: f64 = 3.0;
/// Residuals below the noise are never outliers: linear light, all channels together.
const NOISE: f64 = 0.02;
/// The degree of the polynomial that detects outliers, and the number of rounds.
const OUTLIER_DEGREE: usize = 2;
const ROUNDS: usize = 3;
/// If no degree reduces the squared error below this share, outliers are not looked for.
const MAX_ERROR_RATIO: f32 = 0.85;

/// Number of terms of a degree and all below.
const fn terms_of(degree: usize) -> usize {
    (degree + 1) * (degree + 2) / 2
}

/// The terms at positions in the aperture.
pub(super) struct Regression {
    /// By view; the last is the picture.
    terms: Vec<[f64; TERMS]>,
    /// The factor for equal weights of all views, which most blocks have.
    alike: Factor,
}

/// What depends on positions and weights only.
#[derive(Clone)]
struct Factor {
    /// L, row by row.
    triangle: [[f64; TERMS]; TERMS],
    /// By view.
    q: Vec<[f64; TERMS]>,
}

/// A weighted least-squares problem in triangular form.
struct NormalEquations<'a> {
    factor: Cow<'a, Factor>,
    z: [[f64; 3]; TERMS],
    weights: Vec<f64>,
    all: f64,
}

impl Regression {
    /// Prepares to fit what views at these positions show, in [−1, 1]², with the picture in the middle.
    pub fn new(places: &[[f32; 2]]) -> Self {
        let terms = |place: &[f32; 2]| {
            let [x, y] = place.map(f64::from);
            let mut terms = [0.0; TERMS];
            for degree in 0..DEGREES {
                for k in 0..=degree {
                    let number = degree * (degree + 1) / 2 + k;
                    terms[number] = x.powi((degree - k) as i32) * y.powi(k as i32);
                }
            }
            terms
        };
        let terms: Vec<_> = places.iter().chain([&[0.0; 2]]).map(terms).collect();
        let alike = Factor::new(&terms, &vec![1.0; terms.len()]);
        Self { terms, alike }
    }

    /// By degree, the mean squared error of predicting views that are left out (all channels); for degree 0 that of the picture alone. `None`
    /// where that is at most `least`, and where no view shows the block; infinite for degrees with too few views.
    pub fn errors(&self, observations: &[Observation], least: f32) -> Option<[f32; DEGREES]> {
        let square =
            |observation: &Observation| observation.difference.iter().map(|more| more * more).sum::<f32>();
        let total_error: f32 =
            observations.iter().map(|observation| observation.weight * square(observation)).sum();
        let total_weight: f32 = observations.iter().map(|observation| observation.weight).sum();
        if total_error <= least * total_weight {
            return None;
        }
        let first = self.weighted(observations, self.counts(observations)?);
        let errors = first.errors(observations);
        if errors[1..].iter().all(|error| *error > MAX_ERROR_RATIO * errors[0]) {
            return Some(errors);
        }
        Some(self.reweight_outliers(observations, first).errors(observations))
    }

    /// The coefficients, RGB, of the polynomial of degree `degree` that fits the observations; without the constant.
    pub fn fit_coefficients(&self, observations: &[Observation], degree: usize) -> [[f32; 3]; TERMS - 1] {
        let Some(counts) = self.counts(observations) else { return [[0.0; 3]; TERMS - 1] };
        let NormalEquations { factor, z: mut coefficients, .. } =
            self.reweight_outliers(observations, self.weighted(observations, counts));
        let (of_degree, beyond) = coefficients.split_at_mut(terms_of(degree));
        back_substitute(&factor.triangle, of_degree);
        beyond.fill([0.0; 3]);
        std::array::from_fn(|t| coefficients[t + 1].map(|value| value as f32))
    }

    /// The weight of each view, and of the picture; `None` where no view has any: the picture alone determines
    /// nothing.
    fn counts(&self, observations: &[Observation]) -> Option<Vec<f64>> {
        let counts = observations.iter().map(|observation| f64::from(observation.weight)).chain([1.0]);
        observations.iter().any(|observation| observation.weight > 0.0).then(|| counts.collect())
    }

    /// Reweights in rounds: views with large residuals in the previous round have less weight.
    fn reweight_outliers<'a>(
        &'a self,
        observations: &[Observation],
        first: NormalEquations<'a>,
    ) -> NormalEquations<'a> {
        let counts = first.weights.clone();
        let mut solved = first;
        for _ in 0..ROUNDS {
            let residuals: Vec<f64> = (0..counts.len())
                .map(|view| solved.residual(view, difference_of(observations, view)))
                .collect();
            let mut sorted: Vec<f64> = residuals
                .iter()
                .zip(&counts)
                .filter(|(_, count)| **count > 0.0)
                .map(|(residual, _)| *residual)
                .collect();
            let Some(median) = upper_median(&mut sorted) else { break };
            let far = (OUTLIER_FACTOR * median).max(NOISE);
            if residuals.iter().zip(&counts).all(|(&residual, &count)| residual <= far || count == 0.0) {
                break;
            }
            let weight = |(&count, &residual): (&f64, &f64)| {
                if residual > far { count * far / residual } else { count }
            };
            solved = self.weighted(observations, counts.iter().zip(&residuals).map(weight).collect());
        }
        solved
    }

    fn weighted(&self, observations: &[Observation], weights: Vec<f64>) -> NormalEquations<'_> {
        let factor = match weights.iter().all(|weight| *weight == 1.0) {
            true => Cow::Borrowed(&self.alike),
            false => Cow::Owned(Factor::new(&self.terms, &weights)),
        };
        let mut z = [[0.0; 3]; TERMS];
        // The picture does not differ from itself.
        for ((observation, terms), weight) in observations.iter().zip(&self.terms).zip(&weights) {
            let difference = observation.difference.map(|more| weight * f64::from(more));
            for (z, term) in z.iter_mut().zip(terms) {
                (0..3).for_each(|c| z[c] += term * difference[c]);
            }
        }
        forward_substitute(&factor.triangle, &mut z);
        let all = weights.iter().sum();
        NormalEquations { factor, z, weights, all }
    }
}

/// The difference between a view and the picture; the last is the picture.
fn difference_of(observations: &[Observation], view: usize) -> [f32; 3] {
    observations.get(view).map_or([0.0; 3], |observation| observation.difference)
}

impl Factor {
    fn new(terms: &[[f64; TERMS]], weights: &[f64]) -> Self {
        let mut triangle = [[0.0; TERMS]; TERMS];
        for (terms, &weight) in terms.iter().zip(weights).filter(|(_, weight)| **weight > 0.0) {
            for i in 0..TERMS {
                let weighted = weight * terms[i];
                (0..=i).for_each(|j| triangle[i][j] += weighted * terms[j]);
            }
        }
        let all: f64 = weights.iter().sum();
        // The constant is always determined: the picture is one of the views.
        (1..TERMS).for_each(|t| triangle[t][t] += RIDGE * all);
        decompose_positive(&mut triangle);
        let forward = |terms: &[f64; TERMS]| {
            let mut q = *terms;
            forward_substitute(&triangle, q.as_chunks_mut::<1>().0);
            q
        };
        let q = terms.iter().map(forward).collect();
        Self { triangle, q }
    }
}

impl NormalEquations<'_> {
    /// See [`Regression::errors`].
    fn errors(&self, observations: &[Observation]) -> [f32; DEGREES] {
        let mut errors = [0.0; DEGREES];
        let mut all = 0.0;
        let Factor { q: of_views, .. } = &*self.factor;
        let middle = &of_views[observations.len()];
        for ((observation, q), weight) in observations.iter().zip(of_views).zip(&self.weights) {
            let counts = f64::from(observation.weight);
            if counts == 0.0 {
                continue;
            }
            all += counts;
            let difference = observation.difference.map(f64::from);
            // Here, and here minus the middle; the influence of this view on either.
            let (mut here, mut beyond, mut own, mut own_beyond) = ([0.0; 3], [0.0; 3], 0.0, 0.0);
            for (degree, error) in errors.iter_mut().enumerate() {
                for t in terms_of(degree) - degree - 1..terms_of(degree) {
                    for c in 0..3 {
                        here[c] += q[t] * self.z[t][c];
                        beyond[c] += (q[t] - middle[t]) * self.z[t][c];
                    }
                    own += q[t] * q[t];
                    own_beyond += (q[t] - middle[t]) * q[t];
                }
                let left_out = weight / (1.0 - weight * own).max(f64::EPSILON);
                // Degree 0 is the picture itself.
                let prediction = |c: usize| match degree {
                    0 => 0.0,
                    _ => beyond[c] - own_beyond * left_out * (difference[c] - here[c]),
                };
                *error += counts * (0..3).map(|c| (difference[c] - prediction(c)).powi(2)).sum::<f64>();
            }
        }
        let is_supported = |degree: usize| degree == 0 || self.supports(degree);
        std::array::from_fn(
            |degree| if is_supported(degree) { (errors[degree] / all) as f32 } else { f32::INFINITY },
        )
    }

    /// The residual of a view as predicted by the others: its own influence on the polynomial would hide it.
    fn residual(&self, view: usize, difference: [f32; 3]) -> f64 {
        let degree = (1..=OUTLIER_DEGREE).rev().find(|&degree| self.supports(degree)).unwrap_or(0);
        let q = &self.factor.q[view][..terms_of(degree)];
        let prediction = |c: usize| -> f64 { q.iter().zip(&self.z).map(|(q, z)| q * z[c]).sum() };
        let square = |c: usize| (f64::from(difference[c]) - prediction(c)).powi(2);
        let own = self.weights[view] * q.iter().map(|q| q * q).sum::<f64>();
        (0..3).map(square).sum::<f64>().sqrt() / (1.0 - own).max(f64::EPSILON)
    }

    /// Whether there are enough views for a degree.
    fn supports(&self, degree: usize) -> bool {
        terms_of(degree) as f64 <= TERMS_A_VIEW * self.all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn places() -> Vec<[f32; 2]> {
        let all = (0..25).map(|k| [(k % 5) as f32 / 2.0 - 1.0, (k / 5) as f32 / 2.0 - 1.0]);
        all.filter(|place| *place != [0.0; 2]).collect()
    }

    fn observations(value_at: impl Fn([f32; 2]) -> f32) -> Vec<Observation> {
        places()
            .into_iter()
            .map(|place| Observation { difference: [value_at(place); 3], weight: 1.0 })
            .collect()
    }

    #[test]
    fn a_polynomial_is_fitted_by_its_own_degree() {
        let regression = Regression::new(&places());
        let all = observations(|[x, y]| 0.2 * x - 0.1 * y + 0.3 * x * y);
        let errors = regression.errors(&all, 0.0).unwrap();
        assert!(errors[2] < 1e-3 * errors[1] && errors[1] < errors[0], "{errors:?}");
        assert_eq!(errors[4], f32::INFINITY, "25 views do not tell 15 terms");
        let coefficients = regression.fit_coefficients(&all, 2);
        for (fitted, expected) in coefficients.iter().zip([0.2, -0.1, 0.0, 0.3, 0.0, 0.0]) {
            assert!((fitted[1] - expected).abs() < 2e-3, "{coefficients:?}");
        }
        assert_eq!(coefficients[5..], [[0.0; 3]; TERMS - 6]);
    }

    #[test]
    fn what_is_left_out_is_predicted_by_the_others() {
        let regression = Regression::new(&places());
        let noisy = observations(|[x, y]| 0.2 * x + 0.05 * (7.0 * x + 11.0 * y).sin());
        let (mut by_hand, degree) = (0.0, 1);
        for out in 0..noisy.len() {
            let mut others = noisy.clone();
            others[out].weight = 0.0;
            // All have equal weight here: none is an outlier.
            let coefficients = regression.fit_coefficients(&others, degree);
            let [x, y] = places()[out];
            let square = (0..3).map(|c| {
                (noisy[out].difference[c] - coefficients[0][c] * x - coefficients[1][c] * y).powi(2)
            });
            by_hand += square.sum::<f32>() / noisy.len() as f32;
        }
        let error = regression.errors(&noisy, 0.0).unwrap()[degree];
        assert!((error - by_hand).abs() < 0.01 * by_hand, "{error} {by_hand}");
    }

    #[test]
    fn noise_is_predicted_by_nothing() {
        let regression = Regression::new(&places());
        let mut state = 1u32;
        let mut noise = observations(|_| 0.0);
        for observation in &mut noise {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            observation.difference = [(state >> 8) as f32 / (1 << 24) as f32 * 0.1 - 0.05; 3];
        }
        let errors = regression.errors(&noise, 0.0).unwrap();
        assert!((1..4).all(|degree| errors[degree] > 0.9 * errors[0]), "{errors:?}");
        assert_eq!(regression.errors(&noise, 0.1), None, "little");
        assert_eq!(regression.errors(&[Observation::default(); 24], 0.0), None, "unseen");
    }

    #[test]
    fn one_view_that_is_far_off_moves_little() {
        let regression = Regression::new(&places());
        let mut all = observations(|[x, y]| 0.2 * x + 0.004 * (37.0 * y).sin());
        all[0].difference = [3.0; 3];
        let coefficients = regression.fit_coefficients(&all, 1);
        assert!((coefficients[0][0] - 0.2).abs() < 0.05, "{coefficients:?}");
    }

    #[test]
    fn views_in_a_row_constrain_nothing_across_it() {
        let row: Vec<[f32; 2]> = (0..9).filter(|k| *k != 4).map(|k| [k as f32 / 4.0 - 1.0, 0.0]).collect();
        let regression = Regression::new(&row);
        let all: Vec<Observation> =
            row.iter().map(|[x, _]| Observation { difference: [0.3 * x; 3], weight: 1.0 }).collect();
        let coefficients = regression.fit_coefficients(&all, 1);
        assert!((coefficients[0][0] - 0.3).abs() < 2e-3 && coefficients[1] == [0.0; 3], "{coefficients:?}");
    }
}
