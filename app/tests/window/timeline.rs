//! The timeline: keys set, shown, moved, visited, undone; a rack focus by two clicks; saving.

use crate::acting::{Person, at, difference};
use crate::small_scene::opened;
use document::CameraEdit;
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use focus::FocusTarget;
use focus_brush::window::Tool;
use session::{Command, CommandId};

impl Person {
    fn carries_out(&mut self, id: CommandId) {
        let context = self.window.ctx.clone();
        self.window.state_mut().run(id, &context);
        self.window.run_steps(3);
    }

    fn shows_time(&mut self, seconds: f64) {
        self.window.state_mut().apply(Command::GoToTime(seconds));
        self.waits();
    }

    fn focus_keys(&self) -> Vec<f64> {
        self.document().lens_motion.focus.keys().iter().map(|key| key.seconds).collect()
    }
}

#[test]
fn two_clicks_rack_the_focus() {
    let (mut person, _folder) = opened();
    person.presses(Modifiers::SHIFT, Key::K);
    assert_eq!(person.shell().tool(), Tool::RackFocus);
    let rect = person.picture_rect();
    person.clicks(at(rect, 0.25, 0.5));
    assert!(person.document().lens_motion.is_empty(), "one click is half of it");
    person.clicks(at(rect, 0.8, 0.5));
    assert_eq!(person.focus_keys(), [0.0, 1.0]);
    let is_point = |key: &focus::Key<FocusTarget>| matches!(key.value, FocusTarget::Point(_));
    assert!(person.document().lens_motion.focus.keys().iter().all(is_point));
    assert_eq!(person.document().undo_name(), Some("Rack focus"));
    // At the end, the wall (distance 5) is sharp; at the beginning, the card (distance 2).
    assert!((person.document().camera.focus_distance - 5.0).abs() < 1e-6);
    let far = person.picture();
    person.shows_time(0.0);
    assert!((person.document().camera.focus_distance - 2.0).abs() < 1e-6);
    assert!(difference(&person.picture(), &far) > 0.05, "the picture follows");
    person.shows_time(0.5);
    let between = 1.0 / person.document().camera.focus_distance;
    assert!((between - (0.5 + 0.2) / 2.0).abs() < 1e-9, "half way in the reciprocal");
    person.presses(Modifiers::COMMAND, Key::Z);
    assert!(person.document().lens_motion.is_empty());
    person.presses(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    assert_eq!(person.focus_keys(), [0.0, 1.0]);
    assert!(person.complaints().is_empty(), "{:?}", person.complaints());
}

#[test]
fn keys_are_set_gone_to_moved_and_saved() {
    let (mut person, folder) = opened();
    person.presses(Modifiers::NONE, Key::F4);
    let distance = |person: &mut Person, distance: f64| {
        person.window.state_mut().apply(Command::EditCamera(CameraEdit::FocusDistance(distance)));
        person.waits();
    };
    distance(&mut person, 2.0);
    person.presses(Modifiers::NONE, Key::Y);
    person.shows_time(2.0);
    distance(&mut person, 4.0);
    person.presses(Modifiers::NONE, Key::Y);
    assert_eq!(person.focus_keys(), [0.0, 2.0]);
    assert_eq!(person.document().lens_motion.f_number.keys().len(), 2);

    // A click on a key moves the time there.
    person.window.get_by_label("Focus key at 0.00 s").click();
    person.waits();
    assert_eq!((person.document().seconds, person.document().camera.focus_distance), (0.0, 2.0));
    // A drag of a key moves it, as one step.
    let key = person.window.get_by_label("Focus key at 2.00 s").rect().center();
    let timeline = person.window.get_by_label("Keys over time").rect();
    let to = egui::pos2(key.x + timeline.width() * 0.2, key.y);
    person.paints(&[key, egui::pos2((key.x + to.x) / 2.0, key.y), to]);
    let moved = person.focus_keys()[1];
    assert!(moved > 2.3 && (moved * 24.0 - (moved * 24.0).round()).abs() < 1e-9, "to a frame: {moved}");
    assert_eq!(person.document().undo_name(), Some("Move key"));
    // A drag beside the keys scrubs, which is no undo step.
    let ruler = |x: f32| egui::pos2(timeline.left() + timeline.width() * x, timeline.top() + 6.0);
    let steps = person.document().undo_names().count();
    person.paints(&[ruler(0.3), ruler(0.4), ruler(0.5)]);
    assert!(person.document().seconds > 0.5);
    assert_eq!(person.document().undo_names().count(), steps);

    // Playback advances the time.
    person.carries_out(CommandId::PlayTimeline);
    let before = person.document().seconds;
    person.window.run_steps(5);
    assert_ne!(person.document().seconds, before);
    person.carries_out(CommandId::PlayTimeline);

    let file = folder.path().join("racked.fbrush");
    let motion = person.document().lens_motion.clone();
    person.window.state_mut().apply(Command::SaveAs(file.clone()));
    person.waits();
    assert_eq!(project::ProjectFile::load(&file).unwrap().lens_motion, motion);
    assert!(person.complaints().is_empty(), "{:?}", person.complaints());
}

#[test]
fn a_layer_fades_as_its_keys_say() {
    let (mut person, _folder) = opened();
    person.carries_out(CommandId::AddLayer);
    let region = document::FillRegion::All;
    person.window.state_mut().apply(Command::Fill(region, lens::FocusOffset::new(1.2, 1.0)));
    let opacity = |person: &mut Person, opacity: f64| {
        let index = person.document().layers.active_index();
        person.window.state_mut().apply(Command::EditLayers(focus::LayerEdit::Opacity(index, opacity)));
        person.presses(Modifiers::SHIFT, Key::Y);
    };
    opacity(&mut person, 1.0);
    person.shows_time(1.0);
    opacity(&mut person, 0.0);
    person.waits();
    let without = person.picture();
    person.shows_time(0.0);
    assert_eq!(person.document().layers.active().opacity, 1.0);
    assert!(difference(&person.picture(), &without) > 0.01);
    person.shows_time(0.5);
    assert_eq!(person.document().layers.active().opacity, 0.5, "half of a smooth way");
    person.shows_time(1.0);
    assert_eq!(difference(&person.picture(), &without), 0.0);
    assert!(person.complaints().is_empty(), "{:?}", person.complaints());
}
