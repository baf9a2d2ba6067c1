//! What lies between and behind splats.

use glam::{DVec2, DVec3, Vec3};
use lens::{Camera, FocusOffset};

/// What ends the rays of a picture of splats: the surfaces of other things, and what is infinitely far.
pub trait Backdrop: Sync {
    /// The end of the ray from the aperture point `u` (scene units) in the camera-space `direction` (z = 1), which the ordinary lens sends to
    /// the pixel position `pixel`.
    fn end(&self, u: DVec2, direction: DVec3, pixel: DVec2) -> RayEnd;

    /// How far paint moves its light at most, px.
    fn painted_reach_px(&self) -> f64;
}

/// The end of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayEnd {
    /// Depth, > 0; splats behind it are hidden. Infinite where nothing is.
    pub depth: f64,
    /// Its own light, and what it carries: their shares of coverage sum to 1.
    pub light: [EndLight; 2],
}

/// Light that is focused as one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndLight {
    /// Linear RGB radiance toward the aperture.
    pub radiance: Vec3,
    /// Its share of coverage, in [0, 1].
    pub share: f64,
    /// How it is focused.
    pub focus: FocusOffset,
}

impl EndLight {
    /// None.
    pub const NONE: Self = Self { radiance: Vec3::ZERO, share: 0.0, focus: FocusOffset::STANDARD };
}

impl RayEnd {
    /// What is infinitely far.
    pub fn at_infinity(radiance: Vec3, focus: FocusOffset) -> Self {
        Self { depth: f64::INFINITY, light: [EndLight { radiance, share: 1.0, focus }, EndLight::NONE] }
    }
}

/// The camera's background alone.
pub(super) struct PlainBackdrop(Vec3);

impl PlainBackdrop {
    pub fn of(camera: &Camera) -> Self {
        Self(Vec3::from_array(camera.background.unwrap_or_default().map(|c| c as f32)))
    }
}

impl Backdrop for PlainBackdrop {
    fn end(&self, _u: DVec2, _direction: DVec3, _pixel: DVec2) -> RayEnd {
        RayEnd::at_infinity(self.0, FocusOffset::STANDARD)
    }

    fn painted_reach_px(&self) -> f64 {
        0.0
    }
}
