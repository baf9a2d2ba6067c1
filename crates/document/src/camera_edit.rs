//! A change of one property of the camera.

use crate::focus_hold::HeldCamera;
use glam::{DMat4, DVec2};
use lens::{Aperture, Camera};
use project::FocusHold;

/// A change of one property of the camera.
#[derive(Clone, Debug, PartialEq)]
pub enum CameraEdit {
    /// Axial distance of the focus plane, > 0; may be infinite.
    FocusDistance(f64),
    /// What the focus is held on, which is focused at once.
    FocusOn(FocusHold),
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
    /// All properties, and what the focus is held on: a bookmark.
    Held(Box<HeldCamera>),
}

impl CameraEdit {
    /// Changes the camera, which may be invalid then; returns the edit's name in the undo list.
    pub(crate) fn apply_to(self, camera: &mut Camera) -> &'static str {
        match self {
            Self::FocusDistance(distance) => {
                camera.focus_distance = distance;
                "Focus distance"
            }
            Self::ApertureRadius(radius) => {
                camera.aperture_radius = radius;
                "Aperture radius"
            }
            Self::FNumber(number) => {
                camera.aperture_radius = camera.optics().focal_length() / (2.0 * number);
                "f-number"
            }
            Self::Aperture(aperture) => {
                camera.aperture = aperture;
                "Aperture shape"
            }
            Self::YFov(yfov) => {
                camera.yfov = yfov;
                "Angle of view"
            }
            Self::SensorHeight(height) => {
                camera.sensor_height = height;
                "Sensor height"
            }
            Self::Shift(shift) => {
                camera.shift = shift;
                "Sensor shift"
            }
            Self::Background(radiance) => {
                camera.background = radiance;
                "Background"
            }
            Self::Size(width, height) => {
                (camera.width, camera.height) = (width, height);
                "Picture size"
            }
            Self::Pose(pose) => {
                camera.camera_to_world = pose;
                "Camera pose"
            }
            Self::Whole(whole) => {
                *camera = whole;
                "Camera"
            }
            // What they do besides is done by `HeldCamera::edited`.
            Self::FocusOn(_) => "Focus",
            Self::Held(held) => {
                *camera = held.camera;
                "Bookmark"
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_f_number_round_trips() {
        let mut camera = Camera::default();
        CameraEdit::FNumber(1.4).apply_to(&mut camera);
        assert!((camera.f_number() - 1.4).abs() < 1e-12);
        CameraEdit::FNumber(f64::INFINITY).apply_to(&mut camera);
        assert_eq!(camera.aperture_radius, 0.0);
        camera.validate().unwrap();
    }
}
