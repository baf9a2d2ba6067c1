//! Averaging of indirect light over neighbouring patches, as far as no near surface interferes.

use super::patches::Patches;
use glam::Vec3;

/// Neighbours within this share of the harmonic mean distance are averaged.
const SMOOTHING_RADIUS: f64 = 0.25;

/// The indirect light of patch `at`, averaged with its neighbours' as far as no near surface interferes. `light` returns a
/// patch's indirect light and the harmonic mean of its rays' distances; it is not asked for more patches than it takes.
pub(crate) fn smoothed_indirect(patches: &Patches, at: usize, light: impl Fn(usize) -> (Vec3, f64)) -> Vec3 {
    let patch = &patches.all()[at];
    let (indirect, distance) = light(at);
    let (mut sum, mut weights) = (indirect * patch.area as f32, patch.area as f32);
    patches.visit_neighbors(patch, |other| {
        let other = other as usize;
        let neighbor = &patches.all()[other];
        let apart = patch.position.distance(neighbor.position);
        if other == at || apart >= SMOOTHING_RADIUS * distance {
            return;
        }
        let (indirect, other_distance) = light(other);
        let near = (1.0 - apart / (SMOOTHING_RADIUS * distance.min(other_distance))).max(0.0);
        let weight = (near * neighbor.area) as f32;
        sum += indirect * weight;
        weights += weight;
    });
    sum / weights
}
