//! Icons: line drawings on a grid of 16 × 16 units, in the colour of the text beside them.
//!
//! They are strokes instead of pictures, so that they are sharp at every scale and follow the theme.

mod drawings;

pub use drawings::Icon;

use drawings::Mark;
use egui::{Color32, Painter, Pos2, Rect, Response, Sense, Stroke, Ui, Vec2, pos2};

/// Side of the grid that icons are drawn on, units.
const GRID: f32 = 16.0;

/// Width of a stroke, units.
const STROKE: f32 = 1.35;

/// Points of a full circle.
const CIRCLE_POINTS: usize = 24;

impl Icon {
    /// Draws the icon into the largest square in the middle of `rect`.
    pub fn paint(self, painter: &Painter, rect: Rect, color: Color32) {
        let unit = rect.width().min(rect.height()) / GRID;
        let origin = rect.center() - Vec2::splat(GRID / 2.0 * unit);
        let place = |[x, y]: [f32; 2]| origin + unit * Vec2::new(x, y);
        let places = |points: &[[f32; 2]]| points.iter().copied().map(place).collect::<Vec<Pos2>>();
        let stroke = Stroke::new(STROKE * unit, color);
        for mark in self.marks() {
            match *mark {
                Mark::Line(points) => painter.line(places(points), stroke),
                Mark::Loop(points) => painter.add(egui::Shape::closed_line(places(points), stroke)),
                Mark::Area(points) => {
                    painter.add(egui::Shape::convex_polygon(places(points), color, Stroke::NONE))
                }
                Mark::Ring(center, radius) => painter.circle_stroke(place(center), radius * unit, stroke),
                Mark::Disc(center, radius) => painter.circle_filled(place(center), radius * unit, color),
                Mark::Arc(center, radius, degrees) => painter.line(
                    arc(center, radius, degrees).map(|[x, y]| place([x, y])).collect::<Vec<_>>(),
                    stroke,
                ),
            };
        }
    }
}

/// Points of a part of a circle.
fn arc([x, y]: [f32; 2], radius: f32, [from, to]: [f32; 2]) -> impl Iterator<Item = [f32; 2]> {
    let steps = ((to - from).abs() / 360.0 * CIRCLE_POINTS as f32).ceil().max(2.0) as usize;
    (0..=steps).map(move |step| {
        let (sine, cosine) = (from + (to - from) * step as f32 / steps as f32).to_radians().sin_cos();
        [x + radius * cosine, y + radius * sine]
    })
}

/// Share of a button's height that its icon takes.
const ICON_SHARE: f32 = 0.56;

/// A button of an icon with the accessible name `name`; `chosen` fills it.
pub fn icon_button(ui: &mut Ui, icon: Icon, name: &str, chosen: bool, size: Vec2) -> Response {
    let (rect, response) = button_frame(ui, name, chosen, size);
    let color = ui.style().interact_selectable(&response, chosen).text_color();
    icon_in(ui.painter(), icon, rect, size.min_elem() * ICON_SHARE, color);
    response
}

/// The same with the name beside the icon.
pub fn labelled_icon_button(ui: &mut Ui, icon: Icon, name: &str, chosen: bool, size: Vec2) -> Response {
    let (rect, response) = button_frame(ui, name, chosen, size);
    let color = ui.style().interact_selectable(&response, chosen).text_color();
    let square = Rect::from_min_size(rect.min, Vec2::splat(size.y));
    icon_in(ui.painter(), icon, square, size.y * ICON_SHARE, color);
    let font = egui::TextStyle::Button.resolve(ui.style());
    ui.painter().text(square.right_center(), egui::Align2::LEFT_CENTER, name, font, color);
    response
}

/// The frame of a button: filled where it is chosen, under the pointer or has the keyboard.
fn button_frame(ui: &mut Ui, name: &str, chosen: bool, size: Vec2) -> (Rect, Response) {
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    let is_enabled = ui.is_enabled();
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, is_enabled, chosen, name));
    let visuals = ui.style().interact_selectable(&response, chosen);
    if chosen || response.hovered() || response.has_focus() {
        ui.painter().rect(
            rect,
            visuals.corner_radius,
            visuals.weak_bg_fill,
            visuals.bg_stroke,
            egui::StrokeKind::Inside,
        );
    }
    (rect, response)
}

/// Draws an icon of `side` points in the middle of `rect`.
fn icon_in(painter: &Painter, icon: Icon, rect: Rect, side: f32, color: Color32) {
    let middle = pos2(rect.center().x.round(), rect.center().y.round());
    icon.paint(painter, Rect::from_center_size(middle, Vec2::splat(side)), color);
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Icon; 36] = {
        use Icon::*;
        [
            Brush,
            Curve,
            Smooth,
            Sharpen,
            Clone,
            Reset,
            Fill,
            FillMaterial,
            FillChart,
            SharpHere,
            Gradient,
            FocalPlane,
            DepthSpread,
            DepthNearer,
            DepthFarther,
            DepthSmooth,
            Lasso,
            SelectBox,
            SelectObject,
            SelectMaterial,
            SelectChart,
            SelectFacing,
            SelectDepth,
            SelectSimilar,
            FocusHere,
            RackFocus,
            Fixate,
            Pick,
            Inspect,
            Duplicate,
            Delete,
            MoveUp,
            MoveDown,
            Visible,
            Hidden,
            Enlarge,
        ]
    };

    /// Points that a mark passes through.
    fn outline(mark: &Mark) -> Vec<[f32; 2]> {
        match *mark {
            Mark::Line(points) | Mark::Loop(points) | Mark::Area(points) => points.to_vec(),
            Mark::Ring(center, radius) | Mark::Disc(center, radius) => {
                arc(center, radius, [0.0, 360.0]).collect()
            }
            Mark::Arc(center, radius, degrees) => arc(center, radius, degrees).collect(),
        }
    }

    #[test]
    fn every_drawing_fills_its_grid_and_stays_within() {
        for icon in ALL {
            let points: Vec<_> = icon.marks().iter().flat_map(outline).collect();
            let side = |axis: usize| {
                let values = || points.iter().map(move |point| point[axis]);
                let (low, high) = (values().fold(f32::MAX, f32::min), values().fold(f32::MIN, f32::max));
                assert!(low >= 0.5 && high <= 15.5, "{icon:?}: {low} to {high}");
                high - low
            };
            assert!(side(0).max(side(1)) >= 8.0, "{icon:?} is too small to be recognised");
        }
    }

    #[test]
    fn no_two_icons_look_the_same() {
        let drawn = |icon: Icon| icon.marks().iter().flat_map(outline).collect::<Vec<_>>();
        for (at, icon) in ALL.into_iter().enumerate() {
            for other in ALL.into_iter().skip(at + 1) {
                assert_ne!(drawn(icon), drawn(other), "{icon:?} and {other:?}");
            }
        }
    }
}
