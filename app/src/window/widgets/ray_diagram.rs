//! Rays behind a lens, drawn in tooltips: where they meet, and where the picture is read.

use egui::{Color32, Pos2, Rect, Sense, Stroke, Ui, pos2, vec2};

/// The rays of one point. Distances behind the lens are in units of the sensor's, in (0, 1.4].
#[derive(Clone, Copy, Debug)]
pub struct Rays {
    /// What is written below.
    pub caption: &'static str,
    /// Where they meet.
    pub meet_at: f32,
    /// How far they travel before they are projected onto the sensor.
    pub read_at: f32,
}

/// What t does, with the lens as its anchor: rays are read before, where, or after they meet.
pub const OFFSETS: [Rays; 3] = [
    Rays { caption: "t below 1: near blur", meet_at: 1.0, read_at: 0.75 },
    Rays { caption: "t = 1: in focus", meet_at: 1.0, read_at: 1.0 },
    Rays { caption: "t above 1: far blur", meet_at: 1.0, read_at: 1.25 },
];

/// What the anchor does, with the same t: relative to the lens, points at other depths have other circles; relative to the point, all have
/// the same.
pub const ANCHORS: [Rays; 4] = [
    Rays { caption: "Lens, near", meet_at: 1.2, read_at: 0.8 },
    Rays { caption: "Lens, far", meet_at: 0.9, read_at: 0.8 },
    Rays { caption: "Point, near", meet_at: 1.2, read_at: 0.8 * 1.2 },
    Rays { caption: "Point, far", meet_at: 0.9, read_at: 0.8 * 0.9 },
];

const SIZE: egui::Vec2 = vec2(132.0, 76.0);
/// The lens, as shares of the drawing's width; the sensor, as a share, too.
const LENS_AT: f32 = 0.22;
const SENSOR_AT: f32 = 0.75;
/// Half the aperture, points.
const RADIUS: f32 = 24.0;

/// Words, and below them the rays of some points.
pub fn explanation(ui: &mut Ui, text: &str, points: &[Rays]) {
    ui.set_max_width(points.len() as f32 * (SIZE.x + ui.spacing().item_spacing.x));
    ui.label(text);
    ui.horizontal(|ui| {
        for rays in points {
            ui.vertical(|ui| {
                let (rect, _) = ui.allocate_exact_size(SIZE, Sense::hover());
                paint(ui, rect, *rays);
                ui.weak(rays.caption);
            });
        }
    });
}

fn paint(ui: &Ui, rect: Rect, Rays { meet_at, read_at, .. }: Rays) {
    let painter = ui.painter_at(rect);
    let visuals = ui.visuals();
    let (weak, ray) = (visuals.weak_text_color(), Color32::from_rgb(232, 190, 110));
    let axis = rect.center().y;
    let behind = |distance: f32| rect.left() + rect.width() * (LENS_AT + (SENSOR_AT - LENS_AT) * distance);
    let lens = behind(0.0);
    // The rays' height behind the lens.
    let height = |distance: f32| RADIUS * (1.0 - distance / meet_at);
    let end = read_at.max(meet_at).max(1.0) + 0.1;
    painter.hline(rect.x_range(), axis, Stroke::new(0.5, weak));
    painter.vline(behind(1.0), axis - RADIUS - 8.0..=axis + RADIUS + 8.0, Stroke::new(1.0, weak));
    for side in [-1.0, 1.0] {
        let at_lens = pos2(lens, axis + side * RADIUS);
        let source = pos2(rect.left() + 3.0, axis);
        painter.line_segment([source, at_lens], Stroke::new(1.0, ray));
        painter.line_segment([at_lens, pos2(behind(end), axis + side * height(end))], Stroke::new(1.0, ray));
    }
    painter.add(egui::Shape::ellipse_stroke(
        Pos2::new(lens, axis),
        vec2(4.0, RADIUS + 3.0),
        Stroke::new(1.5, visuals.text_color()),
    ));
    // What is read there is the circle of confusion.
    let circle = height(read_at).abs().max(1.5);
    let accent = Stroke::new(4.0, visuals.selection.bg_fill);
    painter.vline(behind(read_at), axis - circle..=axis + circle, accent);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn circle(rays: &Rays) -> f32 {
        1.0 - rays.read_at / rays.meet_at
    }

    #[test]
    fn drawings_say_what_the_formula_does() {
        let offsets = OFFSETS.each_ref().map(circle);
        assert!(offsets[0] > 0.0 && offsets[1] == 0.0 && offsets[2] < 0.0);
        let [lens_near, lens_far, point_near, point_far] = ANCHORS.each_ref().map(circle);
        assert!((lens_near - lens_far).abs() > 0.1 && (point_near - point_far).abs() < 1e-6);
        assert!(OFFSETS.iter().chain(&ANCHORS).all(|rays| rays.read_at.max(rays.meet_at) <= 1.4));
    }
}
