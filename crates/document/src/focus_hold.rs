//! What the focus is held on while the camera moves.

use crate::camera_edit::CameraEdit;
use glam::DVec3;
use lens::Camera;
use project::FocusHold;
use scene::Scene;

/// The shot camera, and what its focus is held on.
#[derive(Clone, Debug, PartialEq)]
pub struct HeldCamera {
    /// The camera.
    pub camera: Camera,
    /// What the focus is held on.
    pub focus_hold: FocusHold,
}

impl HeldCamera {
    /// A camera that is held on the point of its axis at its focus distance.
    pub fn on_axis(camera: Camera) -> Self {
        Self { focus_hold: hold_on_axis(&camera), camera }
    }

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

    /// Focuses on what the focus is held on, as far as that lies in front of the camera.
    fn follow(&mut self, scene: &Scene) {
        let depth = self.focus_hold_position(scene).map(|position| self.camera.camera_from_world(position).z);
        if let Some(depth) = depth.filter(|depth| *depth > 0.0 && depth.is_finite()) {
            self.camera.focus_distance = depth;
        }
    }

    /// The position that the focus is held on; `None` if it is held on the distance, or on an object that the scene does not have.
    pub fn focus_hold_position(&self, scene: &Scene) -> Option<DVec3> {
        match &self.focus_hold {
            FocusHold::Point(position) => Some(*position),
            FocusHold::Object(name) => middle_of_object(scene, name),
            FocusHold::Distance => None,
        }
    }
}

/// The point of the axis at the focus distance; the distance itself if that is infinite.
fn hold_on_axis(camera: &Camera) -> FocusHold {
    let position = camera.world_from_camera(DVec3::Z * camera.focus_distance);
    if position.is_finite() { FocusHold::Point(position) } else { FocusHold::Distance }
}

/// The middle of the bounding box of all nodes of this name.
fn middle_of_object(scene: &Scene, name: &str) -> Option<DVec3> {
    let parts = scene.parts.iter().filter(|part| scene.nodes[part.node as usize].name == name);
    let corners = parts.flat_map(|part| part.triangles.clone()).flat_map(|triangle| scene.corners(triangle));
    let bounds =
        corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    let middle = (bounds.0 + bounds.1) / 2.0;
    middle.is_finite().then_some(middle)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DMat4;
    use scene::Material;
    use test_scenes::{Mesh, scene_of};

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
