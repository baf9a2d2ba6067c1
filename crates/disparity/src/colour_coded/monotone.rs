//! A monotone function through noisy samples some of which are wrong.
//!
//! First medians of parts, made monotone by pooling adjacent violators (Ayer et al., *An Empirical Distribution Function for Sampling with
//! Incomplete Information*, 1955); then means of the samples that are not far from that. Linear between parts, and beyond the
//! outermost.

use numerics::upper_median;

/// Samples per part.
const PART: usize = 9;

/// The most parts.
const PARTS: usize = 48;

/// The function, as knots of (place, value).
#[derive(Clone, Debug)]
pub struct MonotoneFunction {
    knots: Vec<(f32, f32)>,
}

impl MonotoneFunction {
    /// Fits a growing function to samples of (place, value); `None` if they do not grow.
    pub fn fit(samples: &[(f32, f32)]) -> Option<Self> {
        let mut sorted = samples.to_vec();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let median = |values: &mut [f32]| upper_median(values).expect("parts are never empty");
        let rough = Self::of_parts(&sorted, median)?;
        let mut residuals: Vec<f32> = sorted.iter().map(|(place, v)| (rough.at(*place) - v).abs()).collect();
        let cut = 4.0 * upper_median(&mut residuals)?;
        let inliers: Vec<(f32, f32)> =
            sorted.into_iter().filter(|(place, v)| (rough.at(*place) - v).abs() <= cut).collect();
        let fine = Self::of_parts(&inliers, |values| values.iter().sum::<f32>() / values.len() as f32);
        fine.or(Some(rough))
    }

    fn of_parts(sorted: &[(f32, f32)], mean: impl Fn(&mut [f32]) -> f32) -> Option<Self> {
        let size = PART.max(sorted.len().div_ceil(PARTS));
        // (place, value, weight), pooled until values grow.
        let mut pools: Vec<(f32, f32, f32)> = Vec::new();
        for part in sorted.chunks(size) {
            let weight = part.len() as f32;
            let place = part.iter().map(|s| s.0).sum::<f32>() / weight;
            let value = mean(&mut part.iter().map(|s| s.1).collect::<Vec<_>>());
            pools.push((place, value, weight));
            while let [.., a, b] = pools[..] {
                if a.1 < b.1 && a.0 < b.0 {
                    break;
                }
                let weight = a.2 + b.2;
                let joint = |a: f32, b: f32, wa: f32, wb: f32| (a * wa + b * wb) / weight;
                pools.truncate(pools.len() - 2);
                pools.push((joint(a.0, b.0, a.2, b.2), joint(a.1, b.1, a.2, b.2), weight));
            }
        }
        if pools.len() < 2 {
            return None;
        }
        Some(Self { knots: pools.into_iter().map(|(place, value, _)| (place, value)).collect() })
    }

    /// The value at a place; beyond the samples the line through the two outermost knots is extended.
    pub fn at(&self, place: f32) -> f32 {
        let after = self.knots.partition_point(|knot| knot.0 < place).clamp(1, self.knots.len() - 1);
        let (a, b) = (self.knots[after - 1], self.knots[after]);
        a.1 + (place - a.0) / (b.0 - a.0) * (b.1 - a.1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_is_fitted_though_a_fifth_of_the_samples_is_wrong() {
        let samples: Vec<(f32, f32)> = (0..400)
            .map(|i| {
                let place = (i * 37 % 400) as f32 / 399.0;
                (place, if i % 5 == 0 { (i * 13 % 7) as f32 / 7.0 } else { place * place })
            })
            .collect();
        let growth = MonotoneFunction::fit(&samples).unwrap();
        for k in 0..=20 {
            let place = k as f32 / 20.0;
            assert!((growth.at(place) - place * place).abs() < 0.02, "{place}: {}", growth.at(place));
        }
        assert!(MonotoneFunction::fit(&[(0.5, 1.0); 50]).is_none());
    }
}
