//! The lens of a camera in the file.

use glam::DVec2;
use lens::{Aperture, Camera};

/// The lens settings of a camera in the file beyond those of glTF; `None` if not given.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CameraLens {
    /// Picture width and height, px.
    pub size_px: Option<[u32; 2]>,
    /// [`Camera::focus_distance`].
    pub focus_distance: Option<f64>,
    /// [`Camera::aperture_radius`].
    pub aperture_radius: Option<f64>,
    /// [`Camera::sensor_height`].
    pub sensor_height: Option<f64>,
    /// [`Camera::shift`].
    pub shift: Option<DVec2>,
    /// [`Camera::aperture`].
    pub aperture: Option<Aperture>,
}

impl CameraLens {
    /// `camera` with these settings of the lens; all others stay.
    pub fn apply_to(&self, camera: Camera) -> Camera {
        let [width, height] = self.size_px.unwrap_or([camera.width, camera.height]);
        Camera {
            width,
            height,
            focus_distance: self.focus_distance.unwrap_or(camera.focus_distance),
            aperture_radius: self.aperture_radius.unwrap_or(camera.aperture_radius),
            sensor_height: self.sensor_height.unwrap_or(camera.sensor_height),
            shift: self.shift.unwrap_or(camera.shift),
            aperture: self.aperture.clone().unwrap_or(camera.aperture),
            ..camera
        }
    }

    /// The names of the fields that are given, as in a camera file.
    pub fn specified_fields(&self) -> Vec<&'static str> {
        let fields = [
            ("width", self.size_px.is_some()),
            ("height", self.size_px.is_some()),
            ("focus_distance", self.focus_distance.is_some()),
            ("aperture_radius", self.aperture_radius.is_some()),
            ("sensor_height", self.sensor_height.is_some()),
            ("shift", self.shift.is_some()),
            ("aperture", self.aperture.is_some()),
        ];
        fields.into_iter().filter(|(_, is_present)| *is_present).map(|(name, _)| name).collect()
    }
}
