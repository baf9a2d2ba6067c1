//! What the pointer does to a view that can be painted on: strokes and clicks of the tool, the same in both views.
//!
//! A stroke is told in the view's own terms: where in it the pen is. So it can be recorded and painted again.

use super::brush_ring::BrushRing;
use super::{Action, Tool};
use egui::{Event, PointerButton, Pos2, Response, Ui};
use glam::DVec2;
use project::ViewFrame;
use session::{Command, FillRegion, Session, StrokePoint, StrokeTarget, view_ray};
use trace::Ray;

/// How far apart the points of a straight line are told, screen points.
const LINE_STEP: f32 = 4.0;

/// What the user holds.
#[derive(Clone, Copy, Debug)]
pub struct Hand {
    /// The tool.
    pub tool: Tool,
    /// The ring that shows where it paints.
    pub ring: Option<BrushRing>,
    /// Length of the string by which the pointer pulls the brush, points.
    pub string: f32,
}

/// The stroke of one view.
#[derive(Default)]
pub struct StrokeInput {
    painting: bool,
    /// Where the brush is: on the string behind the pointer.
    brush: Option<Pos2>,
    /// Where the last stroke ended, and in which view: a straight line may go on from there.
    last_end: Option<(ViewFrame, Pos2)>,
}

impl StrokeInput {
    /// Turns the left button on `response` into strokes and clicks. `frame` is the view, and `position` takes a
    /// screen position to where in it that is ((0, 0) upper left, (1, 1) lower right).
    pub fn update(
        &mut self,
        ui: &Ui,
        response: &Response,
        session: &Session,
        hand: Hand,
        frame: ViewFrame,
        position: impl Fn(Pos2) -> DVec2,
    ) -> Vec<Action> {
        let mut actions = Vec::new();
        let Some(document) = session.document() else { return actions };
        // The modifiers of the press itself: a frame may hold more than one event.
        let pressed = ui.input(|input| {
            let press = |event: &Event| match event {
                Event::PointerButton { button: PointerButton::Primary, pressed: true, modifiers, .. } => {
                    Some(*modifiers)
                }
                _ => None,
            };
            input.events.iter().find_map(press)
        });
        let down = ui.input(|input| input.pointer.primary_down());
        let pressure = ui.input(|input| pen_pressure(&input.events));
        let point = |at| StrokePoint { at: StrokeTarget::View(frame, position(at)), pressure };
        if self.painting && !session.is_painting() {
            // Taken back meanwhile, by Esc or undo: the rest of the drag paints nothing.
            self.painting = false;
        }
        let plain = pressed.is_some_and(|modifiers| !modifiers.alt && !modifiers.command);
        let start = response.is_pointer_button_down_on() && plain;
        if start && let Some(at) = response.interact_pointer_pos() {
            response.request_focus();
            let tool = hand.tool;
            if tool.paints() {
                let mode = tool.mode(document.brush.mode);
                if mode != document.brush.mode {
                    actions.push(Command::SetBrush(focus::Brush { mode, ..document.brush.clone() }).into());
                }
                let line = pressed.is_some_and(|modifiers| modifiers.shift);
                let from =
                    self.last_end.filter(|(view, _)| line && *view == frame).map_or(at, |(_, end)| end);
                actions.push(Command::BeginStroke(point(from)).into());
                let steps = (from.distance(at) / LINE_STEP).ceil();
                for k in 1..=steps as u32 {
                    let along = from.lerp(at, k as f32 / steps);
                    actions.push(Command::ExtendStroke(point(along)).into());
                }
                self.painting = true;
                self.brush = Some(at);
            } else {
                actions.extend(click(session, tool, &view_ray(&frame, position(at))));
            }
            return actions;
        }
        if !self.painting {
            return actions;
        }
        // Every motion event, not only the frame's last: a fast stroke stays round.
        let moves = ui.input(|input| {
            let moved = |event: &Event| match event {
                Event::PointerMoved(position) => Some(*position),
                _ => None,
            };
            input.events.iter().filter_map(moved).collect::<Vec<_>>()
        });
        for pointer in moves {
            let at = pulled(self.brush, pointer, hand.string);
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

/// Where the brush comes to lie when the pointer pulls it by a string: it stays while the string is slack.
fn pulled(brush: Option<Pos2>, pointer: Pos2, string: f32) -> Pos2 {
    let Some(brush) = brush.filter(|_| string > 0.0) else { return pointer };
    let toward = brush - pointer;
    let length = toward.length();
    if length <= string { brush } else { pointer + toward * (string / length) }
}

/// The pressure of a pen or finger where the system tells it; a mouse presses fully.
fn pen_pressure(events: &[Event]) -> f32 {
    let force = |event: &Event| match event {
        Event::Touch { force, .. } => *force,
        _ => None,
    };
    events.iter().rev().find_map(force).map_or(1.0, |force| force.clamp(0.0, 1.0))
}

/// What a tool that does not paint does where it is clicked.
fn click(session: &Session, tool: Tool, ray: &Ray) -> Option<Action> {
    let target = session.document()?.brush.target;
    let hit = session.pick(ray)?;
    let command = match tool {
        Tool::FillObject => Command::Fill(FillRegion::Node(hit), target),
        Tool::FillMaterial => Command::Fill(FillRegion::Material(hit), target),
        Tool::FillChart => Command::Fill(FillRegion::Chart(hit), target),
        Tool::FocusHere => Command::FocusHere(hit),
        Tool::Pick => Command::Pick(hit),
        Tool::Brush | Tool::Smooth | Tool::Sharpen | Tool::Reset => return None,
    };
    Some(command.into())
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
            let at = pulled(brush, pointer, 30.0);
            assert!(at.distance(pointer) <= 30.001);
            if k > 100 {
                widest = widest.max(at.y.abs());
            }
            brush = Some(at);
        }
        assert!(widest < 1.0, "{widest}");
        assert!((brush.unwrap().x - 370.0).abs() < 2.0);
        assert_eq!(pulled(Some(pos2(1.0, 1.0)), pos2(5.0, 5.0), 0.0), pos2(5.0, 5.0));
        assert_eq!(pulled(Some(pos2(1.0, 1.0)), pos2(5.0, 5.0), 30.0), pos2(1.0, 1.0), "slack");
    }
}
