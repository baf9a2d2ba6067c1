//! Single paths that found far more light than those around them.
//!
//! A path that comes to a lamp by way of two glossy surfaces tells much light of a few directions. Its sample would be thrown as a
//! disc of bokeh that is not there. In a block of the picture, among the samples of one surface and kind of light, what such a
//! sample has beyond its neighbours is therefore given to all of them alike: no light is taken away, so that the mean stays right.
//! Only light that was found by chance counts ([`trace::Leaving::by_chance`]): lamps, their direct light and sharp mirrors are exact.

use crate::sample::{Sample, Visibility};
use crate::samples::Found;
use glam::Vec3;
use scene::Scene;
use std::collections::BTreeMap;

/// How much light was spread.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outliers {
    /// Samples that had too much.
    pub samples: usize,
    /// Light that they had beyond the limit, px² times radiance, the largest channel.
    pub spread: f64,
    /// All light, of the same unit.
    pub all: f64,
}

impl Outliers {
    /// Those of two parts of a picture.
    pub fn and(self, other: Self) -> Self {
        Self {
            samples: self.samples + other.samples,
            spread: self.spread + other.spread,
            all: self.all + other.all,
        }
    }

    /// The share of all light that was spread.
    pub fn share(&self) -> f64 {
        if self.all > 0.0 { self.spread / self.all } else { 0.0 }
    }
}

/// Among fewer samples there is none that is known to be unlike them.
const FEWEST: usize = 12;

/// A sample has too much if it is so many times as bright as its neighbours in the mean …
const ISOLATED: f32 = 5.0;

/// … and as the median of all samples with their spread, so many times over.
const FAR: f32 = 8.0;

/// Neighbours are at most so far apart, px.
const NEAR_PX: f32 = 1.6;

/// Spreads what outliers among the samples of a block have too much.
pub fn spread(found: &mut [Found], scene: &Scene) -> Outliers {
    let light = |found: &Found| {
        f64::from(found.sample.radiance.max_element()) * f64::from(seen_weight(&found.sample))
    };
    let mut outliers = Outliers { all: found.iter().map(light).sum(), ..Outliers::default() };
    let mut groups: BTreeMap<(u32, bool), Vec<usize>> = BTreeMap::new();
    for (index, found) in found.iter().enumerate().filter(|(_, found)| found.by_chance != Vec3::ZERO) {
        let Some(point) = found.sample.surface else { continue };
        let part = scene.triangles[point.triangle as usize].part;
        groups.entry((part, found.sample.is_carried)).or_default().push(index);
    }
    for group in groups.into_values().filter(|group| group.len() >= FEWEST) {
        outliers = outliers.and(spread_among(found, &group));
    }
    outliers
}

fn spread_among(found: &mut [Found], group: &[usize]) -> Outliers {
    let brightness = |found: &Found| found.by_chance.max_element();
    let mut sorted: Vec<f32> = group.iter().map(|&index| brightness(&found[index])).collect();
    sorted.sort_by(f32::total_cmp);
    let [median, upper] = [2, 4].map(|part| sorted[sorted.len() - 1 - sorted.len() / part]);
    let limit = median + FAR * (upper - median).max(0.25 * median);
    let brighter: Vec<usize> =
        group.iter().copied().filter(|&index| brightness(&found[index]) > limit).collect();
    let mut taken = Vec::new();
    for &index in &brighter {
        let center = found[index].sample.center;
        let is_near =
            |&&other: &&usize| other != index && found[other].sample.center.distance(center) < NEAR_PX;
        let near: Vec<f32> = group.iter().filter(is_near).map(|&other| brightness(&found[other])).collect();
        let around = near.iter().sum::<f32>() / near.len().max(1) as f32;
        let own = brightness(&found[index]);
        let usual = around.max(median);
        if own > ISOLATED * usual {
            let kept = usual / own;
            taken.push((index, found[index].by_chance * (1.0 - kept)));
        }
    }
    let weight: f32 = group.iter().map(|&index| seen_weight(&found[index].sample)).sum();
    if taken.is_empty() || weight <= 0.0 {
        return Outliers::default();
    }
    let mut all = Vec3::ZERO;
    for (index, light) in &taken {
        let sample = &mut found[*index].sample;
        // What chance found is part of what the sample has, but for rounding.
        sample.radiance = (sample.radiance - *light).max(Vec3::ZERO);
        all += *light * seen_weight(sample);
    }
    group.iter().for_each(|&index| found[index].sample.radiance += all / weight);
    Outliers { samples: taken.len(), spread: f64::from(all.max_element()), all: 0.0 }
}

/// What a sample counts for: its weight, over what it sees of the aperture.
fn seen_weight(sample: &Sample) -> f32 {
    let seen = match &sample.visibility {
        Visibility::Open => 1.0,
        Visibility::Cells { words } => {
            let seen: u32 = words.iter().map(|word| word.count_ones()).sum();
            seen as f32 / (64 * words.len()) as f32
        }
    };
    sample.weight.max(0.0) * seen
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
    fn block(bright: &[(i32, i32, f32)]) -> Vec<Found> {
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
                Found { sample, part_of, by_chance: Vec3::splat(light) }
            })
            .collect()
    }

    fn sum(found: &[Found]) -> f32 {
        found.iter().map(|found| found.sample.radiance.x).sum()
    }

    #[test]
    fn a_lone_sample_gives_to_all_and_no_light_is_lost() {
        let mut found = block(&[(5, 9, 60.0)]);
        let before = sum(&found);
        let outliers = spread(&mut found, &scene());
        assert_eq!(outliers.samples, 1);
        assert!((outliers.spread - 59.7).abs() < 0.3, "{outliers:?}");
        assert!((sum(&found) / before - 1.0).abs() < 1e-5);
        let brightest = found.iter().map(|found| found.sample.radiance.x).fold(0.0, f32::max);
        assert!(brightest < 2.0, "{brightest}");
    }

    #[test]
    fn what_is_bright_together_stays() {
        // A caustic: 3 × 3 pixels; and light that was not found by chance.
        let bright: Vec<_> = (0..9).map(|k| (4 + k % 3, 7 + k / 3, 60.0)).collect();
        let mut found = block(&bright);
        assert_eq!(spread(&mut found, &scene()).samples, 0);
        let mut found = block(&[(5, 9, 60.0)]);
        found.iter_mut().for_each(|found| found.by_chance = found.by_chance.min(Vec3::splat(0.1)));
        let before = found[5 + 9 * 16].sample.radiance;
        assert_eq!(spread(&mut found, &scene()).samples, 0);
        assert_eq!(found[5 + 9 * 16].sample.radiance, before);
    }
}
