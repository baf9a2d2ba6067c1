//! What the light field holds.

use glam::{DVec2, Vec2, Vec3};
use lens::Camera;
use scene::SurfacePoint;

/// The surface-aperture light field of one camera.
#[derive(Clone, Debug)]
pub struct Salf {
    /// The camera it was baked for; aperture shape, f-stop and focus distance may change afterwards.
    pub camera: Camera,
    /// Its samples.
    pub samples: Vec<Sample>,
}

/// A patch of surface as the aperture sees it.
#[derive(Clone, Debug)]
pub struct Sample {
    /// Centre of its pinhole footprint, px.
    pub center: Vec2,
    /// Half the footprint's sides, px.
    pub half_size: Vec2,
    /// 1/z; 0 for the background.
    pub inverse_depth: f32,
    /// w(0), px², and its gradient over the unit aperture.
    pub weight: f32,
    /// ∂w/∂u, px².
    pub tilt: Vec2,
    /// Linear RGB radiance toward the aperture.
    pub radiance: Vec3,
    /// Its surface address; `None` for the background.
    pub surface: Option<SurfacePoint>,
    /// What of the aperture it sees.
    pub visibility: Visibility,
}

/// What of the aperture a sample sees.
#[derive(Clone, Debug, PartialEq)]
pub enum Visibility {
    /// All of it.
    Open,
    /// A bit a cell of the square aperture.
    Cells(Box<[u64]>),
}

impl Sample {
    /// Whether it is the background.
    pub fn is_background(&self) -> bool {
        self.surface.is_none()
    }

    /// Centre in f64.
    pub fn center_px(&self) -> DVec2 {
        self.center.as_dvec2()
    }
}
