//! A change of one property of the camera.

use crate::focus_hold::{HeldCamera, hold_on_axis};
use glam::{DMat4, DVec2};
use lens::{Aperture, Camera, Character};
use project::FocusHold;
use scene::Scene;

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
    /// What the lens does beside focusing.
    Character(Character),
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
    Whole(Box<Camera>),
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
            Self::Character(character) => {
                camera.character = character;
                "Lens character"
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
                *camera = *whole;
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

impl HeldCamera {
    /// The name of an edit in the undo list, and the camera after it, which may be invalid. If the camera moves, the focus distance follows
    /// what the focus is held on; if the focus distance changes, the focus is held on the point of the axis at that distance, unless it is
    /// held on the distance.
    pub fn edited(&self, edit: CameraEdit, scene: &Scene) -> (&'static str, Self) {
        let mut after = self.clone();
        let moves = matches!(edit, CameraEdit::Pose(_) | CameraEdit::FocusOn(_));
        let refocuses = matches!(edit, CameraEdit::FocusDistance(_) | CameraEdit::Whole(_));
        match &edit {
            CameraEdit::FocusOn(hold) => after.focus_hold = hold.clone(),
            CameraEdit::Held(held) => after.focus_hold = held.focus_hold.clone(),
            _ => {}
        }
        let name = edit.apply_to(&mut after.camera);
        if refocuses && self.focus_hold != FocusHold::Distance {
            after.focus_hold = hold_on_axis(&after.camera);
        }
        if moves {
            after.follow(scene);
        }
        (name, after)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use scene::Material;
    use test_scenes::{Mesh, scene_of};

    #[test]
    fn an_f_number_round_trips() {
        let mut camera = Camera::default();
        CameraEdit::FNumber(1.4).apply_to(&mut camera);
        assert!((camera.f_number() - 1.4).abs() < 1e-12);
        CameraEdit::FNumber(f64::INFINITY).apply_to(&mut camera);
        assert_eq!(camera.aperture_radius, 0.0);
        camera.validate().unwrap();
    }

    /// A square of 2 × 2 in the middle of the plane z = −4.
    fn scene() -> std::sync::Arc<Scene> {
        let square = Mesh::rectangle(DVec3::new(-1.0, -1.0, -4.0), DVec3::X * 2.0, DVec3::Y * 2.0);
        scene_of([(square, Material::lambertian_white())])
    }

    fn moved_to(z: f64) -> CameraEdit {
        CameraEdit::Pose(DMat4::from_translation(DVec3::Z * z))
    }

    #[test]
    fn a_dolly_leaves_what_was_sharp_sharp() {
        let start = HeldCamera::on_axis(Camera { focus_distance: 4.0, ..Camera::default() });
        let (_, near) = start.edited(moved_to(-2.0), &scene());
        assert!((near.camera.focus_distance - 2.0).abs() < 1e-12);
        assert_eq!(near.focus_hold, start.focus_hold);
        let (_, passed) = near.edited(moved_to(-5.0), &scene());
        assert_eq!(passed.camera.focus_distance, near.camera.focus_distance, "behind the camera: as it was");
        let (_, back) = passed.edited(moved_to(0.0), &scene());
        assert_eq!(back, start);
    }

    #[test]
    fn the_distance_can_be_held_instead() {
        let start = HeldCamera {
            camera: Camera { focus_distance: 4.0, ..Camera::default() },
            focus_hold: FocusHold::Distance,
        };
        let (_, moved) = start.edited(moved_to(-2.0), &scene());
        assert_eq!(moved.camera.focus_distance, 4.0);
        let (_, racked) = moved.edited(CameraEdit::FocusDistance(1.0), &scene());
        assert_eq!(racked.focus_hold, FocusHold::Distance);
    }

    #[test]
    fn a_changed_distance_is_held_where_it_points() {
        let start = HeldCamera::on_axis(Camera { focus_distance: 4.0, ..Camera::default() });
        let (_, racked) = start.edited(CameraEdit::FocusDistance(3.0), &scene());
        assert_eq!(racked.focus_hold, FocusHold::Point(DVec3::new(0.0, 0.0, -3.0)));
        let (_, infinite) = start.edited(CameraEdit::FocusDistance(f64::INFINITY), &scene());
        assert_eq!(infinite.focus_hold, FocusHold::Distance);
    }

    #[test]
    fn an_object_is_focused_in_its_middle() {
        let scene = scene();
        let name = scene.nodes[0].name.clone();
        let start = HeldCamera::on_axis(Camera { focus_distance: 1.0, ..Camera::default() });
        let (_, held) = start.edited(CameraEdit::FocusOn(FocusHold::Object(name)), &scene);
        assert!((held.camera.focus_distance - 4.0).abs() < 1e-12);
        let missing = CameraEdit::FocusOn(FocusHold::Object("nothing".into()));
        assert_eq!(start.edited(missing, &scene).1.camera.focus_distance, 1.0);
    }
}
