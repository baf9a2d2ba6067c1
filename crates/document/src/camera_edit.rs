//! A change of one property of the camera.

use glam::{DMat4, DVec2};
use lens::{Aperture, Camera};

/// A change of one property of the camera.
#[derive(Clone, Debug, PartialEq)]
pub enum CameraEdit {
    /// Axial distance of the focus plane, > 0; may be infinite.
    FocusDistance(f64),
    /// R, ≥ 0.
    ApertureRadius(f64),
    /// f/(2R), > 0: sets R. Infinity closes the aperture to a pinhole.
    FNumber(f64),
    /// Shape and aspect ratio.
    Aperture(Aperture),
    /// Full vertical angle of view, rad.
    YFov(f64),
    /// Height of the sensor.
    SensorHeight(f64),
    /// Sensor shift to the right and up, in picture heights.
    Shift(DVec2),
    /// Linear radiance where no surface is; `None` for that of the scene's world.
    Background(Option<[f64; 3]>),
    /// Picture width and height, px.
    Size(u32, u32),
    /// Pose, with glTF's axes.
    Pose(DMat4),
    /// All properties at once: a camera of the scene, a preset.
    Whole(Camera),
}

impl CameraEdit {
    /// The edit's name in the undo list, and the changed camera, which may be invalid.
    pub fn applied_to(self, camera: &Camera) -> (&'static str, Camera) {
        let mut after = camera.clone();
        let name = match self {
            Self::FocusDistance(distance) => {
                after.focus_distance = distance;
                "Focus distance"
            }
            Self::ApertureRadius(radius) => {
                after.aperture_radius = radius;
                "Aperture radius"
            }
            Self::FNumber(number) => {
                after.aperture_radius = camera.optics().focal_length() / (2.0 * number);
                "f-number"
            }
            Self::Aperture(aperture) => {
                after.aperture = aperture;
                "Aperture shape"
            }
            Self::YFov(yfov) => {
                after.yfov = yfov;
                "Angle of view"
            }
            Self::SensorHeight(height) => {
                after.sensor_height = height;
                "Sensor height"
            }
            Self::Shift(shift) => {
                after.shift = shift;
                "Sensor shift"
            }
            Self::Background(radiance) => {
                after.background = radiance;
                "Background"
            }
            Self::Size(width, height) => {
                (after.width, after.height) = (width, height);
                "Picture size"
            }
            Self::Pose(pose) => {
                after.camera_to_world = pose;
                "Camera pose"
            }
            Self::Whole(whole) => {
                after = whole;
                "Camera"
            }
        };
        (name, after)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_f_number_round_trips() {
        let (_, camera) = CameraEdit::FNumber(1.4).applied_to(&Camera::default());
        assert!((camera.f_number() - 1.4).abs() < 1e-12);
        let (_, pinhole) = CameraEdit::FNumber(f64::INFINITY).applied_to(&camera);
        assert_eq!(pinhole.aperture_radius, 0.0);
        pinhole.validate().unwrap();
    }
}
