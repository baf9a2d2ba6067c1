//! Outliers: single paths that found far more light than the paths around them.
//!
//! A path that reaches a lamp by way of two glossy surfaces samples much light of a few directions. Its sample would appear as a
//! disc of bokeh that is not there. In a block of the picture, among the samples of one surface and kind of light, what such a
//! sample has beyond its neighbours is therefore given to all of them alike: no light is taken away, so that the mean stays right.
//! Only noisy light counts ([`trace::OutgoingRadiance::noisy`]): lamps, their direct light and sharp mirrors are exact.

use crate::sample::{Sample, Visibility};
use crate::samples::BakedSample;
use glam::Vec3;
use scene::Scene;
use std::collections::BTreeMap;

/// How much light was spread.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outliers {
    /// Samples that had too much.
    pub samples: usize,
    /// Light that they had beyond the limit, px² times radiance, the largest channel.
    pub spread_light: f64,
    /// All light, of the same unit.
    pub total_light: f64,
}

impl Outliers {
    /// The outliers of two parts of a picture together.
    pub fn merged(self, other: Self) -> Self {
        Self {
            samples: self.samples + other.samples,
            spread_light: self.spread_light + other.spread_light,
            total_light: self.total_light + other.total_light,
        }
    }

    /// The share of all light that was spread, in [0, 1].
    pub fn share(&self) -> f64 {
        if self.total_light > 0.0 { self.spread_light / self.total_light } else { 0.0 }
    }
}

/// In smaller groups no sample counts as an outlier.
const MIN_GROUP_SAMPLES: usize = 12;

/// An outlier is at least this many times as bright as its neighbours in the mean …
const ISOLATED_RATIO: f32 = 5.0;

/// … and exceeds the median of all samples by more than this many spreads.
const OUTLIER_DEVIATIONS: f32 = 8.0;

/// Neighbours are at most so far apart, px.
const NEAR_PX: f32 = 1.6;

/// Takes from outliers among the samples of a block the light that they have too much, and spreads it evenly over
/// their group: samples of one part, own or carried.
pub fn spread_outliers(samples: &mut [BakedSample], scene: &Scene) -> Outliers {
    let light = |baked: &BakedSample| {
        f64::from(baked.sample.radiance.max_element()) * f64::from(visible_weight(&baked.sample))
    };
    let mut outliers = Outliers { total_light: samples.iter().map(light).sum(), ..Outliers::default() };
    let mut groups: BTreeMap<(u32, bool), Vec<usize>> = BTreeMap::new();
    for (index, baked) in samples.iter().enumerate().filter(|(_, baked)| baked.noisy != Vec3::ZERO) {
        let Some(point) = baked.sample.surface else { continue };
        let part = scene.triangles[point.triangle as usize].part;
        groups.entry((part, baked.sample.is_carried)).or_default().push(index);
    }
    for group in groups.into_values().filter(|group| group.len() >= MIN_GROUP_SAMPLES) {
        outliers = outliers.merged(spread_in_group(samples, &group));
    }
    outliers
}

fn spread_in_group(samples: &mut [BakedSample], group: &[usize]) -> Outliers {
    let brightness = |baked: &BakedSample| baked.noisy.max_element();
    let mut sorted: Vec<f32> = group.iter().map(|&index| brightness(&samples[index])).collect();
    sorted.sort_by(f32::total_cmp);
    let [median, upper] = [2, 4].map(|part| sorted[sorted.len() - 1 - sorted.len() / part]);
    let limit = median + OUTLIER_DEVIATIONS * (upper - median).max(0.25 * median);
    let brighter: Vec<usize> =
        group.iter().copied().filter(|&index| brightness(&samples[index]) > limit).collect();
    let mut taken = Vec::new();
    for &index in &brighter {
        let center = samples[index].sample.center;
        let is_near =
            |&&other: &&usize| other != index && samples[other].sample.center.distance(center) < NEAR_PX;
        let near: Vec<f32> = group.iter().filter(is_near).map(|&other| brightness(&samples[other])).collect();
        let around = near.iter().sum::<f32>() / near.len().max(1) as f32;
        let own = brightness(&samples[index]);
        let usual = around.max(median);
        if own > ISOLATED_RATIO * usual {
            let retained = usual / own;
            taken.push((index, samples[index].noisy * (1.0 - retained)));
        }
    }
    let weight: f32 = group.iter().map(|&index| visible_weight(&samples[index].sample)).sum();
    if taken.is_empty() || weight <= 0.0 {
        return Outliers::default();
    }
    let mut all = Vec3::ZERO;
    for (index, light) in &taken {
        let sample = &mut samples[*index].sample;
        // The noisy part is contained in the radiance, but for rounding.
        sample.radiance = (sample.radiance - *light).max(Vec3::ZERO);
        all += *light * visible_weight(sample);
    }
    group.iter().for_each(|&index| samples[index].sample.radiance += all / weight);
    Outliers { samples: taken.len(), spread_light: f64::from(all.max_element()), total_light: 0.0 }
}

/// The weight of a sample: its own, times the visible share of the aperture.
fn visible_weight(sample: &Sample) -> f32 {
    let visible = match &sample.visibility {
        Visibility::Open => 1.0,
        Visibility::Cells { words } => {
            let visible_cells: u32 = words.iter().map(|word| word.count_ones()).sum();
            visible_cells as f32 / (64 * words.len()) as f32
        }
    };
    sample.weight.max(0.0) * visible
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::Cell;
    use glam::{DVec2, IVec2, Vec2};
    use scene::{Part, SurfacePoint, Triangle};

    fn scene() -> Scene {
        let part = |triangles| Part { node: 0, material: 0, triangles, has_uv: [false; 2], mirrored: false };
        let triangle = |part| Triangle { vertices: [0, 1, 2], part };
        Scene {
            parts: vec![part(0..1), part(1..2)],
            triangles: vec![triangle(0), triangle(1)],
            ..Scene::default()
        }
    }

    /// A block of pixels that chance gave about 0.1 each, and `bright` something else.
    fn block(bright: &[(i32, i32, f32)]) -> Vec<BakedSample> {
        (0..256)
            .map(|k| {
                let corner = IVec2::new(k % 16, k / 16);
                let found = bright.iter().find(|(x, y, _)| IVec2::new(*x, *y) == corner);
                let light = found.map_or(0.1 + 0.001 * (k % 7) as f32, |(_, _, light)| *light);
                let sample = Sample {
                    center: corner.as_vec2() + 0.5,
                    half_size: Vec2::splat(0.5),
                    inverse_depth: 0.5,
                    weight: 1.0,
                    tilt: Vec2::ZERO,
                    radiance: Vec3::splat(1.0 + light),
                    surface: Some(SurfacePoint { triangle: 0, barycentric: DVec2::ZERO }),
                    is_carried: false,
                    visibility: Visibility::Open,
                };
                let part_of = Some((Cell { corner, side: 1 }, u64::MAX));
                BakedSample { sample, part_of, noisy: Vec3::splat(light) }
            })
            .collect()
    }

    fn sum(found: &[BakedSample]) -> f32 {
        found.iter().map(|found| found.sample.radiance.x).sum()
    }

    #[test]
    fn a_lone_sample_gives_to_all_and_no_light_is_lost() {
        let mut found = block(&[(5, 9, 60.0)]);
        let before = sum(&found);
        let outliers = spread_outliers(&mut found, &scene());
        assert_eq!(outliers.samples, 1);
        assert!((outliers.spread_light - 59.7).abs() < 0.3, "{outliers:?}");
        assert!((sum(&found) / before - 1.0).abs() < 1e-5);
        let brightest = found.iter().map(|found| found.sample.radiance.x).fold(0.0, f32::max);
        assert!(brightest < 2.0, "{brightest}");
    }

    #[test]
    fn what_is_bright_together_stays() {
        // A caustic: 3 × 3 pixels; and light that was not found by chance.
        let bright: Vec<_> = (0..9).map(|k| (4 + k % 3, 7 + k / 3, 60.0)).collect();
        let mut found = block(&bright);
        assert_eq!(spread_outliers(&mut found, &scene()).samples, 0);
        let mut found = block(&[(5, 9, 60.0)]);
        found.iter_mut().for_each(|found| found.noisy = found.noisy.min(Vec3::splat(0.1)));
        let before = found[5 + 9 * 16].sample.radiance;
        assert_eq!(spread_outliers(&mut found, &scene()).samples, 0);
        assert_eq!(found[5 + 9 * 16].sample.radiance, before);
    }
}
