//! Strokes along a curve through clicked points.

use egui::{Color32, Painter, Pos2, Shape, Stroke};

/// Line segments between two clicked points.
const SEGMENTS_PER_SPAN: usize = 24;

/// The clicked points of a curve in progress.
#[derive(Default)]
pub struct CurveStroke {
    points: Vec<Pos2>,
}

impl CurveStroke {
    /// Adds a point. Returns false, and adds nothing, if it coincides with the last one (a double click).
    pub fn add(&mut self, at: Pos2) -> bool {
        let is_new = self.points.last().is_none_or(|last| last.distance(at) > 2.0);
        if is_new {
            self.points.push(at);
        }
        is_new
    }

    /// Whether there are no points yet.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Clears the points and returns the curve through them.
    pub fn finish(&mut self) -> Vec<Pos2> {
        interpolated_curve(&std::mem::take(&mut self.points))
    }

    /// Clears the points.
    pub fn cancel(&mut self) {
        self.points.clear();
    }

    /// Draws the curve up to the pointer.
    pub fn paint(&self, painter: &Painter, pointer: Option<Pos2>) {
        if self.is_empty() {
            return;
        }
        let line = interpolated_curve(&self.points.iter().copied().chain(pointer).collect::<Vec<_>>());
        painter.add(Shape::line(line.clone(), Stroke::new(3.0, Color32::from_black_alpha(150))));
        painter.add(Shape::line(line, Stroke::new(1.0, Color32::WHITE)));
        for point in &self.points {
            painter.circle(*point, 4.0, Color32::WHITE, Stroke::new(1.0, Color32::from_gray(20)));
        }
    }
}

/// The Catmull-Rom spline through the points (Catmull and Rom 1974): a cubic per span; the tangent at each
/// point is half the vector between its neighbours.
fn interpolated_curve(points: &[Pos2]) -> Vec<Pos2> {
    let at = |k: isize| points[k.clamp(0, points.len() as isize - 1) as usize].to_vec2();
    let mut curve: Vec<Pos2> = points.first().copied().into_iter().collect();
    for k in 0..points.len().saturating_sub(1) as isize {
        let [before, a, b, after] = [k - 1, k, k + 1, k + 2].map(at);
        let (slope_a, slope_b) = ((b - before) / 2.0, (after - a) / 2.0);
        for piece in 1..=SEGMENTS_PER_SPAN {
            let s = piece as f32 / SEGMENTS_PER_SPAN as f32;
            let (s2, s3) = (s * s, s * s * s);
            let place = a * (2.0 * s3 - 3.0 * s2 + 1.0)
                + slope_a * (s3 - 2.0 * s2 + s)
                + b * (3.0 * s2 - 2.0 * s3)
                + slope_b * (s3 - s2);
            curve.push(place.to_pos2());
        }
    }
    curve
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::pos2;

    #[test]
    fn the_curve_interpolates_its_points_and_collinear_points_give_a_line() {
        let points = [pos2(0.0, 0.0), pos2(10.0, 20.0), pos2(30.0, 20.0), pos2(40.0, 0.0)];
        let curve = interpolated_curve(&points);
        for point in points {
            assert!(curve.iter().any(|at| at.distance(point) < 1e-3), "{point}");
        }
        let highest = curve.iter().map(|at| at.y).fold(0.0, f32::max);
        assert!(highest > 20.5, "round between the upper two: {highest}");
        let straight_curve = interpolated_curve(&[pos2(0.0, 5.0), pos2(10.0, 5.0), pos2(20.0, 5.0)]);
        assert!(straight_curve.iter().all(|at| (at.y - 5.0).abs() < 1e-4));
        assert_eq!(interpolated_curve(&[]).len(), 0);
        let mut curve = CurveStroke::default();
        assert!(curve.add(pos2(1.0, 1.0)) && !curve.add(pos2(2.0, 1.0)), "a double click is one point");
    }
}
