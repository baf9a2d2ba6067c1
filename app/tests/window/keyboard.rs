//! From the start to an exported picture without a pointer: open, choose a blur, fill, undo, move, look, export.

use crate::acting::Person;
use crate::small_scene;
use egui::{Event, Key, Modifiers};
use egui_kittest::kittest::Queryable;
use lens::FocusOffset;

impl Person {
    fn types(&mut self, text: &str) {
        self.window.event(Event::Text(text.into()));
        self.window.run_steps(2);
    }

    /// Types into the field that has the keyboard instead of what stands there.
    fn types_anew(&mut self, text: &str) {
        self.presses(Modifiers::COMMAND, Key::A);
        self.types(text);
    }

    /// Runs what the palette finds first.
    fn finds_and_runs(&mut self, words: &str) {
        self.presses(Modifiers::COMMAND | Modifiers::SHIFT, Key::P);
        self.types(words);
        self.presses(Modifiers::NONE, Key::Enter);
        self.waits();
    }
}

#[test]
fn a_picture_is_made_by_keys_alone() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, picture) = (folder.path().join("wall.glb"), folder.path().join("keys.png"));
    small_scene::write(&scene);
    let mut person = Person::starts(None);

    person.presses(Modifiers::COMMAND, Key::O);
    person.window.run_steps(3);
    person.types_anew(&scene.display().to_string());
    person.presses(Modifiers::NONE, Key::Enter);
    person.wait_until("the scene is open", |shell| shell.session().document().is_some());
    person.waits();

    // Far blur, everywhere but where nothing is.
    person.presses(Modifiers::NONE, Key::Period);
    person.presses(Modifiers::NONE, Key::Period);
    let target = person.document().brush.target;
    assert!(target.t > 1.0, "{target:?}");
    let before = person.picture();
    person.finds_and_runs("fill everything");
    assert_eq!(person.document().undo_name(), Some("Fill everything"), "{:?}", person.complaints());
    person.presses(Modifiers::COMMAND, Key::Z);
    person.waits();
    assert_eq!(person.document().undo_name(), None);
    person.presses(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    person.waits();
    assert!(person.picture().radiance != before.radiance, "it is blurred");
    assert_ne!(
        person.document().map,
        focus::FocusMap::new(
            person.document().map.width(),
            person.document().map.height(),
            FocusOffset::STANDARD
        )
    );

    // A preset, the picture alone and back.
    person.finds_and_runs("bokeh: star");
    assert!(matches!(person.document().camera.aperture.shape, lens::ApertureShape::Mask(_)));
    person.presses(Modifiers::NONE, Key::F3);
    assert!(person.window.query_by_label("f-number").is_none(), "the picture alone");
    person.presses(Modifiers::NONE, Key::F3);
    assert!(person.window.query_by_label("f-number").is_some());

    person.presses(Modifiers::COMMAND, Key::E);
    person.window.run_steps(3);
    person.presses(Modifiers::NONE, Key::Enter);
    person.window.run_steps(3);
    person.types_anew(&picture.display().to_string());
    person.presses(Modifiers::NONE, Key::Enter);
    person.wait_until("the picture is written", |_| picture.is_file());
    person.waits();
    let written = image::open(&picture).expect("a picture");
    let camera = &person.document().camera;
    assert_eq!([written.width(), written.height()], [camera.width, camera.height]);
    assert!(person.complaints().is_empty(), "{:?}", person.complaints());
}
