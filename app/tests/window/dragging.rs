//! Tools other than the brush: gradients, selections, symmetric fills, cloning.

use crate::acting::{Person, at, color_at, difference};
use crate::small_scene;
use egui::{Event, Key, Modifiers, PointerButton, Pos2};
use lens::FocusOffset;
use session::{Command, CommandId};

/// The small scene, with far blur on the brush.
fn opened() -> (Person, tempfile::TempDir) {
    let (mut person, folder) = small_scene::opened();
    for _ in 0..12 {
        person.presses(Modifiers::NONE, Key::Period);
    }
    (person, folder)
}

fn focus_at(person: &Person, x: f64, y: f64) -> FocusOffset {
    let session = person.shell().session();
    let hit = session.pick(&session.picture_ray(glam::DVec2::new(x, y)).unwrap()).unwrap();
    session.focus_at(&hit).unwrap()
}

impl Person {
    fn chooses(&mut self, id: CommandId) {
        let context = self.window.ctx.clone();
        self.window.state_mut().run(id, &context);
        self.window.run_steps(2);
    }

    /// A complete drag with modifier keys.
    fn drags_holding(&mut self, modifiers: Modifiers, path: &[Pos2]) {
        self.window.event(Event::ModifiersChanged(modifiers));
        self.window.hover_at(path[0]);
        self.window.step();
        let button =
            |pos, pressed| Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers };
        self.window.event(button(path[0], true));
        self.window.step();
        for at in path {
            self.window.hover_at(*at);
            self.window.step();
        }
        self.window.event(button(path[path.len() - 1], false));
        self.window.step();
        self.window.event(Event::ModifiersChanged(Modifiers::NONE));
        self.waits();
    }
}

#[test]
fn a_gradient_shows_while_it_is_dragged_and_is_one_step() {
    let (mut person, _folder) = opened();
    let (map, target) = (person.document().map.clone(), person.document().brush.target);
    person.presses(Modifiers::NONE, Key::D);
    let rect = person.picture_rect();
    let path: Vec<_> = (0..=4).map(|k| at(rect, 0.55 + 0.1 * k as f32, 0.5)).collect();
    person.drags(&path);
    person.window.step();
    assert!(person.shell().session().is_painting());
    assert_ne!(person.document().map, map, "it shows before the button is let go");
    // Another end: replaces the previous gradient.
    person.window.hover_at(at(rect, 0.85, 0.5));
    person.window.run_steps(2);
    person.lets_go(at(rect, 0.85, 0.5));
    person.waits();
    assert_eq!(person.document().undo_names().collect::<Vec<_>>(), ["Gradient"]);
    assert!((focus_at(&person, 0.5, 0.9).t - target.t).abs() < 1e-6, "all of it before the start");
    let half = focus_at(&person, 0.7, 0.9);
    assert!(
        (half.t - (1.0 + target.t) / 2.0).abs() < 0.02 * (target.t - 1.0),
        "half way: {half:?} {target:?}"
    );
    assert_eq!(focus_at(&person, 0.9, 0.9), FocusOffset::STANDARD, "what was there beyond the end");
    let drawn = person.document().map.clone();
    person.presses(Modifiers::COMMAND, Key::Z);
    assert_eq!(person.document().map, map);
    person.presses(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    assert_eq!(person.document().map, drawn);

    // Esc cancels an active one.
    person.drags(&[path[0], path[1], at(rect, 0.6, 0.1)]);
    person.window.step();
    assert_ne!(person.document().map, drawn);
    person.presses(Modifiers::NONE, Key::Escape);
    assert_eq!(person.document().map, drawn);
    person.lets_go(path[2]);
    person.waits();
    assert_eq!((person.document().map.clone(), person.document().undo_names().count()), (drawn, 1));
    assert!(person.complaints().is_empty(), "{:?}", person.complaints());
}

#[test]
fn only_what_is_selected_is_painted_and_it_shows() {
    let (mut person, _folder) = opened();
    let (blank, target) = (person.document().map.clone(), person.document().brush.target);
    person.presses(Modifiers::SHIFT, Key::L);
    let rect = person.picture_rect();
    person.window.remove_cursor();
    person.window.run_steps(2);
    let bare = person.window.render().unwrap();
    let corner = [at(rect, 0.6, 0.1), at(rect, 0.7, 0.3), at(rect, 0.8, 0.9)];
    person.drags_holding(Modifiers::NONE, &corner);
    assert_eq!(person.document().undo_name(), Some("Select"));
    assert!(!person.document().is_unsaved(), "a selection is no change of what is saved");
    person.window.remove_cursor();
    person.window.run_steps(2);
    let striped = person.window.render().unwrap();
    let paint = person.paint_rect();
    let (frozen, free) = (at(paint, 0.3, 0.5), at(paint, 0.7, 0.5));
    let darker = |p: Pos2| color_at(&bare, p)[1] - color_at(&striped, p)[1];
    assert!(darker(frozen) > 20.0 && darker(free).abs() < 1.0, "{} {}", darker(frozen), darker(free));

    // A stroke, a fill and a gradient stay within the selection.
    person.presses(Modifiers::NONE, Key::B);
    let across: Vec<_> = (0..=10).map(|k| at(rect, 0.45 + 0.05 * k as f32, 0.8)).collect();
    person.paints(&across);
    assert!((focus_at(&person, 0.7, 0.8).t - target.t).abs() < 1e-4);
    assert_eq!([0.5, 0.9].map(|x| focus_at(&person, x, 0.8)), [FocusOffset::STANDARD; 2]);
    person.chooses(CommandId::FillAll);
    assert!((focus_at(&person, 0.65, 0.2).t - target.t).abs() < 1e-4);
    assert_eq!(focus_at(&person, 0.25, 0.5), FocusOffset::STANDARD);

    // Ctrl subtracts, Shift adds, Ctrl+I inverts, Everything clears.
    person.presses(Modifiers::SHIFT, Key::L);
    person.drags_holding(Modifiers::COMMAND, &[at(rect, 0.5, 0.0), at(rect, 0.6, 0.2), at(rect, 0.9, 0.5)]);
    let count = |person: &Person| person.document().selection.as_ref().map_or(0, focus::Selection::count);
    let lower = count(&person);
    person.drags_holding(Modifiers::SHIFT, &[at(rect, 0.5, 0.0), at(rect, 0.6, 0.2), at(rect, 0.9, 0.5)]);
    assert!(count(&person) > lower);
    let all = person.document().stage.canvas.texels().len();
    let before = count(&person);
    person.presses(Modifiers::COMMAND, Key::I);
    assert_eq!(count(&person), all - before);
    person.presses(Modifiers::ALT, Key::A);
    assert_eq!(person.document().selection, None);
    for _ in 0..person.document().undo_names().count() {
        person.presses(Modifiers::COMMAND, Key::Z);
    }
    person.waits();
    assert_eq!((&person.document().map, &person.document().selection), (&blank, &None));
    assert!(person.complaints().is_empty(), "{:?}", person.complaints());
}

#[test]
fn selections_by_object_facing_and_depth_and_a_mask_of_them() {
    let (mut person, _folder) = opened();
    let rect = person.picture_rect();
    let (card, wall) = (at(rect, 0.25, 0.5), at(rect, 0.75, 0.5));
    let all = person.document().stage.canvas.texels().len();
    let selected = |person: &Person| {
        let document = person.document();
        let selection = document.selection.as_ref().expect("something is selected");
        let texels = document.stage.canvas.texels().enumerate();
        let depths: Vec<f64> =
            texels.filter(|(k, _)| selection.contains(*k)).map(|(_, texel)| -texel.position.z).collect();
        depths
    };
    person.presses(Modifiers::NONE, Key::O);
    person.clicks(card);
    let on_card = selected(&person);
    assert!(on_card.len() < all && on_card.iter().all(|depth| (depth - 2.0).abs() < 1e-5));
    person.chooses(CommandId::SelectMaterial);
    person.clicks(wall);
    assert!(selected(&person).iter().all(|depth| (depth - 5.0).abs() < 1e-5));
    person.chooses(CommandId::SelectFacing);
    person.clicks(wall);
    assert_eq!(person.document().selection, None, "all of it faces the camera");
    person.chooses(CommandId::SelectDepth);
    person.drags_holding(Modifiers::NONE, &[card, at(rect, 0.26, 0.5), at(rect, 0.28, 0.52)]);
    assert!(selected(&person) == on_card, "the card's depth");

    person.presses(Modifiers::COMMAND | Modifiers::SHIFT, Key::N);
    person.chooses(CommandId::MaskFromSelection);
    person.window.state_mut().apply(Command::Select(project::SelectionShape::Everything, Default::default()));
    let layer = &person.document().layers.active().map;
    let masked = person.document().stage.canvas.texels().filter(|t| layer.mask_at(t.x, t.y) == 1.0);
    assert_eq!(masked.count(), on_card.len());
    assert!(person.complaints().is_empty(), "{:?}", person.complaints());
}

#[test]
fn a_curve_through_clicked_points_is_one_stroke() {
    let (mut person, _folder) = opened();
    let (rect, target) = (person.picture_rect(), person.document().brush.target);
    person.presses(Modifiers::SHIFT, Key::B);
    for (x, y) in [(0.55, 0.2), (0.7, 0.8), (0.9, 0.2)] {
        person.clicks(at(rect, x, y));
        person.window.run_steps(8);
    }
    assert_eq!(person.document().undo_name(), None, "nothing is painted yet");
    person.presses(Modifiers::NONE, Key::Enter);
    person.waits();
    assert_eq!(person.document().undo_names().collect::<Vec<_>>(), ["Brush stroke"]);
    for (x, y) in [(0.55, 0.2), (0.7, 0.8), (0.9, 0.2)] {
        assert!((focus_at(&person, x, y).t - target.t).abs() < 1e-4, "through {x} {y}");
    }
    assert_eq!(focus_at(&person, 0.72, 0.2), FocusOffset::STANDARD, "but not straight across");
    person.clicks(at(rect, 0.6, 0.9));
    person.presses(Modifiers::NONE, Key::Escape);
    person.presses(Modifiers::NONE, Key::Enter);
    assert_eq!(person.document().undo_names().count(), 1, "given up");
}

#[test]
fn cloning_paints_the_focus_of_another_place() {
    let (mut person, _folder) = opened();
    let rect = person.picture_rect();
    let target = person.document().brush.target;
    person.clicks(at(rect, 0.7, 0.2));
    person.presses(Modifiers::NONE, Key::K);
    person.clicks(at(rect, 0.7, 0.8));
    assert!(person.complaints().iter().any(|text| text.contains("Ctrl+click")), "{:?}", person.complaints());
    let picture = person.picture();
    person.drags_holding(Modifiers::COMMAND, &[at(rect, 0.7, 0.2)]);
    assert_eq!(difference(&person.picture(), &picture), 0.0, "taking a place paints nothing");
    person.clicks(at(rect, 0.7, 0.8));
    assert!((focus_at(&person, 0.7, 0.8).t - target.t).abs() < 1e-3, "{:?}", focus_at(&person, 0.7, 0.8));
    assert_eq!(person.document().undo_name(), Some("Clone stroke"));
}
