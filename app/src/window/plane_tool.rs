//! A focal plane placed by hand: it runs through the last three places that were clicked, and each can be dragged on.

use super::Action;
use super::drag_tool::DragView;
use egui::{Color32, Painter, Pos2, Stroke};
use focus::{Adjustment, FocalPlane, LayerEdit};
use session::{Command, Document, Session, view_ray};

/// How near the pointer must be to a point to take hold of it, points.
const REACH: f32 = 10.0;

/// Radius of a point on screen, points.
const RADIUS: f32 = 6.0;

/// The point of the plane in hand.
#[derive(Default)]
pub struct PlaneTool {
    held_point: Option<usize>,
}

impl PlaneTool {
    /// Whether a point is in hand.
    pub fn is_holding(&self) -> bool {
        self.held_point.is_some()
    }

    /// Takes hold of the point at `at`, or puts one there in the place of the oldest.
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

    /// Moves the point in hand over what lies at `at`.
    pub fn drag(&self, session: &Session, view: &DragView<'_>, at: Pos2) -> Option<Action> {
        let (index, plane) = active_plane(session.document()?)?;
        let hit = session.pick(&view_ray(&view.frame, (view.position)(at)))?;
        let mut moved = plane.clone();
        moved.points[self.held_point?] = hit.position;
        // On the way through the line of the other two there is no plane.
        moved.is_valid().then(|| Command::EditLayers(LayerEdit::Plane(index, moved)).into())
    }

    /// Lets go: the next move is a step of undo of its own.
    pub fn release(&mut self) -> Action {
        self.held_point = None;
        Command::FinishEdit.into()
    }
}

/// The focal plane of the layer that is painted on, and which layer that is.
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
