//! Which cameras a baked light field can be used for.

use lens::Camera;

/// Whether a light field that was baked for the camera `baked` can show the picture of `camera`: they may differ in focus distance,
/// aperture shape and character, and the aperture of `camera` may be smaller.
pub fn is_compatible(baked: &Camera, camera: &Camera) -> bool {
    let like = Camera {
        focus_distance: baked.focus_distance,
        aperture: baked.aperture.clone(),
        aperture_radius: baked.aperture_radius,
        character: baked.character,
        ..camera.clone()
    };
    like == *baked && camera.aperture_radius <= baked.aperture_radius
}

/// Whether such a light field also has the aperture radius of `camera`: with that of a wider one, it tells what of the aperture is hidden more
/// coarsely than one that is baked for `camera`.
pub fn is_baked_for(baked: &Camera, camera: &Camera) -> bool {
    is_compatible(baked, camera) && baked.aperture_radius == camera.aperture_radius
}
