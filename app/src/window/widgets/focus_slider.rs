//! A slider from near blur through sharp to far blur, in the false colours of the views; finer around sharp,
//! where it snaps.

use super::false_colour;
use egui::{
    Color32, CornerRadius, CursorIcon, Key, Rect, Response, Role, Sense, Stroke, Ui, WidgetInfo, pos2, vec2,
};

/// Positions this close to the centre snap to sharp.
const SNAP: f64 = 0.035;
/// Step of an arrow key.
const KEY_STEP: f64 = 0.04;

/// Shows a slider for a signed circle of confusion in px (negative near, positive far). `Response::changed`
/// reports a new value.
pub fn focus_slider(ui: &mut Ui, circle_px: &mut f64, width: f32) -> Response {
    let (rect, mut response) = ui.allocate_exact_size(vec2(width, 22.0), Sense::click_and_drag());
    let track = Rect::from_center_size(rect.center(), vec2(rect.width() - 10.0, 10.0));
    let old = *circle_px;
    if let Some(pointer) = response.interact_pointer_pos() {
        let place = 2.0 * ((pointer.x - track.left()) / track.width()) as f64 - 1.0;
        *circle_px = snapped_circle_px(place);
        response.request_focus();
    }
    if response.has_focus() {
        // The arrows belong to the slider while it has the keyboard.
        let arrows = egui::EventFilter { horizontal_arrows: true, ..Default::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrows));
        let pressed = |key| ui.input(|input| input.num_presses(key)) as f64;
        let steps = pressed(Key::ArrowRight) - pressed(Key::ArrowLeft);
        if steps != 0.0 {
            *circle_px = snapped_circle_px(false_colour::position(*circle_px) + steps * KEY_STEP);
        }
    }
    if *circle_px != old {
        response.mark_changed();
    }
    let value = *circle_px;
    response.widget_info(|| WidgetInfo {
        role: Role::Slider,
        ..WidgetInfo::slider(ui.is_enabled(), value, "Blur")
    });
    if ui.is_rect_visible(rect) {
        paint(ui, rect, track, *circle_px, &response);
    }
    response.on_hover_cursor(CursorIcon::ResizeHorizontal)
}

/// The circle of confusion at a position on the track, in [−1, 1]; 0 near the centre.
fn snapped_circle_px(place: f64) -> f64 {
    if place.abs() < SNAP { 0.0 } else { false_colour::circle_px(place.clamp(-1.0, 1.0)) }
}

fn paint(ui: &Ui, rect: Rect, track: Rect, circle_px: f64, response: &Response) {
    let painter = ui.painter();
    let fade = if ui.is_enabled() { 1.0 } else { 0.35 };
    false_colour::paint_bar(painter, track, fade);
    let middle = Stroke::new(1.0, Color32::from_gray(40));
    painter.vline(track.center().x, track.y_range(), middle);
    let x = track.center().x + false_colour::position(circle_px) as f32 * track.width() / 2.0;
    let knob = Rect::from_center_size(pos2(x, rect.center().y), vec2(9.0, 20.0));
    let rim =
        if response.has_focus() || response.hovered() { Color32::WHITE } else { Color32::from_gray(20) };
    painter.rect(
        knob,
        CornerRadius::same(3),
        false_colour::color(circle_px),
        Stroke::new(1.5, rim),
        egui::StrokeKind::Inside,
    );
    painter.rect_stroke(
        knob.expand(1.0),
        CornerRadius::same(3),
        Stroke::new(1.0, Color32::from_gray(20)),
        egui::StrokeKind::Inside,
    );
}
