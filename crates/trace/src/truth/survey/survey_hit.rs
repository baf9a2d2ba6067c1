//! Hits of a pixel's survey rays: at one depth or two, of one radiance or several.

use glam::Vec3;

/// The hit of a survey ray.
#[derive(Clone, Copy, Debug)]
pub struct SurveyHit {
    /// The signed radius of its circle of confusion under the standard lens, px.
    pub radius_px: f64,
    /// What paint adds to it, px.
    pub moved_px: f64,
    /// Its radiance.
    pub light: Vec3,
}

/// How much of the light's variance may lie within what is in front and what is behind for the edge between them to
/// be all that there is. With more, the rest costs as much as is gained.
pub const WITHIN: f32 = 0.01;
/// Radii farther apart than this, relative (absolute below 1 px), are two depths.
const APART: f64 = 0.1;

/// Whether all hits have the same radiance.
pub fn is_uniform(hits: &[SurveyHit]) -> bool {
    hits.windows(2).all(|pair| pair[0].light == pair[1].light)
}

/// The number of hits, in the order of their radii, that lie in front of the widest gap between depths; all if there
/// is one depth.
pub fn widest_gap(by_radius: &[SurveyHit]) -> usize {
    let radius = |k: usize| by_radius[k].radius_px;
    let gap = (1..by_radius.len())
        .max_by(|&a, &b| (radius(a) - radius(a - 1)).total_cmp(&(radius(b) - radius(b - 1))));
    gap.filter(|&k| radius(k) - radius(k - 1) > APART * radius(k).abs().min(radius(k - 1).abs()).max(1.0))
        .unwrap_or(by_radius.len())
}

/// The sum of the squared deviations of the hits' radiance from its mean.
pub fn scatter(hits: &[SurveyHit]) -> f32 {
    let mean = hits.iter().map(|hit| hit.light).sum::<Vec3>() / hits.len().max(1) as f32;
    hits.iter().map(|hit| (hit.light - mean).length_squared()).sum()
}
