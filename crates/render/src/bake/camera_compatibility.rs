//! Which cameras a baked light field can be used for.

use lens::Camera;

/// Whether a light field that was baked for the camera `baked` can show the picture of `camera`: they may differ in focus distance and
/// aperture shape, and the aperture of `camera` may be smaller.
pub fn is_compatible(baked: &Camera, camera: &Camera) -> bool {
    let like = Camera {
        focus_distance: baked.focus_distance,
        aperture: baked.aperture.clone(),
        aperture_radius: baked.aperture_radius,
        ..camera.clone()
    };
    like == *baked && camera.aperture_radius <= baked.aperture_radius
}
