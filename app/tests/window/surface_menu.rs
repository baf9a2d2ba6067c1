//! A right click in a view: the brush at the pointer, and what can be done with the surface there.

use crate::acting::{Person, at};
use crate::small_scene::opened;
use egui::{Event, Modifiers, PointerButton, Pos2};
use egui_kittest::kittest::Queryable;

impl Person {
    fn right_clicks(&mut self, pos: Pos2) {
        self.window.hover_at(pos);
        self.window.step();
        for pressed in [true, false] {
            let button = PointerButton::Secondary;
            self.window.event(Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE });
            self.window.step();
        }
        self.window.run_steps(3);
    }
}

#[test]
fn a_right_click_sets_the_brush_and_acts_on_what_is_there() {
    let (mut person, _folder) = opened();
    let card = at(person.picture_rect(), 0.3, 0.5);
    person.right_clicks(card);
    assert!(person.window.query_by_label("Focus the lens here").is_some(), "the surface's entries");
    let before = person.document().camera.focus_distance;
    person.window.get_by_label("Focus the lens here").click();
    person.waits();
    let after = person.document().camera.focus_distance;
    assert!((after - 2.0).abs() < 1e-6 && before > 4.0, "{before} to {after}: the card is at 2");
    assert!(person.window.query_by_label("Focus the lens here").is_none(), "it is closed");

    // A click beside it closes it, and paints nothing.
    let steps = person.document().undo_names().count();
    person.right_clicks(card);
    person.clicks(at(person.picture_rect(), 0.9, 0.1));
    person.waits();
    assert!(person.window.query_by_label("Focus the lens here").is_none());
    assert_eq!(person.document().undo_names().count(), steps, "nothing was painted");
}
