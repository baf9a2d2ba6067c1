//! Pointer input of the views: strokes, drags and clicks of the active tool, the same in both views.
//!
//! Strokes are given as pen positions in the view, so that they can be recorded and replayed.

use super::active_tool::{ActiveTool, click_action};
use super::curve_stroke::CurveStroke;
use super::drag_tool::{Drag, DragView, combine};
use super::navigation;
use super::plane_tool::{self, PlaneTool};
use crate::window::{Action, Tool};
use document::{StrokePoint, StrokeTarget};
use egui::{Event, Modifiers, PointerButton, Pos2, Response, Ui};
use focus::ViewFrame;
use glam::DVec3;
use project::SelectionShape;
use session::{Command, Session};

/// Distance between the points of a straight line, screen points.
const LINE_STEP_POINTS: f32 = 4.0;

/// The input state of one view.
#[derive(Default)]
pub struct StrokeInput {
    painting: bool,
    /// The drag in progress, for tools that are dragged.
    drag: Option<Drag>,
    /// The curve in progress.
    curve: CurveStroke,
    /// State of the focal plane tool.
    plane: PlaneTool,
    /// Source of cloning, until the first stroke sets the target.
    clone_from: Option<DVec3>,
    /// Position of the brush, behind the pointer on the stabiliser's string.
    brush: Option<Pos2>,
    /// End of the last stroke and its view: a straight line may start there.
    last_end: Option<(ViewFrame, Pos2)>,
}

impl StrokeInput {
    /// Turns the left button on `response` into strokes and clicks in `view`.
    pub fn update(
        &mut self,
        ui: &Ui,
        response: &Response,
        session: &Session,
        active_tool: &ActiveTool,
        view: &DragView<'_>,
    ) -> Vec<Action> {
        let mut actions = Vec::new();
        if session.document().is_none() || active_tool.is_adjusting_brush {
            return actions;
        }
        // Position and modifiers of the press event itself: a frame may contain several events, even a whole
        // click.
        let pressed = ui.input(|input| {
            let press = |event: &Event| match event {
                Event::PointerButton { button: PointerButton::Primary, pressed: true, modifiers, pos } => {
                    Some((*modifiers, *pos))
                }
                _ => None,
            };
            input.events.iter().find_map(press)
        });
        let down = ui.input(|input| input.pointer.primary_down());
        let pressure = ui.input(|input| pen_pressure(&input.events));
        let frame = view.frame;
        let point = |at| StrokePoint { target: StrokeTarget::View(frame, (view.position)(at)), pressure };
        let dragged_to = || response.interact_pointer_pos().filter(|_| response.dragged());
        if self.plane.is_holding() {
            actions.extend(dragged_to().and_then(|at| self.plane.drag(session, view, at)));
            actions.extend((!down).then(|| self.plane.release()));
            return actions;
        }
        if let Some(drag) = &mut self.drag {
            if ui.input(|input| input.key_pressed(egui::Key::Escape)) {
                self.drag = None;
                return actions;
            }
            if let Some(at) = dragged_to() {
                actions.extend(drag.extend(at, session, &active_tool.settings, view));
            }
            if !down && let Some(drag) = self.drag.take() {
                actions.extend(drag.end(session, &active_tool.settings, view));
            }
            return actions;
        }
        if active_tool.tool == Tool::Curve {
            self.end_curve(ui, response, point, &mut actions);
        } else {
            self.curve.cancel();
        }
        if self.painting && !session.is_painting() {
            // The stroke was aborted by Esc or undo: the rest of the drag does not paint.
            self.painting = false;
        }
        let is_for_tool = |modifiers: &Modifiers| {
            let uses_command_key = active_tool.tool.selects() || active_tool.tool == Tool::Clone;
            !navigation::claims_primary(ui.ctx(), *modifiers) && (uses_command_key || !modifiers.command)
        };
        let is_here = response.is_pointer_button_down_on() || response.clicked();
        let start = pressed.filter(|(modifiers, _)| is_for_tool(modifiers) && is_here);
        if let Some((modifiers, at)) = start {
            response.request_focus();
            self.press(session, active_tool, (modifiers, at), view, point, &mut actions);
            return actions;
        }
        if !self.painting {
            return actions;
        }
        // All motion events of the frame, so that fast strokes stay smooth.
        let moves = ui.input(|input| {
            let moved = |event: &Event| match event {
                Event::PointerMoved(position) => Some(*position),
                _ => None,
            };
            input.events.iter().filter_map(moved).collect::<Vec<_>>()
        });
        for pointer in moves {
            let at = pulled_by_string(self.brush, pointer, active_tool.stabiliser_points);
            if Some(at) != self.brush {
                actions.push(Command::ExtendStroke(point(at)).into());
                self.brush = Some(at);
            }
        }
        if !down {
            actions.push(Command::CommitStroke.into());
            self.painting = false;
            self.last_end = self.brush.map(|end| (frame, end));
        }
        actions
    }
}

impl StrokeInput {
    /// Handles a press: starts a stroke, a drag or a point of a curve, or performs the click of the tool.
    fn press(
        &mut self,
        session: &Session,
        active_tool: &ActiveTool,
        (modifiers, at): (Modifiers, Pos2),
        view: &DragView,
        point: impl Fn(Pos2) -> StrokePoint,
        actions: &mut Vec<Action>,
    ) {
        let Some(document) = session.document() else { return };
        let tool = active_tool.tool;
        let hit = || active_tool.pick(session, view, at);
        if tool == Tool::Curve {
            self.curve.add(at);
        } else if tool == Tool::Clone && modifiers.command {
            self.clone_from = hit().map(|hit| hit.position).or(self.clone_from);
        } else if tool.paints() {
            let mut brush = document.brush.clone();
            brush.mode = tool.mode(brush.mode);
            if let Some((from, to)) = self.clone_from.take_if(|_| tool == Tool::Clone).zip(hit()) {
                brush.clone_offset = (from - to.position).to_array();
            }
            if tool == Tool::Clone && brush.clone_offset == [0.0; 3] {
                let what = "Clone: no source yet (Ctrl+click a point to take its focus first)";
                actions.push(Action::ShowError(what.into()));
                return;
            }
            if brush != document.brush {
                actions.push(Command::SetBrush(brush).into());
            }
            let line = modifiers.shift;
            let from = self
                .last_end
                .filter(|(last_frame, _)| line && *last_frame == view.frame)
                .map_or(at, |(_, end)| end);
            actions.push(Command::BeginStroke(point(from)).into());
            let steps = (from.distance(at) / LINE_STEP_POINTS).ceil();
            for k in 1..=steps as u32 {
                let along = from.lerp(at, k as f32 / steps);
                actions.push(Command::ExtendStroke(point(along)).into());
            }
            self.painting = true;
            self.brush = Some(at);
        } else if tool == Tool::FocalPlane {
            if plane_tool::active_plane(document).is_none() {
                let what = "The active layer is not a focal plane: choose or add one in Layers.";
                actions.push(Action::ShowError(what.into()));
            }
            actions.extend(self.plane.press(session, view, at));
        } else if tool.drags() {
            self.drag = Some(Drag::begin(tool, modifiers, at, session, view));
        } else if let Some(hit) = hit() {
            let target = document.brush.target;
            let front = document.scene().area_normal(hit.point.triangle).normalize_or_zero();
            let facing =
                SelectionShape::Normal { normal: front, degrees: active_tool.settings.facing_degrees };
            let similar = active_tool.settings.similar.shape_at(hit.position, &view.frame);
            actions.extend(click_action(tool, hit, target, [facing, similar], combine(modifiers)));
        }
    }

    /// Finishes a curve with a stroke along it on Enter or a double click; Esc cancels it.
    fn end_curve(
        &mut self,
        ui: &Ui,
        response: &Response,
        point: impl Fn(Pos2) -> StrokePoint,
        actions: &mut Vec<Action>,
    ) {
        let pressed = |key| ui.input(|input| input.key_pressed(key));
        if pressed(egui::Key::Escape) {
            self.curve.cancel();
        }
        if !self.curve.is_empty() && (pressed(egui::Key::Enter) || response.double_clicked()) {
            let curve = self.curve.finish();
            actions.extend(curve.first().map(|&at| Command::BeginStroke(point(at)).into()));
            actions.extend(curve.iter().skip(1).map(|&at| Command::ExtendStroke(point(at)).into()));
            actions.push(Command::CommitStroke.into());
        }
    }

    /// Draws the state of the active tool.
    pub fn paint(
        &self,
        ui: &Ui,
        clip: egui::Rect,
        session: &Session,
        active_tool: &ActiveTool,
        view: &DragView<'_>,
    ) {
        if let Some(document) = session.document().filter(|_| active_tool.tool == Tool::FocalPlane) {
            plane_tool::paint(&ui.painter_at(clip), document, view);
        }
        if let Some(drag) = &self.drag {
            drag.paint(&ui.painter_at(clip));
        }
        self.curve.paint(&ui.painter_at(clip), ui.input(|input| input.pointer.hover_pos()));
    }
}

/// Position of the brush when the pointer pulls it by a string: it stays while the string is slack.
fn pulled_by_string(brush: Option<Pos2>, pointer: Pos2, string: f32) -> Pos2 {
    let Some(brush) = brush.filter(|_| string > 0.0) else { return pointer };
    let toward = brush - pointer;
    let length = toward.length();
    if length <= string { brush } else { pointer + toward * (string / length) }
}

/// Pressure of a pen or finger if the system reports it; 1 for a mouse.
fn pen_pressure(events: &[Event]) -> f32 {
    let force = |event: &Event| match event {
        Event::Touch { force, .. } => *force,
        _ => None,
    };
    events.iter().rev().find_map(force).map_or(1.0, |force| force.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::pos2;

    #[test]
    fn a_string_evens_out_trembling_and_follows_the_way() {
        let trembling = (0..400).map(|k| pos2(k as f32, if k % 2 == 0 { 3.0 } else { -3.0 }));
        let mut brush = Some(pos2(0.0, 0.0));
        let mut widest = 0.0f32;
        for (k, pointer) in trembling.enumerate() {
            let at = pulled_by_string(brush, pointer, 30.0);
            assert!(at.distance(pointer) <= 30.001);
            if k > 100 {
                widest = widest.max(at.y.abs());
            }
            brush = Some(at);
        }
        assert!(widest < 1.0, "{widest}");
        assert!((brush.unwrap().x - 370.0).abs() < 2.0);
        assert_eq!(pulled_by_string(Some(pos2(1.0, 1.0)), pos2(5.0, 5.0), 0.0), pos2(5.0, 5.0));
        assert_eq!(pulled_by_string(Some(pos2(1.0, 1.0)), pos2(5.0, 5.0), 30.0), pos2(1.0, 1.0), "slack");
    }
}
