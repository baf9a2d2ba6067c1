//! Navigation in the views: which buttons and keys orbit, pan or zoom, by key map.
//!
//! In every map a single button is sufficient, for pens: Alt+drag and Space+drag move the view.

use egui::{Context, Key, Modifiers, PointerButton, Response, Ui, Vec2};
use session::KeyMap;

/// Effect of a drag on a view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// Orbits around the pivot.
    Orbit,
    /// Pans.
    Slide,
    /// Zooms.
    Nearer,
}

/// Effect of a drag with a button; `None` if it does not move the view.
fn motion(map: KeyMap, button: PointerButton, modifiers: Modifiers, space: bool) -> Option<Motion> {
    use Motion::{Nearer, Orbit, Slide};
    let by_modifiers = |plain: Motion, shift: Motion, command: Motion| match modifiers {
        Modifiers { command: true, .. } => command,
        Modifiers { shift: true, .. } => shift,
        _ => plain,
    };
    match (map, button) {
        (KeyMap::Substance, PointerButton::Middle) if modifiers.alt => Some(Slide),
        (KeyMap::Substance, PointerButton::Secondary) if modifiers.alt => Some(Nearer),
        (KeyMap::Substance, PointerButton::Primary) if modifiers.alt && modifiers.command => Some(Slide),
        (KeyMap::Krita, PointerButton::Middle) => Some(by_modifiers(Slide, Orbit, Nearer)),
        (KeyMap::Krita, PointerButton::Primary) if space => Some(by_modifiers(Slide, Orbit, Nearer)),
        (_, PointerButton::Middle) => Some(by_modifiers(Orbit, Slide, Nearer)),
        (_, PointerButton::Primary) if modifiers.alt || space => Some(by_modifiers(Orbit, Slide, Nearer)),
        _ => None,
    }
}

/// Whether Space is held to move the view, not typed into a text field.
pub fn is_space_held(context: &Context) -> bool {
    !context.text_edit_focused() && context.input(|input| input.key_down(Key::Space))
}

/// Whether the left button would currently move a view instead of painting.
pub fn claims_primary(context: &Context, modifiers: Modifiers) -> bool {
    motion(
        crate::window::widgets::keys::key_map(context),
        PointerButton::Primary,
        modifiers,
        is_space_held(context),
    )
    .is_some()
}

/// The motion of the current drag and its distance since the last frame, points.
pub fn view_drag(ui: &Ui, response: &Response) -> Option<(Motion, Vec2)> {
    let (map, space) = (crate::window::widgets::keys::key_map(ui.ctx()), is_space_held(ui.ctx()));
    let modifiers = ui.input(|input| input.modifiers);
    let buttons = [PointerButton::Middle, PointerButton::Secondary, PointerButton::Primary];
    let held = buttons.into_iter().find(|button| response.dragged_by(*button))?;
    Some((motion(map, held, modifiers, space)?, response.drag_delta()))
}

/// The gestures of a key map, for the help window.
pub fn gestures(map: KeyMap) -> [(&'static str, &'static str); 5] {
    let [orbit, slide, nearer] = match map {
        KeyMap::Blender => ["Middle drag", "Shift+middle drag", "Ctrl+middle drag"],
        KeyMap::Substance => ["Alt+left drag, middle drag", "Alt+middle drag", "Alt+right drag"],
        KeyMap::Krita => ["Shift+middle drag", "Middle drag, Space+drag", "Ctrl+middle drag"],
    };
    let pen = match map {
        KeyMap::Krita => "turns (Alt), slides (Space), turns (Shift+Space) or nears (Ctrl+Space)",
        KeyMap::Blender | KeyMap::Substance => "turns; with Shift slides; with Ctrl comes nearer",
    };
    [
        (orbit, "turn the paint view; orbit the camera in the picture"),
        (slide, "slide the paint view; move the camera sideways in the picture"),
        (nearer, "bring the view or the camera nearer"),
        ("Alt+drag, Space+drag", pen),
        ("Space+drag in the picture", "slide the picture; with Ctrl enlarge it"),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_map_has_every_motion_for_a_pen_and_paints_with_the_bare_button() {
        let combinations = [Modifiers::NONE, Modifiers::SHIFT, Modifiers::COMMAND, Modifiers::ALT];
        for map in KeyMap::ALL {
            for modifiers in [Modifiers::NONE, Modifiers::SHIFT, Modifiers::COMMAND] {
                assert_eq!(motion(map, PointerButton::Primary, modifiers, false), None, "{map:?}");
            }
            for expected in [Motion::Orbit, Motion::Slide, Motion::Nearer] {
                let reach = |space: bool| {
                    let mut combinations_left = combinations.iter();
                    combinations_left
                        .any(|&keys| motion(map, PointerButton::Primary, keys, space) == Some(expected))
                };
                assert!(reach(true), "{map:?} {expected:?} by Space and one button");
            }
            assert_eq!(motion(map, PointerButton::Primary, Modifiers::ALT, false), Some(Motion::Orbit));
        }
        let alt = |button| motion(KeyMap::Substance, button, Modifiers::ALT, false);
        assert_eq!(alt(PointerButton::Middle), Some(Motion::Slide));
        assert_eq!(alt(PointerButton::Secondary), Some(Motion::Nearer));
    }
}
