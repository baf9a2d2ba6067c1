//! What the focus is held on while the camera moves.

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

    /// Focuses on what the focus is held on, as far as that lies in front of the camera.
    pub(crate) fn follow(&mut self, scene: &Scene) {
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
pub(crate) fn hold_on_axis(camera: &Camera) -> FocusHold {
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
