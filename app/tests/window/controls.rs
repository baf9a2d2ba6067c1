//! Every control has a name and a tooltip; the lens follows its controls.

use crate::acting::{Person, at};
use crate::small_scene::opened;
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;

#[test]
fn an_empty_window_says_how_to_begin() {
    let mut person = Person::starts(None);
    person.waits();
    assert_eq!(person.shell().title(), "Focus Brush");
    // `run` also checks that every control has a name.
    person.window.run_ok();
    person.window.get_by_label("File").click();
    person.window.run_ok();
    assert!(person.window.query_by_label_contains("Open…").is_some());
}

#[test]
fn the_lens_follows_its_controls_and_a_run_of_edits_is_one_step() {
    let (mut person, _folder) = opened();
    let old = person.document().camera.clone();
    for _ in 0..3 {
        person.presses(Modifiers::NONE, Key::Plus);
    }
    let ratio = old.f_number() / person.document().camera.f_number();
    assert!((ratio - 2f64.sqrt()).abs() < 1e-6, "three thirds are one stop: {ratio}");
    person.window.get_by_label("Angle of view").focus();
    person.window.run_ok();
    assert!(person.complaints().is_empty(), "{:?}", person.complaints());
}

#[test]
fn the_palette_finds_and_runs_a_command() {
    let (mut person, _folder) = opened();
    person.presses(Modifiers::COMMAND | Modifiers::SHIFT, Key::P);
    person.window.event(egui::Event::Text("smooth".into()));
    person.window.run_steps(2);
    person.presses(Modifiers::NONE, Key::Enter);
    assert_eq!(person.shell().tool(), focus_brush::window::Tool::Smooth);
}

#[test]
fn keys_that_are_typed_into_a_field_are_no_shortcuts() {
    let (mut person, _folder) = opened();
    let tool = person.shell().tool();
    person.presses(Modifiers::COMMAND | Modifiers::SHIFT, Key::P);
    person.presses(Modifiers::NONE, Key::G);
    person.presses(Modifiers::NONE, Key::Escape);
    assert_eq!(person.shell().tool(), tool);
}

#[test]
fn the_blur_slider_follows_mouse_and_keys_and_snaps_at_sharp() {
    let (mut person, _folder) = opened();
    let track =
        person.window.get_all_by_label("Blur").find(|node| node.rect().width() > 100.0).unwrap().rect();
    assert_eq!(person.document().brush.target.t, 1.0);
    person.clicks(at(track, 0.8, 0.5));
    let far = person.document().brush.target.t;
    assert!(far > 1.0);
    person.presses(Modifiers::NONE, Key::ArrowLeft);
    let less = person.document().brush.target.t;
    assert!(less > 1.0 && less < far, "an arrow moves it a little: {far} to {less}");
    person.clicks(at(track, 0.49, 0.5));
    assert_eq!(person.document().brush.target.t, 1.0, "near the middle it is sharp");
    person.clicks(at(track, 0.2, 0.5));
    assert!(person.document().brush.target.t < 1.0, "near on the left");
}
