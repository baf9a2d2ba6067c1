//! Robust mean of what several photographs show of a texel.
//!
//! Iteratively reweighted least squares. Differences are measured between square roots, where noise is about the same
//! for dark and bright. With five observations or more, Tukey's biweight (Beaton and Tukey 1974) rejects values beyond
//! 4.685 scales, the scale being the median difference; with three or four, none can be rejected reliably and Huber's
//! weights only limit the influence of each; two are averaged.

use glam::Vec3;

/// What one photograph shows of a texel, as radiance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    pub light: Vec3,
    /// Weight, > 0.
    pub weight: f32,
    /// Share of clipped pixels, in [0, 1].
    pub clipped: f32,
}

/// A clipped value is a lower bound. Where the reference already satisfies the bound, it gets this weight.
const CLIPPED_WEIGHT: f32 = 0.005;
/// The bound counts as satisfied if exceeded by this share, which allows for noise.
const CLIPPED_MARGIN: f32 = 0.05;
/// Channels of a clipped sample that reach this share of its brightest channel are clipped, too: it was white.
const LIMIT_SHARE: f32 = 0.95;
/// Share of clipped pixels from which a sample counts as wholly clipped: noise leaves some pixels below the limit.
const FULLY_LIMITED_SHARE: f32 = 0.25;

impl Sample {
    /// The sample with other light (linear RGB) and the same weight.
    pub fn with_light(self, light: Vec3) -> Self {
        Self { light, ..self }
    }

    /// How far the light is only a lower bound, in [0, 1]: a mean that includes clipped pixels is too dark as a whole.
    fn limited_share(&self) -> f32 {
        (self.clipped / FULLY_LIMITED_SHARE).min(1.0)
    }

    /// The weight that the sample has whatever the reference: clipped light counts less.
    pub fn min_weight(&self) -> f32 {
        self.weight * (1.0 - (1.0 - CLIPPED_WEIGHT) * self.clipped)
    }

    /// Weight against a reference value: a satisfied bound says little, a violated one as much as any sample.
    pub fn weight_against(&self, reference: Vec3) -> f32 {
        if self.clipped == 0.0 {
            return self.weight;
        }
        // The brightest channel is the clipped one.
        let channel = self.light.max_position();
        let excess = reference[channel] - self.light[channel];
        let limit_satisfaction =
            (excess / (CLIPPED_MARGIN * self.light[channel].abs()).max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
        self.weight * (1.0 - (1.0 - CLIPPED_WEIGHT) * self.limited_share() * limit_satisfaction)
    }
}

/// Minimum number of samples for any to be rejected.
const MIN_SAMPLES_TO_REJECT: usize = 5;
/// 95 % efficiency for normal errors.
const TUKEY: f32 = 4.685;
const HUBER: f32 = 1.345;
/// Lower bound of the scale of differences of roots: 8-bit quantisation and JPEG.
const MIN_SCALE: f32 = 0.012;
const ROUNDS: usize = 6;

/// Robust mean of samples; fills `inlier_weights` with the inlier weight of each, in [0, 1]. Black for no samples.
pub(crate) fn robust_mean(samples: &[Sample], inlier_weights: &mut Vec<f32>) -> Vec3 {
    inlier_weights.clear();
    inlier_weights.resize(samples.len(), 1.0);
    let all = samples.iter().map(|sample| sample.weight);
    let Some(mut mean) = weighted_mean(samples, all) else { return Vec3::ZERO };
    if samples.len() < 3 {
        return mean;
    }
    mean = channel_medians(samples);
    let mut differences = vec![0.0f32; samples.len()];
    let (mut sorted, mut weights) = (Vec::with_capacity(samples.len()), Vec::with_capacity(samples.len()));
    for _ in 0..ROUNDS {
        let mean_roots = roots(mean);
        for (difference, sample) in differences.iter_mut().zip(samples) {
            *difference = roots(sample.light).distance(mean_roots);
        }
        weights.clear();
        weights.extend(samples.iter().map(|sample| sample.weight_against(mean)));
        sorted.clear();
        sorted.extend(differences.iter().copied().zip(weights.iter().copied()));
        // Three channels: the median length of normally distributed vectors is 1.54 standard deviations of one
        // component.
        let scale = (weighted_median(&mut sorted) / 1.54).max(MIN_SCALE) * 3f32.sqrt();
        for (inlier_weight, &difference) in inlier_weights.iter_mut().zip(&differences) {
            let scaled = difference / scale;
            *inlier_weight = if samples.len() >= MIN_SAMPLES_TO_REJECT {
                (1.0 - (scaled / TUKEY).powi(2)).max(0.0).powi(2)
            } else {
                (HUBER / scaled.max(HUBER)).min(1.0)
            };
        }
        match weighted_mean(
            samples,
            weights.iter().zip(&*inlier_weights).map(|(count, inlier_weight)| count * inlier_weight),
        ) {
            Some(next) => mean = next,
            None => return mean,
        }
    }
    mean
}

/// Square roots with the sign of the value.
pub(crate) fn roots(light: Vec3) -> Vec3 {
    Vec3::from_array(light.to_array().map(|v| v.abs().sqrt().copysign(v)))
}

fn weighted_mean(samples: &[Sample], weights: impl Iterator<Item = f32>) -> Option<Vec3> {
    let (mut sum, mut all) = (Vec3::ZERO, 0.0);
    for (sample, weight) in samples.iter().zip(weights) {
        sum += sample.light * weight;
        all += weight;
    }
    (all > 0.0).then(|| sum / all)
}

/// Median by channel. Clipped values are right-censored: product-limit estimate of Kaplan and Meier (1958).
fn channel_medians(samples: &[Sample]) -> Vec3 {
    let mut values = Vec::with_capacity(samples.len());
    Vec3::from_array(std::array::from_fn(|channel| {
        values.clear();
        for sample in samples {
            let light = sample.light[channel];
            let is_at_limit = light >= LIMIT_SHARE * sample.light.max_element();
            let clipped = if is_at_limit { sample.limited_share() } else { 0.0 };
            for (is_lower_bound, weight) in [(false, 1.0 - clipped), (true, clipped)] {
                if weight > 0.0 {
                    values.push(CensoredValue { light, is_lower_bound, weight: weight * sample.weight });
                }
            }
        }
        censored_median(&mut values)
    }))
}

/// A value, or a lower bound of one.
struct CensoredValue {
    light: f32,
    is_lower_bound: bool,
    weight: f32,
}

/// The value that half of the values exceed; the largest if that is undetermined.
fn censored_median(values: &mut [CensoredValue]) -> f32 {
    values.sort_unstable_by(|a, b| a.light.total_cmp(&b.light).then(a.is_lower_bound.cmp(&b.is_lower_bound)));
    let mut at_risk: f32 = values.iter().map(|value| value.weight).sum();
    // Share of values above the current one.
    let mut above = 1.0;
    for value in values.iter() {
        if !value.is_lower_bound {
            above *= (1.0 - value.weight / at_risk).max(0.0);
            if above <= 0.5 {
                return value.light;
            }
        }
        at_risk -= value.weight;
    }
    values.last().map_or(0.0, |last| last.light)
}

fn weighted_median(values: &mut [(f32, f32)]) -> f32 {
    values.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let half = values.iter().map(|(_, weight)| weight).sum::<f32>() / 2.0;
    let mut sum = 0.0;
    for (value, weight) in values.iter() {
        sum += weight;
        if sum >= half {
            return *value;
        }
    }
    values.last().map_or(0.0, |last| last.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(lights: &[f32]) -> Vec<Sample> {
        lights.iter().map(|&v| Sample { light: Vec3::splat(v), weight: 1.0, clipped: 0.0 }).collect()
    }

    #[test]
    fn outliers_are_rejected() {
        let mut inlier_weights = Vec::new();
        let lights = [0.30, 0.31, 0.29, 0.30, 0.32, 0.28, 0.30, 0.29, 0.95, 0.90];
        let mean = robust_mean(&samples(&lights), &mut inlier_weights);
        assert!((mean.x - 0.299).abs() < 3e-3, "{mean}");
        assert!(
            inlier_weights[8] == 0.0 && inlier_weights[9] == 0.0 && inlier_weights[0] > 0.8,
            "{inlier_weights:?}"
        );
    }

    #[test]
    fn few_samples_are_not_rejected() {
        let mut inlier_weights = Vec::new();
        assert_eq!(robust_mean(&samples(&[0.25, 0.75]), &mut inlier_weights), Vec3::splat(0.5));
        // Of three, an outlier counts less, but counts.
        let mean = robust_mean(&samples(&[0.2, 0.2, 0.8]), &mut inlier_weights).x;
        assert!(inlier_weights[2] > 0.0 && (0.2..0.3).contains(&mean), "{mean} {inlier_weights:?}");
        assert_eq!(robust_mean(&[], &mut inlier_weights), Vec3::ZERO);
    }

    #[test]
    fn a_limit_raises_and_does_not_hold_down() {
        let with = |limit: f32, count: usize| {
            let mut samples = samples(&[0.5, 0.52, 0.48, 0.51, 0.49]);
            samples.extend((0..count).map(|_| Sample {
                light: Vec3::splat(limit),
                weight: 1.0,
                clipped: 1.0,
            }));
            robust_mean(&samples, &mut Vec::new()).x
        };
        // Below the reference: all bounds are satisfied.
        assert!((with(0.4, 4) - 0.5).abs() < 0.02, "{}", with(0.4, 4));
        // Above it: toward most photographs it is at least that bright.
        assert!(with(0.7, 8) > 0.65, "{}", with(0.7, 8));
    }

    #[test]
    fn few_unclipped_samples_determine_the_brightness() {
        // 1.3, with exposures that clip below it except for two; a quarter of each one's pixels just misses its limit.
        let limits = [0.6, 0.65, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95, 1.0, 1.1, 1.2];
        let mut samples = samples(&[1.28, 1.32]);
        let limited = |limit: f32| Sample { light: Vec3::splat(limit * 0.99), weight: 1.0, clipped: 0.75 };
        samples.extend(limits.map(limited));
        let mean = robust_mean(&samples, &mut Vec::new()).x;
        assert!((1.1..1.35).contains(&mean), "{mean}");
    }

    #[test]
    fn what_is_burnt_out_white_is_no_darker_in_one_channel_than_in_another() {
        let cream = Vec3::new(1.3, 1.27, 1.25);
        let limited = |limit: f32| Sample {
            light: Vec3::new(limit, 0.98 * limit, 0.97 * limit),
            weight: 1.0,
            clipped: 1.0,
        };
        let mut samples: Vec<Sample> = [0.7, 0.75, 0.8, 0.85, 0.9, 0.95, 1.0].map(limited).to_vec();
        samples.extend([0.98, 1.0, 1.02].map(|v| Sample { light: cream * v, weight: 1.0, clipped: 0.0 }));
        let medians = channel_medians(&samples);
        assert!(medians.distance(cream) < 0.05, "{medians}");
    }

    #[test]
    fn noise_is_averaged() {
        // Evenly distributed: the mean, not the median of a skewed half.
        let lights: Vec<f32> = (0..40).map(|k| 0.3 + 0.001 * ((k * 17 % 40) as f32 - 19.5)).collect();
        let mean = robust_mean(&samples(&lights), &mut Vec::new()).x;
        assert!((mean - 0.3).abs() < 1e-3, "{mean}");
    }
}
