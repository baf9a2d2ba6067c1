//! Light fields and pictures with depth in the window: dropped, painted, saved and opened again.

use crate::acting::{Person, at, difference};
use crate::card_light_field;
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use std::path::Path;

/// Drops a capture, paints on its card, saves, and opens the project again.
fn is_the_same_when_opened_again(capture: &Path, project: &Path) {
    let mut person = Person::starts(None);
    person.drops(capture);
    person.wait_until("it is open", |shell| shell.session().document().is_some());
    person.wait_until("the surface is drawn", |shell| shell.paint_view().is_ready());
    person.waits();
    assert_eq!(person.complaints(), [""; 0]);
    let camera = person.document().camera.clone();
    assert_eq!([camera.width, camera.height], card_light_field::SIZE, "it is the picture's");
    assert!(camera.aperture_radius > 0.0);
    let before = person.picture();
    person.presses(Modifiers::NONE, Key::G);
    person.clicks(at(person.picture_rect(), 0.5, 0.5));
    assert!(difference(&person.picture(), &before) > 0.0, "paint is seen");
    person.presses(Modifiers::COMMAND, Key::S);
    person.window.get_by_label("Save").click();
    person.waits();
    assert!(project.is_file(), "{:?}", person.complaints());
    let (map, picture) = (person.document().map.clone(), person.picture());
    drop(person);

    let person = Person::opens(project);
    assert_eq!(person.document().map, map);
    assert_eq!(person.document().camera, camera);
    assert_eq!(difference(&person.picture(), &picture), 0.0);
}

#[test]
fn a_light_field_is_painted_and_the_same_when_opened_again() {
    let folder = tempfile::tempdir().unwrap();
    let capture = folder.path().join("card");
    card_light_field::write(&capture);
    is_the_same_when_opened_again(&capture, &folder.path().join("card.fbrush"));
}

#[test]
fn a_picture_with_depth_is_painted_and_the_same_when_opened_again() {
    let folder = tempfile::tempdir().unwrap();
    let picture = folder.path().join("card.png");
    card_light_field::view([0.0; 2]).save(&picture).unwrap();
    card_light_field::pfm(&folder.path().join("card_depth.pfm"), |disparity| 1.0 / (1.0 + disparity));
    is_the_same_when_opened_again(&picture, &folder.path().join("card.fbrush"));
}
