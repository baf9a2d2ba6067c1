//! Adjusts one parameter of the brush at the pointer: a key starts the gesture, moving the mouse or typing
//! digits sets the value, a click or Enter accepts it.

use crate::window::widgets::controls;
use egui::{Align2, Area, Context, Event, Frame, Id, Key, Modifiers, Order, PointerButton, Pos2};
use focus::Brush;

/// Pointer movement that doubles the size, points.
const POINTS_PER_DOUBLING: f64 = 120.0;
/// Pointer movement from 0 to 1, points.
const POINTS_PER_UNIT: f64 = 240.0;

/// The parameter that is adjusted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BrushParameter {
    /// Its radius.
    Size,
    /// Its strength.
    Strength,
    /// Its hardness.
    Hardness,
}

impl BrushParameter {
    fn name(self) -> &'static str {
        match self {
            Self::Size => "Brush size",
            Self::Strength => "Brush strength",
            Self::Hardness => "Brush hardness",
        }
    }

    fn value_mut(self, brush: &mut Brush) -> &mut f64 {
        match self {
            Self::Size => &mut brush.radius,
            Self::Strength => &mut brush.strength,
            Self::Hardness => &mut brush.hardness,
        }
    }

    /// The value after the pointer moved `points` to the right.
    fn dragged_value(self, before: f64, points: f64) -> f64 {
        match self {
            Self::Size => before * (points / POINTS_PER_DOUBLING).exp2(),
            Self::Strength | Self::Hardness => before + points / POINTS_PER_UNIT,
        }
    }

    fn clamped_value(self, value: f64, largest_radius: f64) -> f64 {
        match self {
            Self::Size => value.clamp(largest_radius * 1e-4, largest_radius),
            Self::Strength | Self::Hardness => value.clamp(0.0, 1.0),
        }
    }
}

/// The active gesture, if any.
#[derive(Default)]
pub struct BrushGesture {
    active: Option<ActiveGesture>,
    /// The button of the click that ended the gesture is still down: it must not paint.
    awaits_release: bool,
}

struct ActiveGesture {
    parameter: BrushParameter,
    before: Brush,
    from: Pos2,
    typed: String,
}

impl BrushGesture {
    /// Starts adjusting a parameter of the brush at the pointer.
    pub fn begin(&mut self, parameter: BrushParameter, brush: &Brush, context: &Context) {
        let from =
            context.input(|input| input.pointer.latest_pos()).unwrap_or(context.content_rect().center());
        self.active = Some(ActiveGesture { parameter, before: brush.clone(), from, typed: String::new() });
    }

    /// Whether the gesture takes all input of pointer and keys at present.
    pub fn has_input(&self) -> bool {
        self.active.is_some() || self.awaits_release
    }

    /// Handles pointer and keys and shows the value beside the pointer. Returns the adjusted brush.
    pub fn update(&mut self, context: &Context, largest_radius: f64) -> Option<Brush> {
        self.awaits_release &= context.input(|input| input.pointer.any_down());
        let active = self.active.as_mut()?;
        let mut done = false;
        let mut cancelled = false;
        context.input_mut(|input| {
            for event in &input.events {
                match event {
                    Event::Text(text) => {
                        active.typed.extend(text.chars().filter(|c| c.is_ascii_digit() || *c == '.'));
                    }
                    Event::Key { key: Key::Backspace, pressed: true, .. } => {
                        active.typed.pop();
                    }
                    Event::Key { key: Key::Enter, pressed: true, .. } => done = true,
                    Event::Key { key: Key::Escape, pressed: true, .. }
                    | Event::PointerButton { button: PointerButton::Secondary, pressed: true, .. } => {
                        cancelled = true;
                    }
                    Event::PointerButton { button: PointerButton::Primary, pressed: true, .. } => {
                        (done, self.awaits_release) = (true, true);
                    }
                    _ => {}
                }
            }
            input.consume_key(Modifiers::NONE, Key::Escape);
            input.consume_key(Modifiers::NONE, Key::Enter);
        });
        let mut brush = active.before.clone();
        if !cancelled {
            let at = context.input(|input| input.pointer.latest_pos()).unwrap_or(active.from);
            let before = *active.parameter.value_mut(&mut brush);
            let dragged = active.parameter.dragged_value(before, (at.x - active.from.x) as f64);
            let value = active.typed.parse().unwrap_or(dragged);
            *active.parameter.value_mut(&mut brush) = active.parameter.clamped_value(value, largest_radius);
            show_value(context, active, *active.parameter.value_mut(&mut brush), at);
        }
        if done || cancelled {
            self.active = None;
        }
        Some(brush)
    }
}

fn show_value(context: &Context, active: &ActiveGesture, value: f64, at: Pos2) {
    let unit = if active.parameter == BrushParameter::Size { " m" } else { "" };
    let shown = match active.typed.as_str() {
        "" => controls::significant_digits(value),
        typed => format!("{typed}|"),
    };
    let area = Area::new(Id::unique("brush gesture")).order(Order::Tooltip).interactable(false);
    let place = area.fixed_pos(at + egui::vec2(18.0, 14.0)).pivot(Align2::LEFT_TOP).constrain(true);
    place.show(context, |ui| {
        Frame::popup(ui.style()).show(ui, |ui| {
            ui.label(egui::RichText::new(format!("{} {shown}{unit}", active.parameter.name())).strong());
            ui.weak("Move, or type a number. Click or Enter keeps it, Esc does not.");
        });
    });
    context.request_repaint();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_follow_the_pointer_and_stay_within_their_limits() {
        let size = BrushParameter::Size;
        assert!((size.dragged_value(0.1, POINTS_PER_DOUBLING) - 0.2).abs() < 1e-12);
        assert_eq!(size.clamped_value(size.dragged_value(0.1, 1e4), 2.0), 2.0);
        let strength = BrushParameter::Strength;
        assert_eq!(strength.clamped_value(strength.dragged_value(0.5, 1e4), 2.0), 1.0);
        assert_eq!(strength.dragged_value(0.5, POINTS_PER_UNIT / 4.0), 0.75);
    }
}
