//! The light of a ray.
//!
//! Clouds are trained so that the blended sum Σ w c, in sRGB, is what a photograph shows. So the *sum of a ray* is decoded, and not each splat;
//! and it is shared among the splats, so that each can land where its focus sends it:
//!
//! ```text
//! splat i brings  wᵢ lin(cᵢ) ρ      ρ = Σw · lin(Σ w c / Σw) / Σ w lin(c)   a channel
//! ```
//!
//! The sum is that of the splats alone, un-premultiplied: what shines through from behind, a mesh, a sky or nothing, keeps its light, and soft
//! rims do not darken. ρ = 1 for linear clouds.

use super::Hit;
use crate::cloud::{ColorSpace, srgb_to_linear};
use glam::Vec3;

/// What a ray brings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayLight {
    /// Σ w, the share of the ray that splats send.
    pub alpha: f64,
    /// ρ, for each channel.
    pub gain: Vec3,
}

impl RayLight {
    /// The light of a ray with these hits; `colors` has the colour of a splat of the view as it is blended and as linear light.
    #[inline]
    pub fn new(hits: &[Hit], colors: impl Fn(u32) -> (Vec3, Vec3), space: ColorSpace) -> Self {
        let alpha: f64 = hits.iter().map(|hit| hit.weight).sum();
        if space == ColorSpace::Linear || hits.is_empty() {
            return Self { alpha, gain: Vec3::ONE };
        }
        let (mut blended, mut linear) = (Vec3::ZERO, Vec3::ZERO);
        for hit in hits {
            let (color, light) = colors(hit.splat);
            blended += hit.weight as f32 * color;
            linear += hit.weight as f32 * light;
        }
        let share = alpha as f32;
        let decoded = share * (blended / share).map(srgb_to_linear);
        // Where all splats are black there is nothing to share.
        let gain = |decoded: f32, linear: f32| if linear > 0.0 { decoded / linear } else { 1.0 };
        let gain = Vec3::new(gain(decoded.x, linear.x), gain(decoded.y, linear.y), gain(decoded.z, linear.z));
        Self { alpha, gain }
    }
}

/// The depth at which half of a ray is stopped, splats taken in order of the depth of their response; `None` if more of it passes. `hits` are
/// sorted by it.
pub fn median_depth(hits: &mut [Hit]) -> Option<f64> {
    hits.sort_by(|a, b| a.depth.total_cmp(&b.depth));
    let mut transmittance = 1.0;
    let is_median = |hit: &&mut Hit| {
        transmittance *= 1.0 - hit.alpha;
        transmittance < 0.5
    };
    hits.iter_mut().find(is_median).map(|hit| hit.depth)
}

/// Leaves the hits before `depth`, with what those behind it no longer take from them; returns the share of the ray that passes all. `hits` are in
/// order of the depth of their means.
pub(crate) fn end_at(hits: &mut Vec<Hit>, depth: f64) -> f64 {
    let mut rest = 1.0;
    hits.retain_mut(|hit| {
        let is_before = hit.depth < depth;
        if is_before {
            hit.weight = hit.alpha * rest;
            rest *= 1.0 - hit.alpha;
        }
        is_before
    });
    rest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hit(splat: u32, alpha: f64, weight: f64, depth: f64) -> Hit {
        Hit { splat, alpha, weight, depth }
    }

    #[test]
    fn the_sum_of_a_ray_is_decoded() {
        let colors = [Vec3::new(0.9, 0.5, 0.0), Vec3::new(0.1, 0.5, 0.0)];
        let decoded = |color: Vec3| color.map(srgb_to_linear);
        let lookup = |splat: u32| (colors[splat as usize], decoded(colors[splat as usize]));
        let hits = [hit(0, 0.5, 0.5, 1.0), hit(1, 0.5, 0.25, 2.0)];
        let light = RayLight::new(&hits, lookup, ColorSpace::Srgb);
        let sum: Vec3 = hits.iter().map(|h| h.weight as f32 * decoded(colors[h.splat as usize])).sum();
        let blended: Vec3 = hits.iter().map(|h| h.weight as f32 * colors[h.splat as usize]).sum();
        let expected = 0.75 * decoded(blended / 0.75);
        assert!((light.gain * sum - expected).abs().max_element() < 1e-6);
        // Where all splats have the same colour it is that of each; black stays black.
        assert!((light.gain.y - 1.0).abs() < 1e-5 && light.gain.z == 1.0);
        // The mean of two sRGB values is darker than that of their light.
        assert!(light.gain.x < 0.9);
        assert_eq!(RayLight::new(&hits, lookup, ColorSpace::Linear).gain, Vec3::ONE);
        assert_eq!(RayLight::new(&[], lookup, ColorSpace::Srgb), RayLight { alpha: 0.0, gain: Vec3::ONE });
    }

    #[test]
    fn the_median_is_where_half_is_stopped() {
        let mut hits = [hit(0, 0.4, 0.4, 5.0), hit(1, 0.3, 0.18, 1.0), hit(2, 0.3, 0.1, 3.0)];
        assert_eq!(median_depth(&mut hits), Some(3.0));
        assert_eq!(median_depth(&mut hits[..1]), None);
    }
}
