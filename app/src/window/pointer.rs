//! What the pointer does to a view that can be painted on: strokes and clicks of the tool, the same in both views.

use super::brush_ring::BrushRing;
use super::{Action, Tool};
use egui::{Event, PointerButton, Pos2, Response, Ui};
use session::{Command, FillRegion, Session, StrokePoint, StrokeTarget};
use trace::Ray;

/// What the user holds.
#[derive(Clone, Copy, Debug)]
pub struct Hand {
    /// The tool.
    pub tool: Tool,
    /// The ring that shows where it paints.
    pub ring: Option<BrushRing>,
}

/// The stroke of one view.
#[derive(Default)]
pub struct StrokeInput {
    painting: bool,
    last: Option<Pos2>,
}

impl StrokeInput {
    /// Turns the left button on `response` into strokes and clicks. `ray` takes a screen position to the view's ray.
    pub fn update(
        &mut self,
        ui: &Ui,
        response: &Response,
        session: &Session,
        tool: Tool,
        ray: impl Fn(Pos2) -> Option<Ray>,
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
        let point = |ray| StrokePoint { at: StrokeTarget::Ray(ray), pressure };
        if self.painting && !session.is_painting() {
            // Taken back meanwhile, by Esc or undo: the rest of the drag paints nothing.
            self.painting = false;
        }
        let plain = pressed.is_some_and(|modifiers| !modifiers.alt && !modifiers.command);
        let start = response.is_pointer_button_down_on() && plain;
        if start && let Some(position) = response.interact_pointer_pos() {
            response.request_focus();
            let Some(ray) = ray(position) else { return actions };
            if tool.paints() {
                let mode = tool.mode(document.brush.mode);
                if mode != document.brush.mode {
                    actions.push(Command::SetBrush(focus::Brush { mode, ..document.brush.clone() }).into());
                }
                actions.push(Command::BeginStroke(point(ray)).into());
                self.painting = true;
                self.last = Some(position);
            } else {
                actions.extend(click(session, tool, &ray));
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
        for position in moves {
            if Some(position) != self.last
                && let Some(ray) = ray(position)
            {
                actions.push(Command::ExtendStroke(point(ray)).into());
                self.last = Some(position);
            }
        }
        if !down {
            actions.push(Command::CommitStroke.into());
            self.painting = false;
        }
        actions
    }
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
