//! Walking through the scene in the picture: keys move the shot camera, drags turn it, and the horizon stays level.

use crate::window::Action;
use document::{CameraEdit, Document};
use egui::{Context, Key, Vec2};
use glam::{DMat4, DQuat, DVec3, EulerRot};
use session::Command;

/// The first pace: this share of the focus distance, or of the scene where that is smaller, each second.
const PACE: f64 = 0.4;
/// How much faster one runs with Shift held.
const RUNNING: f64 = 3.0;
/// Scroll distance that doubles the pace, points.
const POINTS_PER_DOUBLING: f64 = 160.0;
/// Angle of a turn per point of pointer movement, rad.
const RAD_PER_POINT: f64 = 0.004;
/// The steepest line of sight, rad.
const STEEPEST: f64 = 1.5;
/// A frame that took longer moves no farther, s.
const LONGEST_FRAME: f64 = 0.1;

/// Keys, and where they lead: right, up, ahead.
const KEYS: [(Key, DVec3); 6] = [
    (Key::W, DVec3::Z),
    (Key::S, DVec3::NEG_Z),
    (Key::D, DVec3::X),
    (Key::A, DVec3::NEG_X),
    (Key::E, DVec3::Y),
    (Key::Q, DVec3::NEG_Y),
];

/// What the mode tells while it is on.
pub const HINT: &str =
    "walking: W A S D Q E, drag to look round, wheel for the pace (Enter: stay, Esc: go back)";

/// The walk mode, on or off.
#[derive(Default)]
pub struct Walk {
    walker: Option<Walker>,
}

/// Who walks.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Walker {
    position: DVec3,
    /// Turn about the vertical, rad.
    yaw: f64,
    /// Elevation of the line of sight, rad.
    pitch: f64,
    /// Scene units a second.
    pace: f64,
    has_moved: bool,
}

impl Walk {
    /// Begins at the shot camera.
    pub fn start(&mut self, document: &Document) {
        let camera = &document.camera;
        let (yaw, pitch, _) = DQuat::from_mat4(&camera.camera_to_world).to_euler(EulerRot::YXZ);
        let (low, high) = document.scene().bounds();
        let reach = camera.focus_distance.min((high - low).length());
        let pace = if reach > 0.0 && reach.is_finite() { PACE * reach } else { PACE };
        self.walker = Some(Walker { position: camera.position(), yaw, pitch, pace, has_moved: false });
    }

    /// Whether it is on.
    pub fn is_on(&self) -> bool {
        self.walker.is_some()
    }

    /// Moves by the keys that are held; Enter and Esc end it.
    pub fn handle_keys(&mut self, context: &Context, actions: &mut Vec<Action>) {
        let Some(walker) = &mut self.walker else { return };
        let (heading, speed, seconds) = context.input(|input| {
            let held = KEYS.iter().filter(|(key, _)| input.key_down(*key));
            let speed = if input.modifiers.shift { RUNNING } else { 1.0 };
            (held.map(|(_, heading)| *heading).sum::<DVec3>(), speed, f64::from(input.stable_dt))
        });
        if heading != DVec3::ZERO {
            walker.step(heading.normalize() * speed, seconds.min(LONGEST_FRAME));
            actions.push(walker.edit());
            context.request_repaint();
        }
        let is_pressed = |key| context.input_mut(|input| input.consume_key(egui::Modifiers::NONE, key));
        let has_moved = walker.has_moved;
        if is_pressed(Key::Enter) {
            actions.push(Command::FinishEdit.into());
            self.walker = None;
        } else if is_pressed(Key::Escape) {
            actions.push(Command::FinishEdit.into());
            actions.extend(has_moved.then(|| Command::Undo.into()));
            self.walker = None;
        }
    }

    /// Looks round by a drag, in points (y down).
    pub fn turn(&mut self, delta: Vec2, actions: &mut Vec<Action>) {
        let Some(walker) = self.walker.as_mut().filter(|_| delta != Vec2::ZERO) else { return };
        walker.yaw -= f64::from(delta.x) * RAD_PER_POINT;
        walker.pitch = (walker.pitch - f64::from(delta.y) * RAD_PER_POINT).clamp(-STEEPEST, STEEPEST);
        actions.push(walker.edit());
    }

    /// Changes the pace by the wheel, in points.
    pub fn scroll(&mut self, points: f32) {
        if let Some(walker) = &mut self.walker {
            walker.pace = (walker.pace * (f64::from(points) / POINTS_PER_DOUBLING).exp2()).clamp(1e-6, 1e9);
        }
    }
}

impl Walker {
    /// Steps in a direction (right, up, ahead), on the level of the floor.
    fn step(&mut self, heading: DVec3, seconds: f64) {
        let world = DQuat::from_rotation_y(self.yaw) * DVec3::new(heading.x, heading.y, -heading.z);
        self.position += world * (self.pace * seconds);
    }

    fn pose(&self) -> DMat4 {
        let orientation = DQuat::from_euler(EulerRot::YXZ, self.yaw, self.pitch, 0.0);
        DMat4::from_rotation_translation(orientation, self.position)
    }

    fn edit(&mut self) -> Action {
        self.has_moved = true;
        Command::EditCamera(CameraEdit::Pose(self.pose())).into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_stay_on_the_level_and_turns_keep_the_horizon() {
        let mut walker = Walker { position: DVec3::Y, yaw: 0.0, pitch: -0.4, pace: 2.0, has_moved: false };
        walker.step(DVec3::Z, 0.5);
        assert!(walker.position.distance(DVec3::new(0.0, 1.0, -1.0)) < 1e-12, "ahead is −z");
        walker.yaw = std::f64::consts::FRAC_PI_2;
        walker.step(DVec3::X, 0.5);
        assert!(walker.position.distance(DVec3::new(0.0, 1.0, -2.0)) < 1e-12, "turned to −x, right is −z");
        assert!(walker.pose().x_axis.y.abs() < 1e-12);
        let mut walk = Walk { walker: Some(walker) };
        let mut actions = Vec::new();
        walk.turn(egui::vec2(0.0, -1e5), &mut actions);
        walk.scroll(160.0);
        let walker = walk.walker.unwrap();
        assert_eq!((walker.pitch, walker.pace, actions.len()), (STEEPEST, 4.0, 1));
    }
}
