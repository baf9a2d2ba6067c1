//! Where a stroke goes, and what a fill covers, as either view points at it.

use crate::picking::SurfaceHit;
use focus::ViewFrame;
use glam::DVec2;
use project::StrokeView;
use trace::Ray;

/// Where the pointer is during a stroke.
#[derive(Clone, Copy, Debug)]
pub struct StrokePoint {
    /// Where.
    pub target: StrokeTarget,
    /// Pen pressure in [0, 1]; 1 for a mouse.
    pub pressure: f32,
}

/// A stroke's place, from either view.
#[derive(Clone, Copy, Debug)]
pub enum StrokeTarget {
    /// A ray from a view; what it meets is painted. A ray that meets nothing interrupts the stroke.
    Ray(Ray),
    /// A position in a view ((0, 0) upper left, (1, 1) lower right), as [`Self::Ray`]. Such strokes are recorded.
    View(ViewFrame, DVec2),
    /// A position in the atlas laid flat ((0, 0) upper left, (1, 1) lower right); where no surface is, the stroke is
    /// interrupted. Such strokes are recorded.
    Atlas(DVec2),
    /// A point that was picked already.
    Surface(SurfaceHit),
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

    /// A mouse position, as a ray of a view.
    pub fn from_ray(ray: Ray) -> Self {
        Self { target: StrokeTarget::Ray(ray), pressure: 1.0 }
    }

    /// A picked surface point.
    pub fn from_surface(hit: SurfaceHit) -> Self {
        Self { target: StrokeTarget::Surface(hit), pressure: 1.0 }
    }
}

/// What a fill or a selection covers, named by a point on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FillRegion {
    /// The object: every part of the point's node.
    Node(SurfaceHit),
    /// The primitive of the point's node.
    Part(SurfaceHit),
    /// Everything of the point's material.
    Material(SurfaceHit),
    /// The connected piece of the atlas.
    Chart(SurfaceHit),
    /// All surfaces.
    All,
}
