//! Captures in the window: dropped, viewed through their cameras, painted, saved and reopened.

use crate::acting::{Person, at, difference};
use crate::wall_capture;
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use focus_brush::window::Pane;

/// The photograph whose camera is selected.
fn looked_through(person: &Person) -> Option<String> {
    person.document().photograph().map(|view| view.name.clone())
}

#[test]
fn a_capture_is_dropped_looked_through_painted_and_the_same_when_opened_again() {
    let folder = tempfile::tempdir().unwrap();
    let capture = folder.path().join("wall");
    wall_capture::write(&capture);
    let mut person = Person::starts(None);
    person.drops(&capture);
    person.wait_until("the capture is open", |shell| shell.session().document().is_some());
    person.wait_until("the surface is drawn", |shell| shell.paint_view().is_ready());
    person.waits();
    assert_eq!(person.complaints(), [""; 0]);
    assert!(person.shell().layout().is_shown(Pane::Photographs), "its photographs are there");

    // Through two of them, and between.
    for name in ["1.png", "4.png"] {
        person.scrolls_to(name);
        person.window.get_by_label(name).click();
        person.window.run_steps(3);
        person.waits();
        assert_eq!(looked_through(&person).as_deref(), Some(name));
    }
    let from = person.document().camera.clone();
    person.scrolls_to("3.png");
    person.window.get_by_label("3.png").click_modifiers(Modifiers::SHIFT);
    person.window.run_steps(3);
    assert_eq!(looked_through(&person).as_deref(), Some("4.png"), "the way begins where the camera is");
    let slider = person.window.get_by_label("Way between two photographs");
    let rect = slider.rect();
    person.paints(&[at(rect, 0.05, 0.5), at(rect, 0.5, 0.5)]);
    let between = person.document().camera.clone();
    assert_eq!(looked_through(&person), None);
    let place = |camera: &lens::Camera| camera.camera_to_world.w_axis;
    assert!(place(&between).distance(place(&from)) > 0.05);
    person.presses(Modifiers::COMMAND, Key::Z);
    person.waits();
    assert_eq!(looked_through(&person).as_deref(), Some("4.png"), "one step of undo");

    person.presses(Modifiers::NONE, Key::G);
    person.clicks(at(person.picture_rect(), 0.4, 0.5));
    person.presses(Modifiers::NONE, Key::Plus);
    person.waits();
    let project = folder.path().join("wall.fbrush");
    person.presses(Modifiers::COMMAND, Key::S);
    person.window.get_by_label("Save").click();
    person.waits();
    assert!(project.is_file(), "{:?}", person.complaints());
    let (map, camera, picture) =
        (person.document().map.clone(), person.document().camera.clone(), person.picture());
    drop(person);

    let person = Person::opens(&project);
    assert_eq!(person.document().map, map);
    assert_eq!(person.document().camera, camera);
    assert_eq!(difference(&person.picture(), &picture), 0.0);
    assert_eq!(looked_through(&person).as_deref(), Some("4.png"));
}
