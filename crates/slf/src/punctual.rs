//! KHR_lights_punctual: unoccluded irradiance of a light at a point.

use glam::{DVec3, Vec3};
use scene::{Light, LightKind};

/// Light of a punctual source at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PunctualLight {
    /// Unit direction toward the light.
    pub direction: DVec3,
    /// World position of the light, or a point outside the scene; the light arrives unless the segment to it is
    /// occluded.
    pub source: DVec3,
    /// Irradiance on a surface that faces the light.
    pub irradiance: Vec3,
}

/// Unoccluded light of `light` at `position`; `None` if there is none. `beyond` is a distance that leaves the scene
/// from anywhere in it, where directional light starts.
///
/// | kind | irradiance |
/// | --- | --- |
/// | point | I·w/r², w = max(0, min(1, 1 − (r/range)⁴)) |
/// | spot | the same, times clamp((cos θ − cos outer)/(cos inner − cos outer), 0, 1)², θ off the axis |
/// | directional | E |
pub(crate) fn unshadowed_light(light: &Light, position: DVec3, beyond: f64) -> Option<PunctualLight> {
    let share = |share: f64| (share > 0.0).then(|| light.intensity * share as f32);
    match light.kind {
        LightKind::Directional => {
            let direction = -light.direction;
            Some(PunctualLight {
                direction,
                source: position + direction * beyond,
                irradiance: light.intensity,
            })
        }
        LightKind::Point | LightKind::Spot { .. } => {
            let toward = light.position - position;
            let r2 = toward.length_squared();
            let direction = toward.normalize_or_zero();
            let window = (1.0 - (r2 / light.range.powi(2)).powi(2)).clamp(0.0, 1.0);
            let cone = match light.kind {
                LightKind::Spot { inner, outer } => cone(light.direction.dot(-direction), inner, outer),
                _ => 1.0,
            };
            // At the light itself there is no direction and no finite irradiance.
            let irradiance = if r2 > 0.0 { share(window * cone / r2) } else { None };
            Some(PunctualLight { direction, source: light.position, irradiance: irradiance? })
        }
    }
}

/// Share of a spot light's intensity at an angle of cosine `cos` from its axis.
fn cone(cos: f64, inner: f64, outer: f64) -> f64 {
    // The specification's guard against a division by zero: minimum width of the falloff.
    const NARROWEST_FALLOFF: f64 = 1e-3;
    let falloff = (inner.cos() - outer.cos()).max(NARROWEST_FALLOFF);
    ((cos - outer.cos()) / falloff).clamp(0.0, 1.0).powi(2)
}
