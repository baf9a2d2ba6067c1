//! Ten thousand random edits, undone and done again, against a model that only remembers what the state was.

mod tiny_glb;

use document::{CameraEdit, FillRegion, StrokePoint};
use focus::{Brush, BrushMode, CombineMode, Gradient, GradientLine, GradientShape, LayerEdit};
use glam::{DVec2, DVec3};
use lens::FocusOffset;
use project::SelectionShape;
use session::{Command, Session, SessionOptions};
use std::time::{Duration, Instant};
use test_scenes::Random;

/// Memory that the steps may keep alive here: a few hundred of them.
const BUDGET_BYTES: usize = 8 << 20;

fn random_focus(random: &mut Random) -> FocusOffset {
    FocusOffset::new(0.8 + 0.4 * random.unit(), random.below(3) as f64 / 2.0)
}

/// All that undo is about, as one number.
fn hash(session: &Session) -> u64 {
    let document = session.document().unwrap();
    let mut hash = 0u64;
    let mut eat = |word: u64| hash = (hash.rotate_left(5) ^ word).wrapping_mul(0x517C_C1B7_2722_0A95);
    let bits = |t: f32, a: f32| u64::from(t.to_bits()) << 32 | u64::from(a.to_bits());
    document.map.to_rows().iter().for_each(|&[t, a]| eat(bits(t, a)));
    for layer in document.layers.layers() {
        layer.map.to_rows().iter().for_each(|&[t, a]| eat(bits(t, a)));
        layer.map.mask_rows().iter().flatten().for_each(|&m| eat(u64::from(m.to_bits())));
        eat(layer.map.background.t.to_bits() ^ layer.map.background.anchor.to_bits().rotate_left(7));
        eat(u64::from(layer.map.background_mask.to_bits()));
        eat(layer.opacity.to_bits());
        eat(layer.blend as u64 * 2 + u64::from(layer.is_visible));
        layer.name.bytes().for_each(|byte| eat(u64::from(byte)));
    }
    eat(document.camera.focus_distance.to_bits());
    eat(document.camera.aperture_radius.to_bits());
    format!("{:?}", document.focus_hold).bytes().for_each(|byte| eat(u64::from(byte)));
    let texels = document.stage.canvas.texels().len();
    if let Some(selection) = &document.selection {
        (0..texels).for_each(|index| eat(u64::from(selection.contains(index))));
    }
    hash
}

fn ray_point(session: &Session, at: DVec2) -> StrokePoint {
    StrokePoint::from_ray(session.picture_ray(at).unwrap())
}

/// Does something. Most of it changes something.
fn edit(session: &mut Session, random: &mut Random) {
    let at = DVec2::new(random.unit(), random.unit());
    let hit = session.pick(&session.picture_ray(at).unwrap());
    let layers = session.document().unwrap().layers.layers().len();
    let layer = random.below(layers as u64) as usize;
    // Some of these cannot be done as things are: on a hidden layer, or where nothing would be left to paint on.
    let _ = match (random.below(16), hit) {
        (0..=5, _) => {
            let modes = [BrushMode::Set, BrushMode::Add, BrushMode::Smooth, BrushMode::Reset];
            let mode = modes[random.below(4) as usize];
            let (radius, target) = (0.1 + 0.4 * random.unit(), random_focus(random));
            let mirror = [random.below(4) == 0, false, false];
            let brush = Brush { radius, mode, target, mirror, ..Brush::default() };
            session.apply(Command::SetBrush(brush)).unwrap();
            let began = session.apply(Command::BeginStroke(ray_point(session, at)));
            let to = DVec2::new(random.unit(), random.unit());
            let _ = session.apply(Command::ExtendStroke(ray_point(session, to)));
            let end = if random.below(8) == 0 { Command::AbortStroke } else { Command::CommitStroke };
            session.apply(end).unwrap();
            began
        }
        (6, Some(hit)) => session.apply(Command::Fill(FillRegion::Node(hit), random_focus(random))),
        (7, _) => session.apply(Command::SetBackgroundFocus(random_focus(random))),
        (8, _) => {
            let line = GradientLine::World([DVec3::ZERO, DVec3::new(random.unit(), 0.1, -4.0)]);
            let (from, to) = (random_focus(random), Some(random_focus(random)));
            let shape = GradientShape::Linear;
            let gradient = Gradient { shape, line, from, to, symmetry: Default::default() };
            let _ = session.apply(Command::DragGradient(Gradient { from: to.unwrap(), ..gradient }));
            let drawn = session.apply(Command::DragGradient(gradient));
            session.apply(Command::CommitStroke).unwrap();
            drawn
        }
        (9, Some(hit)) => session.apply(Command::SelectRegion(FillRegion::Node(hit), CombineMode::Add)),
        (10, _) => session.apply(Command::Select(SelectionShape::Everything, CombineMode::Replace)),
        (11, _) if layers < 5 => session.apply(Command::EditLayers(LayerEdit::AddPaint)),
        (11, _) => session.apply(Command::EditLayers(LayerEdit::Remove(layer))),
        (12, _) => session.apply(Command::EditLayers(LayerEdit::Opacity(layer, random.unit()))),
        (13, _) => session.apply(Command::EditLayers(LayerEdit::Visible(layer, random.below(3) > 0))),
        (14, _) => session.apply(Command::EditLayers(LayerEdit::Shift { from: layer, to: 0 })),
        (15, _) => session.apply(Command::EditCamera(CameraEdit::FocusDistance(1.0 + random.unit()))),
        _ => session.apply(Command::ActivateLayer(layer)),
    };
    session.apply(Command::FinishEdit).unwrap();
}

#[test]
fn ten_thousand_edits_undos_and_redos_leave_what_a_model_expects() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("quads.glb");
    tiny_glb::write(&path);
    let options = SessionOptions {
        unwrap: atlas::UnwrapOptions { density: atlas::Density::Side(48), ..Default::default() },
        preview_size: 4,
        undo_budget_bytes: BUDGET_BYTES,
        // No recovery file is written meanwhile.
        recovery_delay: Duration::from_secs(3600),
        ..SessionOptions::default()
    };
    let mut session = Session::new(options).unwrap();
    session.apply(Command::Open(path)).unwrap();
    let start = Instant::now();
    while session.document().is_none() {
        assert!(start.elapsed() < Duration::from_secs(60), "it opens");
        session.poll();
        std::thread::sleep(Duration::from_millis(2));
    }
    // Only painting counts here, not pictures.
    session.apply(Command::CancelAll).unwrap();
    let mut random = Random(2026);
    let mut states = vec![hash(&session)];
    let (mut at, mut forgotten, mut undone, mut redone) = (0, false, 0, 0);
    for k in 0..10_000 {
        let document = session.document().unwrap();
        let (can_undo, can_redo) = (document.undo_name().is_some(), document.redo_name().is_some());
        // Runs of undo and redo as well as single ones.
        match random.below(10) {
            0..=4 => {
                edit(&mut session, &mut random);
                let state = hash(&session);
                if state != states[at] {
                    states.truncate(at + 1);
                    states.push(state);
                    at += 1;
                }
            }
            5..=7 => {
                session.apply(Command::Undo).unwrap();
                at -= usize::from(can_undo);
                undone += usize::from(can_undo);
            }
            _ => {
                session.apply(Command::Redo).unwrap();
                at += usize::from(can_redo);
                redone += usize::from(can_redo);
            }
        }
        assert_eq!(hash(&session), states[at], "after {k} edits");
        let [held, budget] = session.document().unwrap().undo_bytes();
        assert!(held <= budget && budget == BUDGET_BYTES, "{held} of {budget}");
        forgotten |= session.document().unwrap().undo_names().count() < at;
        session.poll();
    }
    assert!(undone > 1000 && redone > 500, "{undone} undone, {redone} redone");
    // Straight on, without turning back, the budget makes it forget the oldest; what it holds is still right.
    for _ in 0..1500 {
        edit(&mut session, &mut random);
        let state = hash(&session);
        if state != states[at] {
            states.truncate(at + 1);
            states.push(state);
            at += 1;
        }
        let [held, budget] = session.document().unwrap().undo_bytes();
        assert!(held <= budget, "{held} of {budget}");
    }
    let kept = session.document().unwrap().undo_names().count();
    forgotten |= kept < at;
    assert!(forgotten && kept > 50, "{kept} of {at} are kept");
    for back in 1..=kept {
        session.apply(Command::Undo).unwrap();
        assert_eq!(hash(&session), states[at - back], "{back} back");
    }
    assert_eq!(session.document().unwrap().undo_name(), None);
    for back in (0..kept).rev() {
        session.apply(Command::Redo).unwrap();
        assert_eq!(hash(&session), states[at - back]);
    }
}
