//! The aperture as a pad: dragging over it shows the picture through the aperture point under the pointer.

use crate::window::Action;
use egui::{Color32, Rect, Response, Stroke, Ui, vec2};
use glam::DVec2;
use lens::SUB_APERTURE_RADIUS;
use session::{Command, Session};

/// Tooltip of the pad.
pub const APERTURE_TIP: &str = "The aperture seen from behind the camera. Drag to see the scene through that point of it; release with Shift held to \
     keep looking through it until Esc. If a point of the scene is chosen, the aperture is shown as seen from there.";

/// Follows the pointer over a pad that shows the aperture from behind the camera, and marks the active aperture
/// point.
pub fn aperture_pad(ui: &Ui, response: &Response, session: &Session, actions: &mut Vec<Action>) {
    let rect = response.rect;
    if response.dragged()
        && let Some(pointer) = response.interact_pointer_pos()
    {
        actions.push(Command::SetSubAperture(Some(aperture_point(rect, pointer))).into());
    }
    if response.drag_stopped() && !ui.input(|input| input.modifiers.shift) {
        actions.push(Command::SetSubAperture(None).into());
    }
    if let Some(point) = session.sub_aperture_point() {
        let half = rect.size() / 2.0;
        let place = rect.center() + vec2(point.x as f32, -point.y as f32) * half;
        let radius = (SUB_APERTURE_RADIUS as f32 * half.x).max(4.0);
        let painter = ui.painter_at(rect);
        painter.circle_stroke(place, radius + 1.0, Stroke::new(3.0, Color32::from_black_alpha(160)));
        painter.circle_stroke(place, radius + 1.0, Stroke::new(1.5, Color32::WHITE));
    }
}

/// The aperture point at a position of the pad, clamped so that the sub-aperture stays inside.
fn aperture_point(rect: Rect, place: egui::Pos2) -> DVec2 {
    let from_middle = (place - rect.center()) / (rect.size() / 2.0);
    let most = DVec2::splat(1.0 - SUB_APERTURE_RADIUS);
    DVec2::new(from_middle.x.into(), (-from_middle.y).into()).clamp(-most, most)
}
