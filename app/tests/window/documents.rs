//! Files: save, reopen, the question about unsaved changes, errors.

use crate::acting::{Person, at, difference};
use crate::small_scene;
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;

#[test]
fn saved_and_reopened_is_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("wall.glb");
    small_scene::write(&file);
    let project = folder.path().join("wall.fbrush");

    let mut person = Person::opens(&file);
    person.presses(Modifiers::NONE, Key::G);
    let card = at(person.picture_rect(), 0.25, 0.5);
    person.clicks(card);
    person.presses(Modifiers::NONE, Key::Plus);
    person.waits();
    assert!(person.shell().title().contains(" *"), "{}", person.shell().title());

    // The first save asks for a file and suggests one beside the scene.
    person.presses(Modifiers::COMMAND, Key::S);
    person.window.get_by_label("Save").click();
    person.waits();
    assert!(project.is_file(), "{:?}", person.complaints());
    assert_eq!(person.shell().title(), "wall.fbrush – Focus Brush");
    let (map, camera, picture) =
        (person.document().map.clone(), person.document().camera.clone(), person.picture());
    drop(person);

    let person = Person::opens(&project);
    assert_eq!(person.document().map, map);
    assert_eq!(person.document().camera, camera);
    assert_eq!(difference(&person.picture(), &picture), 0.0);
    assert!(!person.document().is_unsaved());
    assert!(project::Thumbnail::read(&project).unwrap().is_some(), "it holds what it looks like");
}

#[test]
fn unsaved_changes_are_asked_about() {
    let (mut person, _folder) = small_scene::opened();
    person.presses(Modifiers::NONE, Key::Plus);
    person.presses(Modifiers::COMMAND, Key::Q);
    assert!(person.window.query_by_label("Save the changes?").is_some());
    person.window.get_by_label("Cancel").click();
    person.window.run_steps(3);
    assert!(person.window.query_by_label("Save the changes?").is_none());
    assert!(person.has_document());
}

#[test]
fn a_bad_file_is_a_message_and_the_document_stays() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("wall.glb");
    small_scene::write(&file);
    let broken = folder.path().join("broken.glb");
    std::fs::write(&broken, b"glTF, but not really").unwrap();

    let mut person = Person::opens(&file);
    let title = person.shell().title().to_string();
    person.presses(Modifiers::COMMAND, Key::O);
    let field = person.window.get_by_label("Path");
    field.focus();
    person.window.run_steps(1);
    person.window.get_by_label("broken.glb").click();
    person.window.run_steps(2);
    person.window.get_by_role_and_label(egui::Role::Button, "Open").click();
    person.waits();
    let complaints = person.complaints();
    assert_eq!(complaints.len(), 1, "{complaints:?}");
    assert!(complaints[0].contains("broken.glb"), "{complaints:?}");
    assert_eq!(person.shell().title(), title, "what was open stays open");
}
