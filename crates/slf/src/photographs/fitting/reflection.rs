//! Mirrored directions, and their occlusion by the scene.

use glam::{DVec3, Vec3};
use scene::SurfacePoint;
use trace::Tracer;

/// The mirrored direction of another, and F.
pub(super) fn mirror_direction(normal: Vec3, outgoing: Vec3) -> (Vec3, f32) {
    let cosine = normal.dot(outgoing);
    (normal * (2.0 * cosine) - outgoing, fresnel(cosine.abs()))
}

/// F: Fresnel reflectance of lacquer, glass and skin (Schlick 1994).
pub(super) fn fresnel(cosine: f32) -> f32 {
    let rest = (1.0 - cosine).clamp(0.0, 1.0);
    let square = rest * rest;
    0.04 + 0.96 * square * square * rest
}

/// Whether a point with this shading normal mirrors another part of the scene toward an eye.
///
/// Where a smooth surface consists of flat faces, the mirrored direction may lie below its own face; the ray then
/// follows the face, as the smooth surface would not occlude itself.
pub(crate) fn is_reflection_blocked(
    tracer: &Tracer,
    point: SurfacePoint,
    normal: Vec3,
    outgoing: Vec3,
) -> bool {
    let (direction, _) = mirror_direction(normal, outgoing);
    let face = tracer.scene().area_normal(point.triangle).normalize_or_zero();
    let face = if face.dot(outgoing.as_dvec3()) < 0.0 { -face } else { face };
    let direction: DVec3 = direction.as_dvec3();
    tracer.any_hit_from(point, direction - face * face.dot(direction).min(0.0))
}
