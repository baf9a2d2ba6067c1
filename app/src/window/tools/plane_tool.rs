//! The focal plane tool: the plane passes through the last three clicked points, each of which can be dragged.

use super::drag_tool::DragView;
use crate::window::Action;
use document::{Document, view_ray};
use egui::{Color32, Painter, Pos2, Stroke};
use focus::{Adjustment, FocalPlane, LayerEdit};
use session::{Command, Session};

/// Distance within which the pointer grabs a point, points.
const REACH: f32 = 10.0;

/// Radius of a point on screen, points.
const RADIUS: f32 = 6.0;

/// State of the tool: the point being dragged.
#[derive(Default)]
pub struct PlaneTool {
    held_point: Option<usize>,
}

impl PlaneTool {
    /// Whether a point is being dragged.
    pub fn is_holding(&self) -> bool {
        self.held_point.is_some()
    }

    /// Grabs the point at `at`, or places one there in place of the oldest.
    pub fn press(&mut self, session: &Session, view: &DragView<'_>, at: Pos2) -> Option<Action> {
        let (index, plane) = active_plane(session.document()?)?;
        let distance = |k: &usize| {
            let place = view.frame.position(plane.points[*k]);
            place.map_or(f32::INFINITY, |place| (view.screen)(place).distance(at))
        };
        let nearest = (0..3).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        self.held_point = nearest.filter(|k| distance(k) <= REACH);
        if self.held_point.is_some() {
            return None;
        }
        let hit = session.pick(&view_ray(&view.frame, (view.position)(at)))?;
        let [_, second, third] = plane.points;
        self.held_point = Some(2);
        let moved = FocalPlane { points: [second, third, hit.position], ..plane.clone() };
        Some(Command::EditLayers(LayerEdit::Plane(index, moved)).into())
    }

    /// Moves the grabbed point to the surface at `at`.
    pub fn drag(&self, session: &Session, view: &DragView<'_>, at: Pos2) -> Option<Action> {
        let (index, plane) = active_plane(session.document()?)?;
        let hit = session.pick(&view_ray(&view.frame, (view.position)(at)))?;
        let mut moved = plane.clone();
        moved.points[self.held_point?] = hit.position;
        // Three collinear points define no plane.
        moved.is_valid().then(|| Command::EditLayers(LayerEdit::Plane(index, moved)).into())
    }

    /// Releases the point: the next move is a separate undo step.
    pub fn release(&mut self) -> Action {
        self.held_point = None;
        Command::FinishEdit.into()
    }
}

/// The focal plane of the active layer, and the layer's index.
pub fn active_plane(document: &Document) -> Option<(usize, &FocalPlane)> {
    match &document.layers.active().adjustment {
        Some(Adjustment::Plane(plane)) => Some((document.layers.active_index(), plane)),
        _ => None,
    }
}

/// Draws the plane's points and the triangle between them.
pub fn paint(painter: &Painter, document: &Document, view: &DragView<'_>) {
    let Some((_, plane)) = active_plane(document) else { return };
    let places = plane.points.map(|point| view.frame.position(point).map(view.screen));
    let [dark, light] = [Stroke::new(3.0, Color32::from_black_alpha(150)), Stroke::new(1.0, Color32::WHITE)];
    for stroke in [dark, light] {
        for k in 0..3 {
            if let (Some(a), Some(b)) = (places[k], places[(k + 1) % 3]) {
                painter.line_segment([a, b], stroke);
            }
        }
    }
    for place in places.into_iter().flatten() {
        painter.circle(place, RADIUS, Color32::WHITE, Stroke::new(1.5, Color32::from_gray(20)));
    }
}
