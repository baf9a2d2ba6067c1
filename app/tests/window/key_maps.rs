//! The three key maps: keys, mouse buttons, persistence; and adjusting the brush at the pointer.

use crate::acting::{Person, at};
use crate::small_scene::opened;
use egui::{Event, Key, Modifiers, PointerButton, Pos2};
use focus_brush::window::{Tool, ViewSettings};
use session::{CommandId, KeyMap};

impl Person {
    fn runs(&mut self, id: CommandId) {
        let context = self.window.ctx.clone();
        self.window.state_mut().run(id, &context);
        self.window.run_steps(2);
    }

    /// Drags with any button and modifier keys.
    fn drags_with(&mut self, button: PointerButton, modifiers: Modifiers, space: bool, path: [Pos2; 2]) {
        let key =
            |pressed| Event::Key { key: Key::Space, physical_key: None, pressed, repeat: false, modifiers };
        self.window.event(Event::ModifiersChanged(modifiers));
        if space {
            self.window.event(key(true));
        }
        self.window.hover_at(path[0]);
        self.window.step();
        for (pos, pressed) in [(path[0], true), (path[1], false)] {
            for share in [0.5, 1.0] {
                if !pressed {
                    self.window.hover_at(path[0].lerp(path[1], share));
                    self.window.step();
                }
            }
            self.window.event(Event::PointerButton { pos, button, pressed, modifiers });
            self.window.step();
        }
        if space {
            self.window.event(key(false));
        }
        self.window.event(Event::ModifiersChanged(Modifiers::NONE));
        self.window.run_steps(2);
    }
}

#[test]
fn each_map_has_its_keys_and_its_mouse() {
    let (mut person, _folder) = opened();
    let map = person.document().map.clone();
    assert_eq!(person.shell().settings().key_map, KeyMap::Blender);
    person.runs(CommandId::KeysSubstance);
    person.presses(Modifiers::NONE, Key::Num4);
    assert_eq!(person.shell().tool(), Tool::FillObject);
    person.presses(Modifiers::NONE, Key::Num1);
    assert_eq!(person.shell().tool(), Tool::Brush);
    person.runs(CommandId::KeysKrita);
    person.presses(Modifiers::NONE, Key::G);
    assert_eq!(person.shell().tool(), Tool::Gradient);
    person.presses(Modifiers::NONE, Key::B);

    let rect = person.paint_rect();
    let path = [at(rect, 0.4, 0.5), at(rect, 0.6, 0.55)];
    // Effect of a drag: orbit (direction), pan (pivot), or dolly (distance).
    let mut motion = |map: CommandId, button, modifiers, space| {
        person.runs(map);
        let before = *person.shell().paint_view().camera();
        person.drags_with(button, modifiers, space, path);
        let after = *person.shell().paint_view().camera();
        match () {
            () if before.orientation != after.orientation => "turns",
            () if before.pivot != after.pivot => "slides",
            () if before.distance != after.distance => "nears",
            () => "paints",
        }
    };
    use PointerButton::{Middle, Primary, Secondary};
    let (none, shift, alt) = (Modifiers::NONE, Modifiers::SHIFT, Modifiers::ALT);
    for map in [CommandId::KeysBlender, CommandId::KeysSubstance, CommandId::KeysKrita] {
        assert_eq!(motion(map, Primary, alt, false), "turns", "a pen has one button: {map:?}");
    }
    assert_eq!(motion(CommandId::KeysBlender, Middle, none, false), "turns");
    assert_eq!(motion(CommandId::KeysBlender, Middle, shift, false), "slides");
    assert_eq!(motion(CommandId::KeysBlender, Middle, Modifiers::COMMAND, false), "nears");
    assert_eq!(motion(CommandId::KeysBlender, Primary, none, true), "turns");
    assert_eq!(motion(CommandId::KeysSubstance, Middle, alt, false), "slides");
    assert_eq!(motion(CommandId::KeysSubstance, Secondary, alt, false), "nears");
    assert_eq!(motion(CommandId::KeysKrita, Middle, none, false), "slides");
    assert_eq!(motion(CommandId::KeysKrita, Primary, none, true), "slides");
    assert_eq!(motion(CommandId::KeysKrita, Primary, shift, true), "turns");
    assert_eq!(person.document().map, map, "none of them paints");
}

#[test]
fn the_same_drags_move_the_camera_in_the_picture_and_space_the_picture() {
    let (mut person, _folder) = opened();
    let rect = person.picture_rect();
    let path = [at(rect, 0.4, 0.5), at(rect, 0.5, 0.55)];
    let start = person.document().held_camera();
    person.drags_with(PointerButton::Middle, Modifiers::NONE, false, path);
    let turned = person.document().held_camera();
    assert_ne!(turned.camera.camera_to_world, start.camera.camera_to_world);
    assert_eq!(turned.focus_hold, start.focus_hold, "the focus stays where it was");
    person.drags_with(PointerButton::Middle, Modifiers::COMMAND, false, path);
    let near = person.document().held_camera();
    assert_ne!(near.camera.position(), turned.camera.position());
    person.presses(Modifiers::COMMAND, Key::Z);
    assert_eq!(person.document().held_camera(), turned, "a drag is one step");
    person.presses(Modifiers::COMMAND, Key::Z);
    assert_eq!(person.document().held_camera(), start);
    person.drags_with(PointerButton::Primary, Modifiers::NONE, true, path);
    assert_eq!(person.document().held_camera(), start);
    assert_ne!(person.picture_rect(), rect, "Space slides the picture");
    person.runs(CommandId::PictureFit);
    person.runs(CommandId::BookmarkCamera);
    assert_eq!(person.document().bookmarks().count(), 1);
}

#[test]
fn the_key_map_is_kept_between_starts() {
    let (mut person, _folder) = opened();
    person.runs(CommandId::KeysKrita);
    let kept = serde_json::to_string(person.shell().settings()).unwrap();
    let settings: ViewSettings = serde_json::from_str(&kept).unwrap();
    assert_eq!(settings.key_map, KeyMap::Krita);
    assert_eq!(&settings, person.shell().settings());
    let of_an_older_version: ViewSettings = serde_json::from_str("{}").unwrap();
    assert_eq!(of_an_older_version.key_map, KeyMap::Blender);
}

#[test]
fn f_sets_the_size_by_the_mouse_or_by_digits_and_shift_f_the_strength() {
    let (mut person, _folder) = opened();
    let map = person.document().map.clone();
    let radius = |person: &Person| person.document().brush.radius;
    let first = radius(&person);
    let rect = person.paint_rect();
    person.window.hover_at(at(rect, 0.4, 0.5));
    person.window.step();
    person.presses(Modifiers::NONE, Key::F);
    person.window.hover_at(at(rect, 0.4, 0.5) + egui::vec2(60.0, 0.0));
    person.window.run_steps(2);
    assert!((radius(&person) / first - 2f64.sqrt()).abs() < 1e-6, "half a doubling: {}", radius(&person));
    person.presses(Modifiers::NONE, Key::Escape);
    assert_eq!(radius(&person), first, "Esc takes it back");

    person.presses(Modifiers::NONE, Key::F);
    person.window.hover_at(at(rect, 0.4, 0.5));
    person.window.run_steps(2);
    let smaller = radius(&person);
    assert!(smaller < first);
    person.clicks(at(rect, 0.4, 0.5));
    person.window.hover_at(at(rect, 0.2, 0.5));
    person.window.run_steps(2);
    assert_eq!(radius(&person), smaller, "a click keeps it");
    assert_eq!(person.document().map, map, "and paints nothing");

    person.presses(Modifiers::NONE, Key::F);
    for digit in ["0", ".", "2", "5"] {
        person.window.event(Event::Text(digit.into()));
    }
    person.presses(Modifiers::NONE, Key::Enter);
    assert_eq!(radius(&person), 0.25);
    person.presses(Modifiers::SHIFT, Key::F);
    person.window.event(Event::Text("0.3".into()));
    person.presses(Modifiers::NONE, Key::Backspace);
    person.window.event(Event::Text("4".into()));
    person.presses(Modifiers::NONE, Key::Enter);
    assert_eq!(person.document().brush.strength, 0.4);
    assert_eq!(radius(&person), 0.25);
    assert!(person.document().undo_name().is_none(), "the brush is no part of the history");
}
