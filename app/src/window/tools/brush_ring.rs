//! The brush cursor on the surface: a ring in world space around the point under the pointer, in its tangent
//! plane.

use crate::window::widgets::false_colour;
use document::SurfaceHit;
use egui::{Color32, Painter, Pos2, Shape, Stroke};
use glam::DVec3;

/// Segments of the ring.
const CORNERS: usize = 72;

/// The properties of the brush that the ring shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BrushRing {
    /// Radius, world units.
    pub radius: f64,
    /// Share of the radius with full strength.
    pub hardness: f64,
    /// The painted blur as a signed circle of confusion, px: colours the centre.
    pub circle_px: f64,
    /// Normal of the ring, if it differs from the surface's normal.
    pub facing: Option<DVec3>,
}

/// World positions of a ring around `center` in the plane with the given normal.
pub fn ring_points(center: DVec3, normal: DVec3, radius: f64) -> impl Iterator<Item = DVec3> {
    let normal = if normal == DVec3::ZERO { DVec3::Z } else { normal };
    let (u, v) = normal.any_orthonormal_pair();
    (0..=CORNERS).map(move |k| {
        let (sin, cos) = (std::f64::consts::TAU * k as f64 / CORNERS as f64).sin_cos();
        center + (u * cos + v * sin) * radius
    })
}

/// Draws the ring with a dark edge, so that it is visible on any colour. `project` maps a world point to the
/// screen.
pub fn paint(painter: &Painter, hit: &SurfaceHit, ring: BrushRing, project: impl Fn(DVec3) -> Option<Pos2>) {
    let line = |radius: f64, width: f32, color: Color32| {
        let mut run = Vec::new();
        let mut shapes = Vec::new();
        // Points behind the eye interrupt the line.
        for point in ring_points(hit.position, ring.facing.unwrap_or(hit.normal), radius).map(&project) {
            match point {
                Some(point) => run.push(point),
                None => shapes.push(Shape::line(std::mem::take(&mut run), Stroke::new(width, color))),
            }
        }
        shapes.push(Shape::line(run, Stroke::new(width, color)));
        painter.extend(
            shapes.into_iter().filter(|shape| !matches!(shape, Shape::Path(path) if path.points.len() < 2)),
        );
    };
    line(ring.radius, 3.5, Color32::from_black_alpha(150));
    line(ring.radius, 1.5, Color32::WHITE);
    if ring.hardness > 0.02 && ring.hardness < 0.98 {
        line(ring.radius * ring.hardness, 1.0, Color32::from_white_alpha(90));
    }
    if let Some(center) = project(hit.position) {
        painter.circle(
            center,
            3.5,
            false_colour::color(ring.circle_px),
            Stroke::new(1.0, Color32::from_gray(20)),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    #[test]
    fn the_ring_lies_on_the_tangent_plane() {
        let point = scene::SurfacePoint { triangle: 0, barycentric: DVec2::ZERO };
        let normal = DVec3::new(1.0, 2.0, -0.5).normalize();
        let hit = SurfaceHit { point, position: DVec3::new(3.0, 0.0, 1.0), normal, distance: 1.0 };
        let points: Vec<_> = ring_points(hit.position, hit.normal, 0.7).collect();
        for p in &points {
            assert!(((*p - hit.position).length() - 0.7).abs() < 1e-12);
            assert!((*p - hit.position).dot(normal).abs() < 1e-12);
        }
        assert!(points[0].distance(points[CORNERS]) < 1e-12, "closed");
    }
}
