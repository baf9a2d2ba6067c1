//! Polynomials of the place in the aperture, by least squares, and how well they tell what is left out.
//!
//! With aᵢ the terms at the place of view i and N = Σ wᵢ aᵢ aᵢᵀ + ridge = L Lᵀ, qᵢ = L⁻¹ aᵢ and z = L⁻¹ Σ wᵢ aᵢ yᵢ: the polynomial of the first
//! n terms is Σ_{t<n} qᵢₜ zₜ at view i, and leaving view i out changes it there by hᵢ = Σ_{t<n} qᵢₜ² times wᵢ eᵢ / (1 − wᵢ hᵢ), eᵢ what is left
//! of yᵢ. As L is a triangle and terms are in order of degree, polynomials of all degrees are told at once.
//!
//! The picture is shown as it is: its own place, the middle, has the terms of the constant alone, so that what is told of a view is the
//! polynomial there less that in the middle.

use super::sightings::Observation;
use std::borrow::Cow;

/// Degrees that are tried, 0 among them.
pub(super) const DEGREES: usize = 5;
/// Terms of the highest.
pub(super) const TERMS: usize = DEGREES * (DEGREES + 1) / 2;

/// A polynomial has at most so many terms for each view that tells of it.
const TERMS_A_VIEW: f64 = 0.5;
/// Added to the squares of each term, of their number: what views do not tell apart (a row, a cross) is told by as little as may be.
const RIDGE: f64 = 1e-3;
/// Views that are farther off than so many times as the middle one of them count less (Huber 1964).
const OUTLIER_FACTOR: f64 = 3.0;
/// Noise is never called far off: linear light, all channels together.
const NOISE: f64 = 0.02;
/// By a polynomial of this degree, over so many rounds.
const OUTLIER_DEGREE: usize = 2;
const ROUNDS: usize = 3;
/// Where no degree leaves less than this of the squared error, no view that is far off is looked for.
const MAX_ERROR_RATIO: f32 = 0.85;

/// Terms of a degree and all below.
const fn terms_of(degree: usize) -> usize {
    (degree + 1) * (degree + 2) / 2
}

/// The terms at places in the aperture.
pub(super) struct Regression {
    /// By view; the last is the picture.
    terms: Vec<[f64; TERMS]>,
    /// What most places have: all views count alike.
    alike: Factor,
}

/// What follows from places and weights alone.
#[derive(Clone)]
struct Factor {
    /// L, row by row.
    triangle: [[f64; TERMS]; TERMS],
    /// By view.
    q: Vec<[f64; TERMS]>,
}

/// A polynomial that is not solved for yet.
struct NormalEquations<'a> {
    factor: Cow<'a, Factor>,
    z: [[f64; 3]; TERMS],
    weights: Vec<f64>,
    all: f64,
}

impl Regression {
    /// Of views from these places, in [−1, 1], in the middle of which the picture is.
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

    /// By degree, the mean squared error of views that are left out (all channels); of 0 that of the picture alone. None where that is
    /// at most `least`, and where no view tells of the block; infinite where too few do for a degree.
    pub fn errors(&self, sightings: &[Observation], least: f32) -> Option<[f32; DEGREES]> {
        let square = |sighting: &Observation| sighting.difference.iter().map(|more| more * more).sum::<f32>();
        let total_error: f32 = sightings.iter().map(|sighting| sighting.weight * square(sighting)).sum();
        let total_weight: f32 = sightings.iter().map(|sighting| sighting.weight).sum();
        if total_error <= least * total_weight {
            return None;
        }
        let first = self.weighted(sightings, self.counts(sightings)?);
        let errors = first.errors(sightings);
        if errors[1..].iter().all(|error| *error > MAX_ERROR_RATIO * errors[0]) {
            return Some(errors);
        }
        Some(self.reweight_outliers(sightings, first).errors(sightings))
    }

    /// The coefficients of the polynomial of a degree, but for the constant.
    pub fn fit_coefficients(&self, sightings: &[Observation], degree: usize) -> [[f32; 3]; TERMS - 1] {
        let mut coefficients = [[0.0; 3]; TERMS];
        let Some(counts) = self.counts(sightings) else { return [[0.0; 3]; TERMS - 1] };
        let NormalEquations { factor, z, .. } =
            self.reweight_outliers(sightings, self.weighted(sightings, counts));
        let triangle = &factor.triangle;
        let count = terms_of(degree);
        for t in (0..count).rev() {
            for c in 0..3 {
                let after: f64 = (t + 1..count).map(|k| triangle[k][t] * coefficients[k][c]).sum();
                coefficients[t][c] = (z[t][c] - after) / triangle[t][t];
            }
        }
        std::array::from_fn(|t| coefficients[t + 1].map(|value| value as f32))
    }

    /// How much each view counts, and the picture; none where no view does: the picture alone tells nothing.
    fn counts(&self, sightings: &[Observation]) -> Option<Vec<f64>> {
        let counts = sightings.iter().map(|sighting| f64::from(sighting.weight)).chain([1.0]);
        sightings.iter().any(|sighting| sighting.weight > 0.0).then(|| counts.collect())
    }

    /// In rounds: views count less that are far off what was told in the round before.
    fn reweight_outliers<'a>(
        &'a self,
        sightings: &[Observation],
        first: NormalEquations<'a>,
    ) -> NormalEquations<'a> {
        let counts = first.weights.clone();
        let mut solved = first;
        for _ in 0..ROUNDS {
            let residuals: Vec<f64> =
                (0..counts.len()).map(|view| solved.residual(view, difference_of(sightings, view))).collect();
            let mut sorted: Vec<f64> = residuals
                .iter()
                .zip(&counts)
                .filter(|(_, count)| **count > 0.0)
                .map(|(residual, _)| *residual)
                .collect();
            let middle = sorted.len() / 2;
            let far = OUTLIER_FACTOR * *sorted.select_nth_unstable_by(middle, f64::total_cmp).1;
            let far = far.max(NOISE);
            if residuals.iter().zip(&counts).all(|(&residual, &count)| residual <= far || count == 0.0) {
                break;
            }
            let weight = |(&count, &residual): (&f64, &f64)| {
                if residual > far { count * far / residual } else { count }
            };
            solved = self.weighted(sightings, counts.iter().zip(&residuals).map(weight).collect());
        }
        solved
    }

    fn weighted(&self, sightings: &[Observation], weights: Vec<f64>) -> NormalEquations<'_> {
        let factor = match weights.iter().all(|weight| *weight == 1.0) {
            true => Cow::Borrowed(&self.alike),
            false => Cow::Owned(Factor::new(&self.terms, &weights)),
        };
        let mut z = [[0.0; 3]; TERMS];
        // The picture shows no more than itself.
        for ((sighting, terms), weight) in sightings.iter().zip(&self.terms).zip(&weights) {
            let difference = sighting.difference.map(|more| weight * f64::from(more));
            for (z, term) in z.iter_mut().zip(terms) {
                (0..3).for_each(|c| z[c] += term * difference[c]);
            }
        }
        for i in 0..TERMS {
            let row = &factor.triangle[i];
            let before = |c: usize| -> f64 { (0..i).map(|k| row[k] * z[k][c]).sum() };
            z[i] = std::array::from_fn(|c| (z[i][c] - before(c)) / row[i]);
        }
        let all = weights.iter().sum();
        NormalEquations { factor, z, weights, all }
    }
}

/// How much more than the picture a view shows; the last is the picture.
fn difference_of(sightings: &[Observation], view: usize) -> [f32; 3] {
    sightings.get(view).map_or([0.0; 3], |sighting| sighting.difference)
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
        // The constant is always told: the picture is one of them.
        (1..TERMS).for_each(|t| triangle[t][t] += RIDGE * all);
        for i in 0..TERMS {
            for j in 0..=i {
                let sum: f64 = (0..j).map(|k| triangle[i][k] * triangle[j][k]).sum();
                let rest = triangle[i][j] - sum;
                triangle[i][j] = if i == j { rest.sqrt() } else { rest / triangle[j][j] };
            }
        }
        let forward = |terms: &[f64; TERMS]| {
            let mut q = *terms;
            for i in 0..TERMS {
                let before: f64 = (0..i).map(|k| triangle[i][k] * q[k]).sum();
                q[i] = (q[i] - before) / triangle[i][i];
            }
            q
        };
        let q = terms.iter().map(forward).collect();
        Self { triangle, q }
    }
}

impl NormalEquations<'_> {
    /// See [`Regression::errors`].
    fn errors(&self, sightings: &[Observation]) -> [f32; DEGREES] {
        let mut errors = [0.0; DEGREES];
        let mut all = 0.0;
        let Factor { q: of_views, .. } = &*self.factor;
        let middle = &of_views[sightings.len()];
        for ((sighting, q), weight) in sightings.iter().zip(of_views).zip(&self.weights) {
            let counts = f64::from(sighting.weight);
            if counts == 0.0 {
                continue;
            }
            all += counts;
            let difference = sighting.difference.map(f64::from);
            // Here, and here less in the middle; what this view does to either.
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
                // Of degree 0 that is the picture itself.
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

    /// How far off a view is that shows so much more, told by the others: what it does to the polynomial itself would hide that.
    fn residual(&self, view: usize, difference: [f32; 3]) -> f64 {
        let degree = (1..=OUTLIER_DEGREE).rev().find(|&degree| self.supports(degree)).unwrap_or(0);
        let q = &self.factor.q[view][..terms_of(degree)];
        let prediction = |c: usize| -> f64 { q.iter().zip(&self.z).map(|(q, z)| q * z[c]).sum() };
        let square = |c: usize| (f64::from(difference[c]) - prediction(c)).powi(2);
        let own = self.weights[view] * q.iter().map(|q| q * q).sum::<f64>();
        (0..3).map(square).sum::<f64>().sqrt() / (1.0 - own).max(f64::EPSILON)
    }

    /// Whether views are enough for a degree.
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

    fn sightings(value_at: impl Fn([f32; 2]) -> f32) -> Vec<Observation> {
        places()
            .into_iter()
            .map(|place| Observation { difference: [value_at(place); 3], weight: 1.0 })
            .collect()
    }

    #[test]
    fn a_polynomial_is_fitted_by_its_own_degree() {
        let regression = Regression::new(&places());
        let all = sightings(|[x, y]| 0.2 * x - 0.1 * y + 0.3 * x * y);
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
        let noisy = sightings(|[x, y]| 0.2 * x + 0.05 * (7.0 * x + 11.0 * y).sin());
        let (mut by_hand, degree) = (0.0, 1);
        for out in 0..noisy.len() {
            let mut others = noisy.clone();
            others[out].weight = 0.0;
            // All count alike here: none is far off.
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
        let mut noise = sightings(|_| 0.0);
        for sighting in &mut noise {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            sighting.difference = [(state >> 8) as f32 / (1 << 24) as f32 * 0.1 - 0.05; 3];
        }
        let errors = regression.errors(&noise, 0.0).unwrap();
        assert!((1..4).all(|degree| errors[degree] > 0.9 * errors[0]), "{errors:?}");
        assert_eq!(regression.errors(&noise, 0.1), None, "little");
        assert_eq!(regression.errors(&[Observation::default(); 24], 0.0), None, "unseen");
    }

    #[test]
    fn one_view_that_is_far_off_moves_little() {
        let regression = Regression::new(&places());
        let mut all = sightings(|[x, y]| 0.2 * x + 0.004 * (37.0 * y).sin());
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
