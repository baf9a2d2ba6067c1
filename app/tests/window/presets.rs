//! Presets in the window: chosen, saved under a name, imported and exported as files.

use crate::acting::Person;
use crate::small_scene;
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use focus_brush::window::WindowOptions;
use lens::ApertureShape;
use project::{PresetKind, PresetLibrary};
use session::CommandId;
use std::path::Path;

#[test]
fn presets_are_chosen_saved_exported_and_imported() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("wall.glb");
    small_scene::write(&scene);
    let own = folder.path().join("presets");
    let started = |own: &Path| {
        let options = WindowOptions { presets: Some(own.to_owned()), ..Person::usual(Some(&scene)) };
        let mut person = Person::starts_with(options);
        person.waits();
        person.wait_until("the surface is drawn", |shell| shell.paint_view().is_ready());
        person.waits();
        person
    };
    let mut person = started(&own);
    let before = person.document().camera.clone();
    let chooses = |person: &mut Person, list: &str, name: &str| {
        person.scrolls_to(list);
        person.window.get_by_label(list).click();
        person.window.run_steps(3);
        person.window.get_by_label(name).scroll_to_me();
        person.window.run_steps(3);
        person.window.get_by_label(name).click();
        person.window.run_steps(3);
        person.waits();
    };
    // A lens preset keeps pose, focus distance and size, and is one undo step.
    chooses(&mut person, "Lens preset", "Full frame 85 mm f/1.4");
    let camera = person.document().camera.clone();
    assert!((camera.optics().focal_length() - 0.085).abs() < 1e-9 && (camera.f_number() - 1.4).abs() < 1e-9);
    assert_eq!(
        (camera.camera_to_world, camera.focus_distance),
        (before.camera_to_world, before.focus_distance)
    );
    let shelf = PresetLibrary::open(None);
    let listed = shelf.find(PresetKind::Lens, "Full frame 85 mm f/1.4").unwrap();
    assert!(listed.matches_camera(&camera) && !listed.matches_camera(&before));
    person.presses(Modifiers::COMMAND, Key::Z);
    person.waits();
    assert_eq!(person.document().camera, before);
    // A bokeh preset with a mask.
    chooses(&mut person, "Bokeh preset", "Heart");
    assert!(matches!(person.document().camera.aperture.shape, ApertureShape::Mask(_)));

    // Saved under a name, and available in a new window.
    let context = person.window.ctx.clone();
    person.window.state_mut().run(CommandId::SaveBokehPreset, &context);
    person.window.run_steps(3);
    for letter in [Key::M, Key::I] {
        let text = format!("{letter:?}").to_lowercase();
        person.window.event(egui::Event::Text(text));
        person.window.step();
    }
    person.presses(Modifiers::NONE, Key::Enter);
    person.window.run_steps(3);
    assert!(own.join("bokeh/mi.json").is_file(), "{:?}", person.complaints());
    let heart = person.document().camera.aperture.clone();
    drop(person);
    let exported = folder.path().join("out.json");
    std::fs::rename(own.join("bokeh/mi.json"), &exported).unwrap();
    let mut person = started(&own);
    assert!(person.document().camera.aperture != heart);
    // Dropped on the window, it appears in the list and can be chosen.
    person.drops(&exported);
    assert!(own.join("bokeh/mi.json").is_file(), "{:?}", person.complaints());
    chooses(&mut person, "Bokeh preset", "mi");
    assert_eq!(person.document().camera.aperture.shape, heart.shape);
    assert!(person.complaints().is_empty(), "{:?}", person.complaints());
    // A file that is no preset is reported and changes nothing.
    std::fs::write(&exported, "{}").unwrap();
    person.drops(&exported);
    person.window.run_steps(3);
    assert!(
        person.complaints().iter().any(|text| text.contains("is no preset")),
        "{:?}",
        person.complaints()
    );
}
