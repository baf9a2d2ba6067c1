//! One light for what several photographs show of a texel: a mean that leaves out what does not belong.
//!
//! Iteratively reweighted least squares. Differences are measured between square roots, in which noise is about the same for dark and
//! bright. With five sightings or more Tukey's biweight (Beaton and Tukey 1974) leaves out what lies beyond 4.685 scales, the scale being
//! the median difference; with three or four none can be called wrong for sure, and Huber's weights only bound what each can do; two
//! are just averaged.

use glam::Vec3;

/// What one photograph shows of a texel, as radiance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    pub light: Vec3,
    /// > 0.
    pub weight: f32,
    /// The share of its pixels that were at the sensor's limit, in [0, 1].
    pub clipped: f32,
}

/// What was at the sensor's limit says that it was at least so bright. Where it is told to be that bright already, it counts this much.
const CLIPPED_COUNTS: f32 = 0.05;
/// From told brighter by this share on, which is what noise leaves open.
const CLIPPED_SURE: f32 = 0.05;

impl Sample {
    /// The same as another light with it changes it: how well it is seen stays.
    pub fn with_light(self, light: Vec3) -> Self {
        Self { light, ..self }
    }

    /// How it counts whatever it is compared with.
    pub fn counts_at_least(&self) -> f32 {
        self.weight * (1.0 - (1.0 - CLIPPED_COUNTS) * self.clipped)
    }

    /// How it counts against what is told of the place: a limit that is kept says little, one that is not says all that a sample can.
    pub fn counts(&self, told: Vec3) -> f32 {
        if self.clipped == 0.0 {
            return self.weight;
        }
        // The brightest channel is the one that was at its limit.
        let channel = self.light.max_position();
        let over = told[channel] - self.light[channel];
        let is_kept =
            (over / (CLIPPED_SURE * self.light[channel].abs()).max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
        self.weight * (1.0 - (1.0 - CLIPPED_COUNTS) * self.clipped * is_kept)
    }
}

/// From so many on, some are left out.
const ENOUGH_TO_REJECT: usize = 5;
/// 95 % efficient with normal errors.
const TUKEY: f32 = 4.685;
const HUBER: f32 = 1.345;
/// Differences of square roots are thought to be no smaller: 8 bits and JPEG.
const LEAST_SCALE: f32 = 0.012;
const ROUNDS: usize = 6;

/// The robust mean of samples, and in `belonging` how far each belongs to it, in [0, 1]. Black for none.
pub(crate) fn robust_mean(samples: &[Sample], belonging: &mut Vec<f32>) -> Vec3 {
    belonging.clear();
    belonging.resize(samples.len(), 1.0);
    let all = samples.iter().map(|sample| sample.weight);
    let Some(mut mean) = weighted_mean(samples, all) else { return Vec3::ZERO };
    if samples.len() < 3 {
        return mean;
    }
    mean = median(samples);
    let mut differences = vec![0.0f32; samples.len()];
    let (mut sorted, mut counts) = (Vec::with_capacity(samples.len()), Vec::with_capacity(samples.len()));
    for _ in 0..ROUNDS {
        let root = roots(mean);
        for (difference, sample) in differences.iter_mut().zip(samples) {
            *difference = roots(sample.light).distance(root);
        }
        counts.clear();
        counts.extend(samples.iter().map(|sample| sample.counts(mean)));
        sorted.clear();
        sorted.extend(differences.iter().copied().zip(counts.iter().copied()));
        // Three channels: the median length of normal vectors is 1.54 standard deviations of one.
        let scale = (weighted_median(&mut sorted) / 1.54).max(LEAST_SCALE) * 3f32.sqrt();
        for (belongs, &difference) in belonging.iter_mut().zip(&differences) {
            let off = difference / scale;
            *belongs = if samples.len() >= ENOUGH_TO_REJECT {
                (1.0 - (off / TUKEY).powi(2)).max(0.0).powi(2)
            } else {
                (HUBER / off.max(HUBER)).min(1.0)
            };
        }
        match weighted_mean(samples, counts.iter().zip(&*belonging).map(|(count, belongs)| count * belongs)) {
            Some(next) => mean = next,
            None => return mean,
        }
    }
    mean
}

/// Square roots, negative ones of what is below 0.
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

/// By channel.
fn median(samples: &[Sample]) -> Vec3 {
    let mut values = Vec::with_capacity(samples.len());
    Vec3::from_array(std::array::from_fn(|channel| {
        values.clear();
        values.extend(samples.iter().map(|sample| (sample.light[channel], sample.weight)));
        weighted_median(&mut values)
    }))
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
    fn what_does_not_belong_is_left_out() {
        let mut belonging = Vec::new();
        let lights = [0.30, 0.31, 0.29, 0.30, 0.32, 0.28, 0.30, 0.29, 0.95, 0.90];
        let mean = robust_mean(&samples(&lights), &mut belonging);
        assert!((mean.x - 0.299).abs() < 3e-3, "{mean}");
        assert!(belonging[8] == 0.0 && belonging[9] == 0.0 && belonging[0] > 0.8, "{belonging:?}");
    }

    #[test]
    fn few_are_not_judged() {
        let mut belonging = Vec::new();
        assert_eq!(robust_mean(&samples(&[0.25, 0.75]), &mut belonging), Vec3::splat(0.5));
        // Of three, the odd one counts less, but counts.
        let mean = robust_mean(&samples(&[0.2, 0.2, 0.8]), &mut belonging).x;
        assert!(belonging[2] > 0.0 && (0.2..0.3).contains(&mean), "{mean} {belonging:?}");
        assert_eq!(robust_mean(&[], &mut belonging), Vec3::ZERO);
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
        // Below what is told: it was brighter than the limit in each of them.
        assert!((with(0.4, 4) - 0.5).abs() < 0.02, "{}", with(0.4, 4));
        // Above: it is at least that bright toward most.
        assert!(with(0.7, 8) > 0.65, "{}", with(0.7, 8));
    }

    #[test]
    fn noise_is_averaged() {
        // Evenly spread: the mean, not the median of a skewed half.
        let lights: Vec<f32> = (0..40).map(|k| 0.3 + 0.001 * ((k * 17 % 40) as f32 - 19.5)).collect();
        let mean = robust_mean(&samples(&lights), &mut Vec::new()).x;
        assert!((mean - 0.3).abs() < 1e-3, "{mean}");
    }
}
