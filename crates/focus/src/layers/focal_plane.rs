//! A focal plane that may be tilted or curved: what lies in it is sharp, wherever the lens focuses.

use crate::{Canvas, FocusMap};
use glam::{DQuat, DVec2, DVec3};
use lens::{Camera, FocusOffset};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// A plane of focus through three points of the scene, as of a lens tilted by Scheimpflug's rule, optionally with
/// field curvature.
///
/// A point at depth z in the direction (x, y, 1) of the shot camera is blurred as by an ordinary lens that is focused
/// at the depth where this direction meets the focal surface:
///
/// ```text
/// κ = 1/z_f − 1/z        1/z_f = n·(x, y, 1)/c + curvature · (x² + y²)/tan²θ        t = 1 + d·κ, anchor 1
/// ```
///
/// with the plane n·P = c in camera space. 1/z_f is affine in the picture position, so a direction that misses the
/// plane (it meets it behind the camera, or at infinity) is no special case. The plane stays in the scene when the
/// camera moves; its curvature moves with the camera.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FocalPlane {
    /// Three world points on the plane, not in one line.
    pub points: [DVec3; 3],
    /// Increase of the reciprocal depth of the focal surface at half a picture height from the middle, 1/length:
    /// above 0 the surface bends toward the camera all around, 0 is a plane.
    #[serde(default)]
    pub curvature: f64,
}

/// Offsets are clamped to this: a plane seen edge-on would blur everything beside it without bound.
const MAX_OFFSET: f64 = 1e9;

/// Angles between plane and picture stay below a right angle by this, rad.
const MIN_GRAZING_ANGLE: f64 = 1e-3;

impl FocalPlane {
    /// The plane through three points. `None` if they lie in one line or are not finite.
    pub fn through(points: [DVec3; 3]) -> Option<Self> {
        let plane = Self { points, curvature: 0.0 };
        plane.is_valid().then_some(plane)
    }

    /// The ordinary plane of focus at a depth > 0 of a camera, perpendicular to its axis, with its points spread over
    /// the picture.
    pub fn facing(camera: &Camera, depth: f64) -> Self {
        let half_height = depth * (camera.yfov / 2.0).tan();
        let [middle, half] = camera.frame_q();
        let places = [[-0.5, -0.4], [0.5, -0.4], [0.0, 0.5]];
        let place = |at: [f64; 2]| ((middle + DVec2::from(at) * half) * half_height).extend(depth);
        Self { points: places.map(|at| camera.world_from_camera(place(at))), curvature: 0.0 }
    }

    /// Whether its numbers are finite and its three points do not lie on one line.
    pub fn is_valid(&self) -> bool {
        /// Sine of the angle between two edges below which three points count as one line: positions in files are
        /// 32-bit floats.
        const MIN_SPREAD: f64 = 1e-5;
        let [a, b] = self.edges();
        let spread = a.cross(b).length() / (a.length() * b.length());
        let is_finite = self.points.iter().all(|point| point.is_finite()) && self.curvature.is_finite();
        is_finite && spread > MIN_SPREAD
    }

    fn edges(&self) -> [DVec3; 2] {
        [self.points[1] - self.points[0], self.points[2] - self.points[0]]
    }

    fn middle(&self) -> DVec3 {
        self.points.iter().sum::<DVec3>() / 3.0
    }

    /// Its unit normal in camera space, pointing away from the camera.
    fn normal(&self, camera: &Camera) -> DVec3 {
        let [a, b] = self.edges().map(|edge| camera.camera_direction(edge));
        let normal = a.cross(b).normalize();
        if normal.z < 0.0 { -normal } else { normal }
    }

    /// Its angles against the picture, rad: tilt about the camera's x axis (above 0 the upper part is nearer), and
    /// swing about its y axis (above 0 the right part is nearer). Each less than a right angle either way.
    pub fn tilt_and_swing(&self, camera: &Camera) -> [f64; 2] {
        let normal = self.normal(camera);
        [normal.y.atan2(normal.z), normal.x.atan2(normal.z)]
    }

    /// The plane rotated about the centroid of its points to these angles; see [`Self::tilt_and_swing`].
    pub fn with_tilt_and_swing(&self, camera: &Camera, tilt_and_swing: [f64; 2]) -> Self {
        let steepest = std::f64::consts::FRAC_PI_2 - MIN_GRAZING_ANGLE;
        let [tilt, swing] = tilt_and_swing.map(|angle| angle.clamp(-steepest, steepest).tan());
        let target_normal = camera.world_direction(DVec3::new(swing, tilt, 1.0).normalize());
        let rotation = DQuat::from_rotation_arc(camera.world_direction(self.normal(camera)), target_normal);
        let middle = self.middle();
        Self { points: self.points.map(|point| middle + rotation * (point - middle)), ..self.clone() }
    }

    /// Depth at which the camera's axis meets the plane: infinite if the plane is parallel to the axis, below 0 if
    /// behind the camera.
    pub fn depth_on_axis(&self, camera: &Camera) -> f64 {
        let normal = self.normal(camera);
        normal.dot(camera.camera_from_world(self.points[0])) / normal.z
    }

    /// The plane moved along the camera's axis so as to meet it at this depth; unchanged if it is parallel to the
    /// axis.
    pub fn with_depth_on_axis(&self, camera: &Camera, depth: f64) -> Self {
        let shift = depth - self.depth_on_axis(camera);
        let shift = if shift.is_finite() { camera.world_direction(DVec3::Z) * shift } else { DVec3::ZERO };
        Self { points: self.points.map(|point| point + shift), ..self.clone() }
    }

    /// The focus of a camera-space point; see the type. Points behind the camera, which are not visible, get the
    /// ordinary lens.
    fn offset_at(&self, plane: &CameraSpacePlane, point: DVec3) -> FocusOffset {
        if point.z <= 0.0 {
            return FocusOffset::STANDARD;
        }
        plane.offset_toward(point / point.z, 1.0 / point.z)
    }

    /// The focus of every texel of a canvas, as `camera` sees it. The background's is that of the picture's middle.
    pub fn evaluate(&self, canvas: &Canvas, camera: &Camera) -> FocusMap {
        let plane = CameraSpacePlane::new(self, camera);
        let values: Vec<[f32; 2]> = canvas
            .par_texels()
            .map(|texel| {
                crate::focus_map::to_texel(self.offset_at(&plane, camera.camera_from_world(texel.position)))
            })
            .collect();
        canvas.map_from_values(&values, plane.offset_toward(DVec3::Z, 0.0))
    }
}

/// A focal plane in camera space.
struct CameraSpacePlane {
    /// n/c in camera space: a point lies in the plane if its dot product with this is 1.
    plane: DVec3,
    /// curvature/tan²θ.
    curvature: f64,
    image_distance: f64,
}

impl CameraSpacePlane {
    fn new(plane: &FocalPlane, camera: &Camera) -> Self {
        let optics = camera.optics();
        let normal = plane.normal(camera);
        Self {
            plane: normal / normal.dot(camera.camera_from_world(plane.points[0])),
            curvature: plane.curvature / optics.tan_half_yfov.powi(2),
            image_distance: optics.image_distance,
        }
    }

    /// The focus of a point in `direction` (of depth 1), given the reciprocal of its depth.
    fn offset_toward(&self, direction: DVec3, inverse_depth: f64) -> FocusOffset {
        let surface = self.plane.dot(direction) + self.curvature * direction.truncate().length_squared();
        let t = 1.0 + self.image_distance * (surface - inverse_depth);
        // A camera in the plane divides by 0, and within its own plane 0 by 0: such a direction is in focus at every
        // depth.
        let t = if t.is_nan() { 1.0 } else { t.clamp(-MAX_OFFSET, MAX_OFFSET) };
        FocusOffset::new(t, 1.0)
    }
}
