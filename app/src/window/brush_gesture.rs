//! Setting one number of the brush at the pointer: a key, then a move of the mouse or typed digits, then a click or Enter.

use super::controls;
use egui::{Align2, Area, Context, Event, Frame, Id, Key, Modifiers, Order, PointerButton, Pos2};
use focus::Brush;

/// Points of the pointer's way that double the size.
const POINTS_PER_DOUBLING: f64 = 120.0;
/// Points of the pointer's way from 0 to 1.
const POINTS_PER_UNIT: f64 = 240.0;

/// Which number of the brush is set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BrushNumber {
    /// Its radius.
    Size,
    /// Its strength.
    Strength,
    /// Its hardness.
    Hardness,
}

impl BrushNumber {
    fn name(self) -> &'static str {
        match self {
            Self::Size => "Brush size",
            Self::Strength => "Brush strength",
            Self::Hardness => "Brush hardness",
        }
    }

    fn of(self, brush: &mut Brush) -> &mut f64 {
        match self {
            Self::Size => &mut brush.radius,
            Self::Strength => &mut brush.strength,
            Self::Hardness => &mut brush.hardness,
        }
    }

    /// The number after the pointer went `points` to the right.
    fn moved(self, before: f64, points: f64) -> f64 {
        match self {
            Self::Size => before * (points / POINTS_PER_DOUBLING).exp2(),
            Self::Strength | Self::Hardness => before + points / POINTS_PER_UNIT,
        }
    }

    fn clamped(self, value: f64, largest_radius: f64) -> f64 {
        match self {
            Self::Size => value.clamp(largest_radius * 1e-4, largest_radius),
            Self::Strength | Self::Hardness => value.clamp(0.0, 1.0),
        }
    }
}

/// The gesture that goes on, if one does.
#[derive(Default)]
pub struct BrushGesture {
    held: Option<Held>,
    /// The click that ended it has not been let go: it paints nothing.
    ending: bool,
}

struct Held {
    number: BrushNumber,
    before: Brush,
    from: Pos2,
    typed: String,
}

impl BrushGesture {
    /// Begins to set a number of the brush, where the pointer is.
    pub fn begin(&mut self, number: BrushNumber, brush: &Brush, context: &Context) {
        let from =
            context.input(|input| input.pointer.latest_pos()).unwrap_or(context.content_rect().center());
        self.held = Some(Held { number, before: brush.clone(), from, typed: String::new() });
    }

    /// Whether pointer and keys are the gesture's.
    pub fn has_input(&self) -> bool {
        self.held.is_some() || self.ending
    }

    /// Takes up pointer and keys and shows the number beside the pointer. The brush as it is to be.
    pub fn update(&mut self, context: &Context, largest_radius: f64) -> Option<Brush> {
        self.ending &= context.input(|input| input.pointer.any_down());
        let held = self.held.as_mut()?;
        let mut done = false;
        let mut given_up = false;
        context.input_mut(|input| {
            for event in &input.events {
                match event {
                    Event::Text(text) => {
                        held.typed.extend(text.chars().filter(|c| c.is_ascii_digit() || *c == '.'));
                    }
                    Event::Key { key: Key::Backspace, pressed: true, .. } => {
                        held.typed.pop();
                    }
                    Event::Key { key: Key::Enter, pressed: true, .. } => done = true,
                    Event::Key { key: Key::Escape, pressed: true, .. }
                    | Event::PointerButton { button: PointerButton::Secondary, pressed: true, .. } => {
                        given_up = true;
                    }
                    Event::PointerButton { button: PointerButton::Primary, pressed: true, .. } => {
                        (done, self.ending) = (true, true);
                    }
                    _ => {}
                }
            }
            input.consume_key(Modifiers::NONE, Key::Escape);
            input.consume_key(Modifiers::NONE, Key::Enter);
        });
        let mut brush = held.before.clone();
        if !given_up {
            let at = context.input(|input| input.pointer.latest_pos()).unwrap_or(held.from);
            let before = *held.number.of(&mut brush);
            let moved = held.number.moved(before, (at.x - held.from.x) as f64);
            let value = held.typed.parse().unwrap_or(moved);
            *held.number.of(&mut brush) = held.number.clamped(value, largest_radius);
            show(context, held, *held.number.of(&mut brush), at);
        }
        if done || given_up {
            self.held = None;
        }
        Some(brush)
    }
}

fn show(context: &Context, held: &Held, value: f64, at: Pos2) {
    let unit = if held.number == BrushNumber::Size { " m" } else { "" };
    let shown = match held.typed.as_str() {
        "" => controls::significant(value),
        typed => format!("{typed}|"),
    };
    let area = Area::new(Id::unique("brush gesture")).order(Order::Tooltip).interactable(false);
    let place = area.fixed_pos(at + egui::vec2(18.0, 14.0)).pivot(Align2::LEFT_TOP).constrain(true);
    place.show(context, |ui| {
        Frame::popup(ui.style()).show(ui, |ui| {
            ui.label(egui::RichText::new(format!("{} {shown}{unit}", held.number.name())).strong());
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
        let size = BrushNumber::Size;
        assert!((size.moved(0.1, POINTS_PER_DOUBLING) - 0.2).abs() < 1e-12);
        assert_eq!(size.clamped(size.moved(0.1, 1e4), 2.0), 2.0);
        let strength = BrushNumber::Strength;
        assert_eq!(strength.clamped(strength.moved(0.5, 1e4), 2.0), 1.0);
        assert_eq!(strength.moved(0.5, POINTS_PER_UNIT / 4.0), 0.75);
    }
}
