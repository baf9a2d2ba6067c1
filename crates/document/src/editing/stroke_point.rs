//! Points of strokes and regions of fills, as picked in either view.

use crate::picking::SurfaceHit;
use focus::ViewFrame;
use glam::DVec2;
use project::StrokeView;
use trace::Ray;

/// A point of a stroke.
#[derive(Clone, Copy, Debug)]
pub struct StrokePoint {
    /// What the pointer is over.
    pub target: StrokeTarget,
    /// Pen pressure in [0, 1]; 1 for a mouse.
    pub pressure: f32,
}

/// What the pointer is over during a stroke, in either view.
#[derive(Clone, Copy, Debug)]
pub enum StrokeTarget {
    /// A ray of a view: its first hit is painted. A ray without a hit interrupts the stroke.
    Ray(Ray),
    /// A position in a view, (0, 0) upper left, (1, 1) lower right, used like [`Self::Ray`]. Such strokes are recorded.
    View(ViewFrame, DVec2),
    /// A position in the atlas, (0, 0) upper left, (1, 1) lower right; empty places interrupt the stroke. Such strokes are recorded.
    Atlas(DVec2),
}

impl StrokePoint {
    /// A point of a recorded stroke.
    pub fn from_recorded(view: &StrokeView, &[x, y, pressure]: &[f64; 3]) -> Self {
        let position = DVec2::new(x, y);
        let target = match view {
            StrokeView::Scene(view) => StrokeTarget::View(*view, position),
            StrokeView::Atlas { .. } => StrokeTarget::Atlas(position),
        };
        Self { target, pressure: pressure as f32 }
    }

    /// A mouse position, as a ray of a view, with full pressure.
    pub fn from_ray(ray: Ray) -> Self {
        Self { target: StrokeTarget::Ray(ray), pressure: 1.0 }
    }
}

/// The region that a fill or a selection covers, identified by a point on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FillRegion {
    /// The object: every part of the point's node.
    Node(SurfaceHit),
    /// The part: one primitive of the point's node.
    Part(SurfaceHit),
    /// Everything with the point's material.
    Material(SurfaceHit),
    /// The point's chart of the atlas.
    Chart(SurfaceHit),
    /// All surfaces.
    All,
}
