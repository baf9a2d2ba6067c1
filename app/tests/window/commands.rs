//! Every command of the table runs; commands that are undo steps are undone bit for bit, the others add no
//! step.

use crate::acting::Person;
use crate::small_scene;
use document::FillRegion;
use egui::{Key, Modifiers};
use focus::{CombineMode, LayerEdit, LayerStack, Selection};
use lens::{Camera, FocusOffset};
use project::SelectionShape;
use session::{COMMANDS, Command, CommandId};

/// The state covered by undo.
#[derive(Clone, PartialEq)]
struct State {
    layers: LayerStack,
    map: focus::FocusMap,
    camera: Camera,
    lens_motion: focus::LensMotion,
    selection: Option<Selection>,
}

fn state(person: &Person) -> State {
    let document = person.document();
    let mut layers = document.layers.clone();
    // The active layer is not part of it.
    layers.activate(0);
    State {
        layers,
        map: document.map.clone(),
        camera: document.camera.clone(),
        lens_motion: document.lens_motion.clone(),
        selection: document.selection.clone(),
    }
}

fn steps(person: &Person) -> usize {
    person.document().undo_names().count()
}

/// A document in which every command is possible: three layers, of which the middle one is active and masked,
/// some paint, and a selection.
fn prepare(person: &mut Person) {
    let shell = person.window.state_mut();
    for _ in 0..2 {
        shell.apply(Command::EditLayers(LayerEdit::AddPaint));
        shell.apply(Command::Fill(FillRegion::All, FocusOffset::new(1.1, 1.0)));
    }
    shell.apply(Command::ActivateLayer(1));
    let hit = |shell: &focus_brush::window::Shell| {
        let session = shell.session();
        session.pick(&session.picture_ray(glam::DVec2::new(0.25, 0.5)).unwrap()).unwrap()
    };
    let card = hit(shell);
    shell.apply(Command::SelectRegion(FillRegion::Node(card), CombineMode::Replace));
}

#[test]
fn every_command_runs_and_is_undone_or_has_nothing_to_undo() {
    let (mut person, _folder) = small_scene::opened();
    prepare(&mut person);
    for info in COMMANDS {
        let id = info.id;
        // These have tests of their own: they close the window, or open another document.
        use CommandId::{Open, OpenCapture, OpenDemo, Quit};
        // The book's pages are made by a chore, and opened by a browser.
        if matches!(id, Quit | Open | OpenCapture | OpenDemo | CommandId::Book) {
            continue;
        }
        // These are steps of undo once work in the background is done.
        use CommandId::{RefineSelection, ShowStrokes, SpreadStrokes};
        // There are no splats to hide or show; `session` tries that on some.
        use CommandId::{HideSelectedSplats, ShowAllSplats};
        if matches!(id, RefineSelection | ShowStrokes | SpreadStrokes | HideSelectedSplats | ShowAllSplats) {
            continue;
        }
        // An existing mask cannot be added.
        if id == CommandId::AddMask {
            person.window.state_mut().apply(Command::EditLayers(LayerEdit::RemoveMask(1)));
        }
        // The shot camera must not be there already.
        if id == CommandId::CameraFromView {
            let context = person.window.ctx.clone();
            person.window.state_mut().run(CommandId::FrameAll, &context);
        }
        // Only existing keys can be removed.
        if id == CommandId::RemoveKeys {
            let context = person.window.ctx.clone();
            person.window.state_mut().run(CommandId::KeyLens, &context);
        }
        let (before, count) = (state(&person), steps(&person));
        let context = person.window.ctx.clone();
        person.window.state_mut().run(id, &context);
        person.window.run_steps(2);
        if id.is_undoable() {
            assert_eq!(steps(&person), count + 1, "{}: a step of undo", info.name);
            let after = state(&person);
            assert!(after != before, "{}: changes something", info.name);
            person.window.state_mut().apply(Command::Undo);
            assert!(state(&person) == before, "{}: undone", info.name);
            person.window.state_mut().apply(Command::Redo);
            assert!(state(&person) == after, "{}: done again", info.name);
            person.window.state_mut().apply(Command::Undo);
        } else if !matches!(id, CommandId::Undo | CommandId::Redo) {
            assert!(state(&person) == before, "{}: changes nothing that could be undone", info.name);
            assert_eq!(steps(&person), count, "{}: nothing to undo", info.name);
        }
        assert!(person.complaints().is_empty(), "{}: {:?}", info.name, person.complaints());
        // Close everything that it opened.
        person.presses(Modifiers::NONE, Key::Escape);
        if id == CommandId::AddMask {
            person.window.state_mut().apply(Command::EditLayers(LayerEdit::AddMask(1)));
        }
        let shell = person.window.state_mut();
        match id {
            CommandId::Shortcuts
            | CommandId::About
            | CommandId::ShowInspector
            | CommandId::EnlargePanel
            | CommandId::FloatPanel => shell.run(id, &context),
            // No background work, to keep the test quick.
            CommandId::Bake | CommandId::RenderTruth => shell.apply(Command::CancelAll),
            CommandId::LayerAbove | CommandId::LayerBelow => shell.apply(Command::ActivateLayer(1)),
            CommandId::Undo => shell.apply(Command::Redo),
            _ => {}
        }
    }
    assert_eq!(person.document().layers.active_index(), 1);
}

#[test]
fn a_hundred_edits_are_undone_and_done_again_to_the_bit() {
    let (mut person, _folder) = small_scene::opened();
    let mut states = vec![state(&person)];
    let rect = person.picture_rect();
    for k in 0..100 {
        let along = |m: f32| crate::acting::at(rect, 0.1 + 0.008 * k as f32 + m, 0.2 + 0.6 * m);
        match k % 5 {
            // Explicitly: overlapping strokes with changes of lens and blur in between.
            0 | 1 => {
                person.presses(Modifiers::NONE, if k % 2 == 0 { Key::Period } else { Key::Comma });
                let path = [along(0.0), along(0.1), along(0.2)];
                person.drags(&path);
                person.lets_go(path[2]);
            }
            2 => person.presses(Modifiers::NONE, if k % 10 == 2 { Key::Plus } else { Key::Minus }),
            3 => {
                let normal = glam::DVec3::new(k as f64 % 2.0, 0.0, 1.0).normalize();
                let half =
                    SelectionShape::Depth { origin: glam::DVec3::ZERO, axis: normal, range: [-4.0, 9.0] };
                let shape = if k % 10 == 3 { half } else { SelectionShape::Everything };
                person.window.state_mut().apply(Command::Select(shape, CombineMode::Replace));
            }
            _ => {
                let shell = person.window.state_mut();
                shell.apply(Command::Fill(FillRegion::All, FocusOffset::new(1.0 + 1e-3 * k as f64, 0.5)));
            }
        }
        if steps(&person) == states.len() {
            states.push(state(&person));
        }
    }
    let done = states.len() - 1;
    assert!(done > 60, "{done} of the hundred changed something");
    while states.len() <= 100 {
        let opacity = 0.5 + 1e-3 * states.len() as f64;
        person.window.state_mut().apply(Command::EditLayers(LayerEdit::Opacity(0, opacity)));
        person.window.state_mut().apply(Command::FinishEdit);
        states.push(state(&person));
    }
    assert_eq!(steps(&person), 100);
    for expected in states.iter().rev().skip(1) {
        person.presses(Modifiers::COMMAND, Key::Z);
        assert!(state(&person) == *expected);
    }
    assert_eq!(person.document().undo_name(), None);
    for expected in &states[1..] {
        person.presses(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
        assert!(state(&person) == *expected);
    }
    assert!(person.complaints().is_empty(), "{:?}", person.complaints());
}
