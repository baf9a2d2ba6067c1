//! Lines over the picture that help to compose it: the frame with its thirds, and where the focus plane cuts the scene.

use crate::window::ViewSettings;
use egui::{Color32, Painter, Pos2, Rect, Stroke, StrokeKind, Vec2, pos2, vec2};
use lens::Camera;
use session::Session;

/// Columns and rows of the grid on which the focus plane is sought.
const GRID: [usize; 2] = [97, 55];
/// A surface is cut by the focus plane between two points whose reciprocal depths are both this close to its own; beyond, one point hides
/// the other.
const NEAR: f64 = 0.15;

/// Colour of the focus plane's line.
const FOCUS_COLOR: Color32 = Color32::from_rgb(90, 230, 140);

/// The guides, with the line of the focus plane as it was found last.
#[derive(Default)]
pub struct Guides {
    /// The line, as shares of the picture's width and height.
    line: Vec<[Vec2; 2]>,
    /// What it was found for: the camera, and the surface as its address in memory.
    line_key: Option<(Camera, usize)>,
}

impl Guides {
    /// Draws what is chosen over the picture at `image`.
    pub fn paint(&mut self, painter: &Painter, image: Rect, session: &Session, settings: &ViewSettings) {
        if settings.guides {
            paint_thirds(painter, image);
        }
        if settings.focus_plane {
            self.find_line(session);
            let place = |share: Vec2| image.min + share * image.size();
            for &[from, to] in &self.line {
                let ends = [place(from), place(to)];
                painter.line_segment(ends, Stroke::new(3.0, Color32::from_black_alpha(110)));
                painter.line_segment(ends, Stroke::new(1.5, FOCUS_COLOR));
            }
        }
    }

    /// Finds the line again if the camera or the surface changed.
    fn find_line(&mut self, session: &Session) {
        let Some(document) = session.document() else { return };
        let key = Some((document.camera.clone(), std::sync::Arc::as_ptr(&document.stage) as usize));
        if self.line_key == key {
            return;
        }
        let inverse_focus = document.camera.optics().inverse_focus_distance;
        let depths = session.depth_grid(GRID).unwrap_or_default();
        let values: Vec<f64> = depths.iter().map(|depth| (1.0 / depth) / inverse_focus - 1.0).collect();
        self.line = if inverse_focus > 0.0 { zero_line(&values, GRID) } else { Vec::new() };
        self.line_key = key;
    }
}

/// The line on which values at a grid of [columns, rows] points over the unit square are zero, as far as it crosses no jump of them.
fn zero_line(values: &[f64], [columns, rows]: [usize; 2]) -> Vec<[Vec2; 2]> {
    let at = |x: usize, y: usize| values[y * columns + x];
    let place = |x: usize, y: usize| vec2(x as f32 / (columns - 1) as f32, y as f32 / (rows - 1) as f32);
    let crossing = |[a, b]: [(usize, usize); 2]| {
        let (from, to) = (at(a.0, a.1), at(b.0, b.1));
        let is_cut = (from < 0.0) != (to < 0.0) && from.abs() < NEAR && to.abs() < NEAR;
        is_cut.then(|| place(a.0, a.1) + (place(b.0, b.1) - place(a.0, a.1)) * (from / (from - to)) as f32)
    };
    let mut line = Vec::new();
    for y in 0..rows - 1 {
        for x in 0..columns - 1 {
            // Marching triangles: two for each square, so that no case is ambiguous.
            let [a, b, c, d] = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)];
            for [a, b, c] in [[a, b, c], [a, c, d]] {
                let ends: Vec<Vec2> = [[a, b], [b, c], [c, a]].into_iter().filter_map(crossing).collect();
                if let [from, to] = ends[..] {
                    line.push([from, to]);
                }
            }
        }
    }
    line
}

/// The frame, its thirds and its middle.
fn paint_thirds(painter: &Painter, image: Rect) {
    let at = |x: f32, y: f32| -> Pos2 { image.min + vec2(x, y) * image.size() };
    let draw = |stroke: Stroke| {
        painter.rect_stroke(image, 0.0, stroke, StrokeKind::Inside);
        for share in [1.0 / 3.0, 2.0 / 3.0] {
            painter.line_segment([at(share, 0.0), at(share, 1.0)], stroke);
            painter.line_segment([at(0.0, share), at(1.0, share)], stroke);
        }
        let (middle, arm) = (image.center(), 8.0);
        painter.line_segment([pos2(middle.x - arm, middle.y), pos2(middle.x + arm, middle.y)], stroke);
        painter.line_segment([pos2(middle.x, middle.y - arm), pos2(middle.x, middle.y + arm)], stroke);
    };
    draw(Stroke::new(2.5, Color32::from_black_alpha(60)));
    draw(Stroke::new(1.0, Color32::from_white_alpha(120)));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slope_is_cut_once_and_a_jump_never() {
        let slope: Vec<f64> = (0..12).map(|k| 0.05 * f64::from(k % 4) - 0.06).collect();
        let line = zero_line(&slope, [4, 3]);
        assert!(!line.is_empty());
        assert!(line.iter().flatten().all(|end| (end.x - 0.4).abs() < 1e-6), "{line:?}");
        let length: f32 = line.iter().map(|[from, to]| (*to - *from).length()).sum();
        assert!((length - 1.0).abs() < 1e-6, "from top to bottom: {length}");
        let jump: Vec<f64> = (0..12).map(|k| if k % 4 < 2 { -0.9 } else { 0.05 }).collect();
        assert!(zero_line(&jump, [4, 3]).is_empty());
        let nothing = [f64::NAN, -1.0, 0.1, -1.0];
        assert!(zero_line(&nothing, [2, 2]).is_empty());
    }
}
