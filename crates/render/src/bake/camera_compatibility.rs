//! Which cameras a baked light field can show.

use lens::Camera;

/// Whether a light field that was baked for `baked` can show what `camera` sees.
pub fn is_compatible(baked: &Camera, camera: &Camera) -> bool {
    let like = Camera {
        focus_distance: baked.focus_distance,
        aperture: baked.aperture.clone(),
        aperture_radius: baked.aperture_radius,
        ..camera.clone()
    };
    like == *baked && camera.aperture_radius <= baked.aperture_radius
}
