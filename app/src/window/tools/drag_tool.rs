//! Tools that are dragged across a view: gradients, selections and depth repair.

use super::tool_settings::ToolSettings;
use crate::window::{Action, Tool};
use document::{SurfaceHit, rectangle_outline, view_ray};
use egui::{Color32, Modifiers, Painter, Pos2, Shape, Stroke};
use focus::{CombineMode, Gradient, GradientLine, ViewFrame};
use glam::DVec2;
use project::SelectionShape;
use session::{Command, Session};

/// A shorter movement is a click, not a drag, points.
const MIN_DRAG_POINTS: f32 = 3.0;

/// Relative rounding error of depths: positions in files are 32-bit floats.
const DEPTH_ROUNDING: f64 = 1e-6;

/// A drag in progress.
pub struct Drag {
    tool: Tool,
    combine: CombineMode,
    path: Vec<Pos2>,
    /// The surface points under both ends.
    hits: [Option<SurfaceHit>; 2],
}

/// The view in which the pointer is dragged.
pub struct DragView<'a> {
    /// Its camera.
    pub frame: ViewFrame,
    /// Maps a screen position to a position in the view.
    pub position: &'a dyn Fn(Pos2) -> DVec2,
    /// Maps a position in the view to the screen.
    pub screen: &'a dyn Fn(DVec2) -> Pos2,
}

impl Drag {
    /// Starts a drag.
    pub fn begin(tool: Tool, modifiers: Modifiers, at: Pos2, session: &Session, view: &DragView<'_>) -> Self {
        let hit = session.pick(&view_ray(&view.frame, (view.position)(at)));
        Self { tool, combine: combine(modifiers), path: vec![at], hits: [hit; 2] }
    }

    /// Continues the drag to `at`. Returns the action that previews it, if any.
    pub fn extend(
        &mut self,
        at: Pos2,
        session: &Session,
        settings: &ToolSettings,
        view: &DragView<'_>,
    ) -> Option<Action> {
        if self.path.last() == Some(&at) {
            return None;
        }
        if self.follows_pointer() || self.path.len() < 2 {
            self.path.push(at);
        } else {
            self.path[1] = at;
        }
        let hit = session.pick(&view_ray(&view.frame, (view.position)(at)));
        self.hits[1] = hit.or(self.hits[1]);
        if self.tool != Tool::Gradient || self.length() < MIN_DRAG_POINTS {
            return None;
        }
        let line = match (settings.gradient.in_world, self.hits) {
            (true, [Some(a), Some(b)]) => GradientLine::World([a.position, b.position]),
            (true, _) => return None,
            (false, _) => GradientLine::View(view.frame, self.ends().map(view.position)),
        };
        let document = session.document()?;
        let from = document.brush.target;
        let to = settings.gradient.end_focus().map(|to| to.with_gloss(from.gloss));
        let symmetry = document.symmetry_at(self.hits[0].as_ref());
        let gradient = Gradient { shape: settings.gradient.shape, line, from, to, symmetry };
        gradient.is_valid().then(|| Command::DragGradient(gradient).into())
    }

    /// Ends the drag. Returns the resulting action, if any.
    pub fn end(self, session: &Session, settings: &ToolSettings, view: &DragView<'_>) -> Option<Action> {
        let (frame, through) = (view.frame, settings.select_through);
        if let Some(repair) = self.tool.depth_repair() {
            let document = session.document()?;
            let pick = |at: &Pos2| session.pick(&view_ray(&frame, (view.position)(*at)));
            let hits: Vec<SurfaceHit> = self.path.iter().filter_map(pick).collect();
            return document.depth_stroke(repair, &hits).map(|stroke| Command::RepairDepth(stroke).into());
        }
        let shape = match self.tool {
            Tool::Gradient => return Some(Command::CommitStroke.into()),
            _ if self.length() < MIN_DRAG_POINTS => return None,
            Tool::SelectBox => rectangle_outline(frame, self.ends().map(view.position), through),
            Tool::SelectLasso => {
                let points = self.path.iter().map(|&at| (view.position)(at)).collect();
                SelectionShape::Outline { view: frame, points, through }
            }
            Tool::SelectDepth => {
                let camera = &session.document()?.camera;
                let [Some(a), Some(b)] = self.hits else { return None };
                let [a, b] = [a, b].map(|hit| camera.camera_from_world(hit.position).z);
                let axis = camera.world_direction(glam::DVec3::Z);
                // The range must include the picked points despite rounding.
                let range = [a.min(b) * (1.0 - DEPTH_ROUNDING), a.max(b) * (1.0 + DEPTH_ROUNDING)];
                SelectionShape::Depth { origin: camera.position(), axis, range }
            }
            _ => return None,
        };
        Some(Command::Select(shape, self.combine).into())
    }

    /// Draws the drag.
    pub fn paint(&self, painter: &Painter) {
        let dark = Stroke::new(3.0, Color32::from_black_alpha(150));
        let light = Stroke::new(1.0, Color32::WHITE);
        let [a, b] = self.ends();
        for stroke in [dark, light] {
            match self.tool {
                Tool::SelectBox => {
                    let kind = egui::StrokeKind::Middle;
                    painter.rect_stroke(egui::Rect::from_two_pos(a, b), 0.0, stroke, kind);
                }
                Tool::SelectLasso => {
                    painter.add(Shape::closed_line(self.path.clone(), stroke));
                }
                _ if self.follows_pointer() => {
                    painter.add(Shape::line(self.path.clone(), stroke));
                }
                _ => {
                    painter.line_segment([a, b], stroke);
                }
            }
        }
        if matches!(self.tool, Tool::Gradient | Tool::SelectDepth) {
            painter.circle(a, 5.0, Color32::WHITE, Stroke::new(1.0, Color32::from_gray(20)));
            painter.circle(b, 5.0, Color32::from_gray(20), light);
        }
    }

    /// Whether the whole path counts, not only its ends.
    fn follows_pointer(&self) -> bool {
        self.tool == Tool::SelectLasso || self.tool.depth_repair().is_some()
    }

    fn ends(&self) -> [Pos2; 2] {
        [self.path[0], self.path[self.path.len() - 1]]
    }

    /// The largest distance from the start, points.
    fn length(&self) -> f32 {
        self.path.iter().map(|at| at.distance(self.path[0])).fold(0.0, f32::max)
    }
}

/// How a selection made with these modifier keys combines with the current one.
pub fn combine(modifiers: Modifiers) -> CombineMode {
    match (modifiers.shift, modifiers.command) {
        (true, true) => CombineMode::Intersect,
        (true, false) => CombineMode::Add,
        (false, true) => CombineMode::Subtract,
        (false, false) => CombineMode::Replace,
    }
}
