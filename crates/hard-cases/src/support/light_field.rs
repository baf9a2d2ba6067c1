//! Synthetic light fields of background samples, which are displaced by the focus at infinity.

use super::shot::picture_of;
use focus::Focus;
use glam::{DVec2, Vec2, Vec3};
use lens::{Camera, FocusOffset, Picture};
use progress::{Cancelled, Progress};
use salf::{Salf, Sample, Visibility};
use test_scenes::unlit_scene_of;

/// A background sample at a pixel position: a square with the given half side, px, that sees the whole
/// aperture. Its weight is its area.
pub fn star(center: DVec2, half_px: f64, radiance: f32) -> Sample {
    Sample {
        center: center.as_vec2(),
        half_size: Vec2::splat(half_px as f32),
        inverse_depth: 0.0,
        weight: (4.0 * half_px * half_px) as f32,
        tilt: Vec2::ZERO,
        radiance: Vec3::splat(radiance),
        surface: None,
        is_carried: false,
        visibility: Visibility::Open,
    }
}

/// The focus that gives a background sample the defocus κ: t = 1 + κd relative to the point.
pub fn offset_of(kappa: f64, camera: &Camera) -> FocusOffset {
    FocusOffset::new(1.0 + kappa * camera.optics().image_distance, 1.0)
}

/// The picture of such samples with a constant focus.
///
/// # Errors
/// [`Cancelled`] if `progress` is cancelled.
pub fn picture_of_stars(
    camera: &Camera,
    samples: Vec<Sample>,
    offset: FocusOffset,
    progress: &dyn Progress,
) -> Result<Picture, Cancelled> {
    let focus = Focus::constant(unlit_scene_of([]), offset);
    picture_of(Salf::with_samples(camera.clone(), samples.into()), &focus, progress)
}
