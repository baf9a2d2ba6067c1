//! A cloud in front of a camera: what rays through the aperture meet.
//!
//! ```text
//! camera + cloud ─▶ GaussianView ─▶ Eye (one aperture point) ─▶ hits of a ray ─▶ light of a ray
//!                   (sorted by depth, (whitened, coloured,
//!                    low-passed)       outlines in tiles)
//! ```

mod eye;
mod eye_raster;
mod ray_light;
mod shape;
mod span_bins;
mod tile_tracer;
mod tiles;
mod world_ray;

pub use eye::{Eye, Hit};
pub(crate) use eye_raster::EyeRaster;
pub(crate) use ray_light::end_at;
pub use ray_light::{RayLight, median_depth};
pub(crate) use tile_tracer::{Follow, LANES, LaneHits};
pub(crate) use tiles::{RayGrid, TILE, TileRow};

use crate::cloud::GaussianCloud;
use crate::placement::Placement;
use glam::{DMat3, DVec2, DVec3};
use lens::{Camera, Optics};
use rayon::prelude::*;
use shape::{CameraShape, Growth};

/// The most that a splat stops, as in training.
const MAX_ALPHA: f64 = 0.99;
pub use shape::LOW_PASS_PX2;
pub use world_ray::CloudRay;

/// A splat whose mean is nearer than this many aperture radii is left out: it would cover the aperture.
const NEAREST_RADII: f64 = 0.6;

/// The splats of a cloud that a camera can see, in camera space, in order of the depth of their means.
///
/// The order is the same for all of the aperture, so that nothing changes it over a bake, and it is the order in which clouds are trained and
/// drawn. Each splat has grown by the low-pass across the chief ray, once for the camera.
pub struct GaussianView<'a> {
    cloud: &'a GaussianCloud,
    camera: &'a Camera,
    optics: Optics,
    /// From camera space to directions in the axes of the file.
    file_from_camera: DMat3,
    splats: Vec<ViewSplat>,
}

/// A splat in camera space.
#[derive(Clone, Copy)]
pub(crate) struct ViewSplat {
    pub shape: CameraShape,
    /// Its index in the cloud.
    pub index: u32,
}

impl<'a> GaussianView<'a> {
    /// The splats of `cloud`, placed in the world by `placement`, before `camera`; both must be valid.
    pub fn new(cloud: &'a GaussianCloud, placement: &Placement, camera: &'a Camera) -> Self {
        Self::with_pixel(cloud, placement, camera, 1.0)
    }

    /// The same for a camera that is finer than the picture: the low-pass is that of pixels as wide as `pixel_px` pixels of `camera`.
    pub fn with_pixel(
        cloud: &'a GaussianCloud,
        placement: &Placement,
        camera: &'a Camera,
        pixel_px: f64,
    ) -> Self {
        Self::grown(cloud, placement, camera, pixel_px, |_, _| 0.0)
    }

    /// The view of other programs' depth of field: each splat, by its index and the depth of its mean, is dilated across its chief ray by a
    /// variance, px², and fades as it grows (Spark's `splatVertex.glsl`). It leaks and is no picture of a lens: to compare with.
    pub fn dilated(
        cloud: &'a GaussianCloud,
        placement: &Placement,
        camera: &'a Camera,
        variance_px2: impl Fn(u32, f64) -> f64 + Sync,
    ) -> Self {
        Self::grown(cloud, placement, camera, 1.0, variance_px2)
    }

    fn grown(
        cloud: &'a GaussianCloud,
        placement: &Placement,
        camera: &'a Camera,
        pixel_px: f64,
        variance_px2: impl Fn(u32, f64) -> f64 + Sync,
    ) -> Self {
        let optics = camera.optics();
        let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| camera.camera_direction(axis));
        let camera_from_world = DMat3::from_cols(axes[0], axes[1], axes[2]);
        let camera_from_file = camera_from_world * placement.linear();
        let focal_px = optics.half_height_px / optics.tan_half_yfov / pixel_px;
        let nearest = NEAREST_RADII * optics.aperture_radius;
        let is_antialiased = cloud.traits().is_antialiased;
        let in_camera = |index: usize| {
            let splat = cloud.splat(index);
            let mean = camera.camera_from_world(placement.point(splat.mean.as_dvec3()));
            if mean.z <= nearest {
                return None;
            }
            let dilation_px2 = variance_px2(index as u32, mean.z);
            let growth = Growth { focal_px, is_antialiased, dilation_px2 };
            let shape = CameraShape::new(&splat, mean, &camera_from_file, growth)?;
            Some(ViewSplat { shape, index: index as u32 })
        };
        let mut splats: Vec<ViewSplat> = (0..cloud.len()).into_par_iter().filter_map(in_camera).collect();
        splats.par_sort_unstable_by(|a, b| {
            a.shape.mean.z.total_cmp(&b.shape.mean.z).then_with(|| a.index.cmp(&b.index))
        });
        let file_from_camera = (camera_from_world * placement.rotation).transpose();
        Self { cloud, camera, optics, file_from_camera, splats }
    }

    /// The number of splats before the camera.
    pub fn len(&self) -> usize {
        self.splats.len()
    }

    /// Whether no splat is before the camera.
    pub fn is_empty(&self) -> bool {
        self.splats.is_empty()
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        self.camera
    }

    /// The numbers of its lens.
    pub fn optics(&self) -> Optics {
        self.optics
    }

    /// The cloud.
    pub fn cloud(&self) -> &GaussianCloud {
        self.cloud
    }

    /// The index in the cloud of the view's splat `splat`, as hits name it.
    ///
    /// # Panics
    /// There is no such splat.
    pub fn cloud_index(&self, splat: u32) -> usize {
        self.splats[splat as usize].index as usize
    }

    /// The depth of the mean of the view's splat `splat`.
    ///
    /// # Panics
    /// There is no such splat.
    pub fn mean_depth(&self, splat: u32) -> f64 {
        self.splats[splat as usize].shape.mean.z
    }

    /// The direction (with z = 1) of the ray from the aperture point `u` (scene units) that an unpainted point sends to the pixel position
    /// `pixel` (px, y down).
    ///
    /// ```text
    /// D = q tanθ − U/s
    /// ```
    pub fn direction(&self, u: DVec2, pixel: DVec2) -> DVec3 {
        let slope = self.camera.q_from_pixel(pixel) * self.optics.tan_half_yfov;
        (slope - u * self.optics.inverse_focus_distance).extend(1.0)
    }

    /// The view of some of its splats, which `numbers` names in ascending order.
    pub(crate) fn of_some(&self, numbers: &[u32]) -> Self {
        let splats = numbers.iter().map(|number| self.splats[*number as usize]).collect();
        Self { splats, ..*self }
    }

    pub(crate) fn splats(&self) -> &[ViewSplat] {
        &self.splats
    }

    /// The direction, in the axes of the file, of a camera-space vector.
    pub(crate) fn file_direction(&self, direction: DVec3) -> DVec3 {
        self.file_from_camera * direction
    }
}
