//! Editor of the brush's falloff: strength over the distance from the centre, edited by dragging points.

use crate::window::widgets::controls;
use egui::{Color32, ComboBox, PointerButton, Pos2, Rect, Sense, Stroke, Ui, pos2, vec2};
use focus::{Brush, Curve};

/// Height of the drawing, points.
const HEIGHT: f32 = 74.0;
/// Distance within which the pointer grabs a control point, points.
const REACH: f32 = 9.0;

/// Initial shapes.
const PRESETS: [(&str, &[[f64; 2]]); 4] = [
    ("Linear", &[[0.0, 1.0], [0.25, 0.75], [0.5, 0.5], [0.75, 0.25], [1.0, 0.0]]),
    ("Dome", &[[0.0, 1.0], [0.5, 0.87], [0.8, 0.6], [1.0, 0.0]]),
    ("Spike", &[[0.0, 1.0], [0.25, 0.42], [0.5, 0.18], [1.0, 0.0]]),
    ("Ring", &[[0.0, 0.0], [0.6, 1.0], [1.0, 0.0]]),
];

/// The row that chooses between hardness and a drawn falloff.
pub fn falloff_choice(ui: &mut Ui, brush: &mut Brush) -> egui::Response {
    let text = if brush.drawn_falloff.is_some() { "drawn" } else { "by hardness" };
    let combo = ComboBox::from_id_salt("falloff").selected_text(text).width(110.0);
    combo
        .show_ui(ui, |ui| {
            if ui.selectable_label(brush.drawn_falloff.is_none(), "by hardness").clicked() {
                brush.drawn_falloff = None;
            }
            for (name, points) in PRESETS {
                if ui.selectable_label(false, name).clicked() {
                    brush.drawn_falloff = Curve::new(points.iter().copied());
                }
            }
        })
        .response
}

/// The editor of a drawn falloff; nothing otherwise.
pub fn falloff_editor(ui: &mut Ui, brush: &mut Brush) {
    let Some(curve) = &brush.drawn_falloff else { return };
    let (outer, response) =
        ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::click_and_drag());
    controls::set_accessible_name(&response, "Falloff of the brush");
    let rect = outer.shrink(6.0);
    let mut points = curve.points().to_vec();
    let screen = |[x, y]: [f64; 2]| {
        pos2(rect.left() + x as f32 * rect.width(), rect.bottom() - y as f32 * rect.height())
    };
    let near = |points: &[[f64; 2]], at: Pos2| {
        let distance = |k: &usize| screen(points[*k]).distance(at);
        (0..points.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).filter(|k| distance(k) <= REACH)
    };
    let id = response.id.with("held");
    let held = ui.data(|data| data.get_temp::<usize>(id));
    if let Some(at) = response.interact_pointer_pos() {
        let share = |value: f32| f64::from(value.clamp(0.0, 1.0));
        let place =
            [share((at.x - rect.left()) / rect.width()), share((rect.bottom() - at.y) / rect.height())];
        if response.clicked_by(PointerButton::Secondary)
            && let Some(k) = near(&points, at).filter(|_| points.len() > 2)
        {
            points.remove(k);
        } else if ui.input(|input| input.pointer.primary_pressed()) && response.is_pointer_button_down_on() {
            let k = near(&points, at).unwrap_or_else(|| {
                let k = points.partition_point(|point| point[0] < place[0]);
                points.insert(k, place);
                k
            });
            ui.data_mut(|data| data.insert_temp(id, k));
        } else if let Some(k) = held.filter(|k| *k < points.len() && response.dragged()) {
            // A point is kept between its neighbours.
            let low = k.checked_sub(1).map_or(0.0, |before| points[before][0] + 0.01);
            let high = points.get(k + 1).map_or(1.0, |after| after[0] - 0.01);
            points[k] = [place[0].clamp(low, high.max(low)), place[1]];
        }
    }
    if held.is_some() && !ui.input(|input| input.pointer.primary_down()) {
        ui.data_mut(|data| data.remove_temp::<usize>(id));
    }
    if points != curve.points()
        && let Some(changed) = Curve::new(points)
    {
        brush.drawn_falloff = Some(changed);
    }
    if let Some(curve) = &brush.drawn_falloff {
        paint(ui, outer, rect, curve, screen);
    }
    response.on_hover_text(
        "Strength from the centre of the brush (left) to its rim (right). Drag a point; click elsewhere to \
         add one; right-click to remove one.",
    );
}

fn paint(ui: &Ui, outer: Rect, rect: Rect, curve: &Curve, screen: impl Fn([f64; 2]) -> Pos2) {
    let painter = ui.painter_at(outer);
    painter.rect_filled(outer, 3.0, ui.visuals().extreme_bg_color);
    let line: Vec<Pos2> = (0..=64).map(|k| k as f64 / 64.0).map(|x| screen([x, curve.evaluate(x)])).collect();
    painter.line(line, Stroke::new(2.0, ui.visuals().text_color()));
    painter
        .line_segment([rect.left_bottom(), rect.right_bottom()], Stroke::new(1.0, Color32::from_gray(110)));
    for point in curve.points() {
        painter.circle(
            screen(*point),
            4.0,
            ui.visuals().text_color(),
            Stroke::new(1.0, Color32::from_gray(20)),
        );
    }
}
