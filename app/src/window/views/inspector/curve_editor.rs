//! Editor of a depth curve: blur over depth, edited by dragging points.

use crate::window::Action;
use crate::window::widgets::brush_controls::signed_circle_px;
use crate::window::widgets::controls::{self, finish_edit, format_number, proportional_value};
use crate::window::widgets::false_colour;
use document::Document;
use egui::{
    Align2, Color32, DragValue, FontId, PointerButton, Pos2, Rect, Sense, Shape, Stroke, Ui, pos2, vec2,
};
use focus::{Curve, DepthCurve, LayerEdit};
use lens::Optics;
use session::Command;

/// Height of the drawing, points.
const HEIGHT: f32 = 130.0;
/// Distance within which the pointer grabs a control point, points.
const REACH: f32 = 10.0;
/// Blur closer to sharp than this, as a share of the map, snaps to sharp.
const SNAP: f64 = 0.035;

/// The curve, and its points as numbers below.
pub fn curve_editor(
    ui: &mut Ui,
    document: &Document,
    index: usize,
    curve: &DepthCurve,
    actions: &mut Vec<Action>,
) {
    let optics = document.camera.optics();
    if optics.aperture_radius <= 0.0 {
        ui.weak("A pinhole blurs nothing: open the aperture first.");
        return;
    }
    let mut points = curve.curve.points().to_vec();
    edit_by_pointer(ui, &optics, document.camera.focus_distance, curve, &mut points, actions);
    edit_by_number(ui, &optics, &mut points, actions);
    if points != curve.curve.points()
        && let Some(changed) = Curve::new(points)
    {
        let curve = DepthCurve { curve: changed, ..curve.clone() };
        actions.push(Command::EditLayers(LayerEdit::Curve(index, curve)).into());
    }
}

/// Maps between curve and screen coordinates.
struct Axes {
    rect: Rect,
    /// ln(depth) at the left and right end.
    ends: [f64; 2],
}

impl Axes {
    /// Encloses the points, with a margin on either side.
    fn around(points: &[[f64; 2]], rect: Rect) -> Self {
        let (first, last) = (points[0][0], points[points.len() - 1][0]);
        let room = ((last - first) * 0.1).max(0.2);
        Self { rect, ends: [first - room, last + room] }
    }

    fn screen(&self, optics: &Optics, [ln_depth, t]: [f64; 2]) -> Pos2 {
        let [low, high] = self.ends;
        let x = ((ln_depth - low) / (high - low)) as f32;
        let y = false_colour::position(signed_circle_px(optics, t)) as f32;
        pos2(self.rect.left() + x * self.rect.width(), self.rect.center().y - y * self.rect.height() / 2.0)
    }

    fn curve(&self, optics: &Optics, at: Pos2) -> Option<[f64; 2]> {
        let [low, high] = self.ends;
        let x = ((at.x - self.rect.left()) / self.rect.width()).clamp(0.0, 1.0) as f64;
        let y = (2.0 * (self.rect.center().y - at.y) / self.rect.height()).clamp(-1.0, 1.0) as f64;
        let circle_px = if y.abs() < SNAP { 0.0 } else { false_colour::circle_px(y) };
        Some([low + x * (high - low), offset_for_circle(optics, circle_px)?])
    }
}

/// The t that gives a signed circle of confusion, px, at any depth.
fn offset_for_circle(optics: &Optics, circle_px: f64) -> Option<f64> {
    let kappa = optics.kappa_for_circle_px(circle_px)?;
    optics.offset_for_kappa(kappa, optics.inverse_focus_distance, 1.0)
}

fn edit_by_pointer(
    ui: &mut Ui,
    optics: &Optics,
    focus_distance: f64,
    curve: &DepthCurve,
    points: &mut Vec<[f64; 2]>,
    actions: &mut Vec<Action>,
) {
    let size = vec2(ui.available_width(), HEIGHT);
    let (outer, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    controls::set_accessible_name(&response, "Blur over depth");
    let rect = outer.shrink2(vec2(6.0, 14.0));
    // The axes stay fixed while a point is dragged.
    let id = response.id.with("held");
    let held = ui.data(|data| data.get_temp::<(usize, [f64; 2])>(id));
    let mut axes = Axes::around(points, rect);
    if let Some((_, ends)) = held {
        axes.ends = ends;
    }
    let near = |points: &[[f64; 2]], at: Pos2| {
        let distance = |k: &usize| axes.screen(optics, points[*k]).distance(at);
        (0..points.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).filter(|k| distance(k) <= REACH)
    };
    let pointer = response.interact_pointer_pos();
    if let Some(at) = pointer {
        if response.clicked_by(PointerButton::Secondary)
            && let Some(k) = near(points, at).filter(|_| points.len() > 1)
        {
            points.remove(k);
            actions.push(Command::FinishEdit.into());
        } else if ui.input(|input| input.pointer.primary_pressed()) && response.is_pointer_button_down_on() {
            let k = near(points, at).or_else(|| {
                let point = axes.curve(optics, at).filter(|_| points.len() < Curve::MAX_POINTS)?;
                let k = points.partition_point(|p| p[0] < point[0]);
                points.insert(k, point);
                Some(k)
            });
            if let Some(k) = k {
                ui.data_mut(|data| data.insert_temp(id, (k, axes.ends)));
            }
        } else if let Some((k, _)) = held.filter(|(k, _)| *k < points.len())
            && response.dragged()
            && let Some([x, t]) = axes.curve(optics, at)
        {
            // A point is kept between its neighbours.
            let gap = 1e-3 * (axes.ends[1] - axes.ends[0]);
            let low = k.checked_sub(1).map_or(axes.ends[0], |before| points[before][0] + gap);
            let high = points.get(k + 1).map_or(axes.ends[1], |after| after[0] - gap);
            points[k] = [x.clamp(low, high.max(low)), t];
        }
    }
    if held.is_some() && !ui.input(|input| input.pointer.primary_down()) {
        ui.data_mut(|data| data.remove_temp::<(usize, [f64; 2])>(id));
        actions.push(Command::FinishEdit.into());
    }
    let response = response.on_hover_text(
        "The blur at every depth: near blur at the bottom, sharp in the middle, far blur at the top. Drag a \
         point; click elsewhere to add one; right-click to remove one.",
    );
    let hovered = response.hover_pos().and_then(|at| near(points, at));
    paint(
        ui,
        &axes,
        outer,
        optics,
        focus_distance,
        &DepthCurve {
            curve: Curve::new(points.iter().copied()).unwrap_or_else(|| curve.curve.clone()),
            ..curve.clone()
        },
        hovered,
    );
}

fn paint(
    ui: &Ui,
    axes: &Axes,
    outer: Rect,
    optics: &Optics,
    focus_distance: f64,
    curve: &DepthCurve,
    hovered: Option<usize>,
) {
    let painter = ui.painter_at(outer);
    let grey = Color32::from_gray;
    painter.rect_filled(outer, 3.0, ui.visuals().extreme_bg_color);
    let rect = axes.rect;
    let level = |y: f32| [pos2(rect.left(), y), pos2(rect.right(), y)];
    painter.line_segment(level(rect.center().y), Stroke::new(1.0, grey(90)));
    for circle_px in [-16.0, -4.0, 4.0, 16.0] {
        let y = rect.center().y - false_colour::position(circle_px) as f32 * rect.height() / 2.0;
        painter.line_segment(level(y), Stroke::new(1.0, grey(44)));
    }
    if focus_distance.is_finite() {
        let x = axes.screen(optics, [focus_distance.ln(), 1.0]).x;
        if rect.x_range().contains(x) {
            let line = [pos2(x, rect.top()), pos2(x, rect.bottom())];
            painter.add(Shape::dashed_line(&line, Stroke::new(1.0, grey(110)), 4.0, 4.0));
        }
    }
    let mut last: Option<Pos2> = None;
    for k in 0..=160 {
        let ln_depth = axes.ends[0] + (axes.ends[1] - axes.ends[0]) * k as f64 / 160.0;
        let t = curve.curve.evaluate(ln_depth);
        let at = axes.screen(optics, [ln_depth, t]);
        if let Some(last) = last {
            let color = false_colour::color(signed_circle_px(optics, t));
            painter.line_segment([last, at], Stroke::new(2.0, color));
        }
        last = Some(at);
    }
    for (k, point) in curve.curve.points().iter().enumerate() {
        let radius = if hovered == Some(k) { 6.0 } else { 4.5 };
        let fill = false_colour::color(signed_circle_px(optics, point[1]));
        painter.circle(axes.screen(optics, *point), radius, fill, Stroke::new(1.0, grey(20)));
    }
    let label = |at: Pos2, align: Align2, text: String| {
        painter.text(at, align, text, FontId::proportional(10.0), grey(170));
    };
    let depth = |ln_depth: f64| controls::length_text(ln_depth.exp());
    label(outer.left_bottom() + vec2(6.0, -1.0), Align2::LEFT_BOTTOM, depth(axes.ends[0]));
    label(outer.right_bottom() + vec2(-6.0, -1.0), Align2::RIGHT_BOTTOM, depth(axes.ends[1]));
    label(outer.center_bottom() + vec2(0.0, -1.0), Align2::CENTER_BOTTOM, "near blur".into());
    label(outer.center_top() + vec2(0.0, 1.0), Align2::CENTER_TOP, "far blur".into());
}

/// Number fields for the depth and blur of every point.
fn edit_by_number(ui: &mut Ui, optics: &Optics, points: &mut Vec<[f64; 2]>, actions: &mut Vec<Action>) {
    let mut removed = None;
    let removable = points.len() > 1;
    for (k, point) in points.iter_mut().enumerate() {
        ui.horizontal(|ui| {
            let mut depth = point[0].exp();
            let value =
                proportional_value(&mut depth, 1e-6..=1e9).custom_formatter(format_number).suffix(" m");
            let response = ui.add(value).on_hover_text("Depth of this point.");
            controls::set_accessible_name(&response, &format!("Depth of point {}", k + 1));
            if response.changed() {
                point[0] = depth.ln();
            }
            finish_edit(&response, actions);
            let mut circle_px = signed_circle_px(optics, point[1]);
            let value = DragValue::new(&mut circle_px).speed(0.1).max_decimals(2).suffix(" px");
            let response = ui.add(value).on_hover_text("Blur at this depth: negative is near, positive far.");
            controls::set_accessible_name(&response, &format!("Blur of point {}", k + 1));
            if response.changed()
                && let Some(t) = offset_for_circle(optics, circle_px)
            {
                point[1] = t;
            }
            finish_edit(&response, actions);
            let remove = ui.add_enabled(removable, egui::Button::new("Remove"));
            controls::set_accessible_name(&remove, &format!("Remove point {}", k + 1));
            if remove.on_hover_text("Remove this point.").clicked() {
                removed = Some(k);
            }
        });
    }
    if let Some(k) = removed {
        points.remove(k);
        actions.push(Command::FinishEdit.into());
    }
}
