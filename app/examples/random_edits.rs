//! Makes random edits of all kinds, undoes and redoes about half of them, and compares with what the state was.
//!
//! ```text
//! random_edits FILE SEED COUNT
//! ```
//!
//! FILE is a scene, a project, or a picture with depth. Prints a line for the first state that undo or redo does not
//! bring back bit for bit, and then ends with exit code 1.

use document::{CameraEdit, DepthRepair, DepthStroke, FillRegion, StrokePoint, StrokeTarget, SurfaceHit};
use focus::{
    Adjustment, BlendMode, Brush, BrushMode, Channels, CombineMode, Curve, DepthCurve, Ease, FillTarget,
    FocalPlane, FocusMap, FocusTarget, Gradient, GradientLine, GradientShape, Key, KeyedCharacter, LayerEdit,
    LayerMotion, LensMotion, Symmetry, ViewFrame,
};
use glam::{DMat4, DVec2, DVec3};
use lens::{Aperture, ApertureShape, Character, FocusOffset};
use project::{RecordedFill, RecordedStep, SelectionShape};
use session::{Command, Event, Session, SessionOptions};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};
use test_scenes::Random;

/// More than anything takes on these small scenes.
const PATIENCE: Duration = Duration::from_secs(120);

fn main() -> ExitCode {
    atlas::child::run_if_child();
    let mut arguments = std::env::args_os().skip(1);
    let file = arguments.next().map(PathBuf::from);
    let mut number = || arguments.next()?.to_str()?.parse::<u64>().ok();
    let (Some(file), Some(seed), Some(count)) = (file, number(), number()) else {
        eprintln!("error: usage: random_edits FILE SEED COUNT");
        return ExitCode::from(2);
    };
    match play(file, seed, count) {
        Ok([undone, redone]) => {
            println!("{count} edits, {undone} undone, {redone} redone");
            ExitCode::SUCCESS
        }
        Err(what) => {
            println!("violation: {what}");
            ExitCode::FAILURE
        }
    }
}

/// Makes the edits. Returns how many were undone and redone.
fn play(file: PathBuf, seed: u64, count: u64) -> Result<[u64; 2], String> {
    let options = SessionOptions {
        unwrap: atlas::UnwrapOptions { density: atlas::Density::Side(48), ..Default::default() },
        preview_size: 4,
        // No recovery file is written meanwhile.
        recovery_delay: PATIENCE * 100,
        ..SessionOptions::default()
    };
    let mut session = Session::new(options).map_err(|e| e.to_string())?;
    session.apply(Command::Open(file)).map_err(|e| e.to_string())?;
    settle(&mut session)?;
    if session.document().is_none() {
        return Err("the file does not open".into());
    }
    let mut random = Random(seed.wrapping_mul(0xD1B5_4A32_D192_ED03));
    // The state before each step, and the name of the step after it.
    let mut states = vec![state(&session)];
    let mut names: Vec<String> = Vec::new();
    let (mut at, mut undone, mut redone) = (0, 0, 0);
    for k in 0..count {
        let name = edit(&mut session, &mut random)?;
        settle(&mut session).map_err(|what| format!("edit {k}, {name}: {what}"))?;
        let steps = session.document().map_or(0, |document| document.undo.names().count());
        let now = state(&session);
        match steps.checked_sub(at) {
            Some(0) if now == states[at] => {}
            Some(0) => {
                return Err(format!(
                    "edit {k}, {name}: changed {} without a step",
                    differing(&now, &states[at])
                ));
            }
            Some(1) => {
                states.truncate(at + 1);
                names.truncate(at);
                states.push(now);
                names.push(name);
                at += 1;
            }
            _ => return Err(format!("edit {k}, {name}: {at} steps became {steps}")),
        }
        // About every other edit is undone, in runs, and about every other one of these redone.
        if random.below(4) == 0 {
            for _ in 0..random.below(4) {
                let could = at > 0;
                session.apply(Command::Undo).map_err(|e| e.to_string())?;
                settle(&mut session)?;
                at -= usize::from(could);
                undone += u64::from(could);
                expect(
                    &session,
                    &states,
                    at,
                    &format!("edit {k}: undoing {}", names.get(at).map_or("", |n| n)),
                )?;
            }
            for _ in 0..random.below(3) {
                let could = at + 1 < states.len();
                session.apply(Command::Redo).map_err(|e| e.to_string())?;
                settle(&mut session)?;
                at += usize::from(could);
                redone += u64::from(could);
                let name = at.checked_sub(1).and_then(|done| names.get(done));
                expect(&session, &states, at, &format!("edit {k}: redoing {}", name.map_or("", |n| n)))?;
            }
        }
        if random.below(20) == 0 {
            let to = random.below(states.len() as u64) as usize;
            session.apply(Command::GoToHistoryStep(to)).map_err(|e| e.to_string())?;
            settle(&mut session)?;
            (undone, redone) = (undone + at.saturating_sub(to) as u64, redone + to.saturating_sub(at) as u64);
            at = to;
            expect(&session, &states, at, &format!("edit {k}: going to step {to}"))?;
        }
    }
    // Back to the beginning, and forward again.
    for back in (0..at).rev() {
        session.apply(Command::Undo).map_err(|e| e.to_string())?;
        settle(&mut session)?;
        undone += 1;
        expect(&session, &states, back, &format!("at the end: undoing {}", names[back]))?;
    }
    for forward in 1..states.len() {
        session.apply(Command::Redo).map_err(|e| e.to_string())?;
        settle(&mut session)?;
        redone += 1;
        expect(&session, &states, forward, &format!("at the end: redoing {}", names[forward - 1]))?;
    }
    Ok([undone, redone])
}

/// Waits for all work.
fn settle(session: &mut Session) -> Result<(), String> {
    let start = Instant::now();
    loop {
        for event in session.poll() {
            if let Event::Failed(text) = event {
                return Err(text);
            }
        }
        if session.is_settled() {
            return Ok(());
        }
        if start.elapsed() > PATIENCE {
            return Err(format!("it never settles: {:?}", session.jobs()));
        }
        std::thread::sleep(Duration::from_micros(200));
    }
}

/// What undo is about: a name for each part, and the part as one number.
type State = Vec<(&'static str, u64)>;

fn state(session: &Session) -> State {
    let Some(document) = session.document() else { return Vec::new() };
    let mut parts = vec![("the composite", map_hash(&document.map))];
    let layers = document.layers.layers();
    parts.push(("the number of layers", layers.len() as u64));
    for layer in layers {
        let settings =
            (&layer.name, layer.is_visible, layer.opacity, layer.blend, &layer.adjustment, &layer.motion);
        parts.push(("a layer's paint", map_hash(&layer.map)));
        parts.push(("a layer's settings", text_hash(&format!("{settings:?}"))));
    }
    parts.push(("the camera", text_hash(&format!("{:?}", document.held_camera()))));
    parts.push(("the lens's keys", text_hash(&format!("{:?}", document.lens_motion))));
    parts.push(("the variant", text_hash(&format!("{:?}", document.scene().variant))));
    parts.push(("the depth's repairs", text_hash(&format!("{:?}", document.depth_strokes))));
    let texels = document.stage.canvas.texels().len();
    let mut selected = Hash::default();
    if let Some(selection) = &document.selection {
        (0..texels).for_each(|index| selected.take(u64::from(selection.contains(index))));
    }
    parts.push(("the selection", selected.0));
    parts
}

/// Which parts of two states differ.
fn differing(a: &State, b: &State) -> String {
    let mut names: Vec<_> = a.iter().zip(b).filter(|(a, b)| a != b).map(|(a, _)| a.0).collect();
    names.dedup();
    names.join(", ")
}

fn expect(session: &Session, states: &[State], at: usize, what: &str) -> Result<(), String> {
    let now = state(session);
    let document = session.document().ok_or("nothing is open")?;
    let done = document.undo.names().count();
    if done != at {
        return Err(format!("{what}: {done} steps are done instead of {at}"));
    }
    match now == states[at] {
        true => Ok(()),
        false => Err(format!("{what}: does not bring back {}", differing(&now, &states[at]))),
    }
}

#[derive(Default)]
struct Hash(u64);

impl Hash {
    fn take(&mut self, word: u64) {
        self.0 = (self.0.rotate_left(5) ^ word).wrapping_mul(0x517C_C1B7_2722_0A95);
    }
}

fn text_hash(text: &str) -> u64 {
    let mut hash = Hash::default();
    text.bytes().for_each(|byte| hash.take(u64::from(byte)));
    hash.0
}

fn map_hash(map: &FocusMap) -> u64 {
    let mut hash = Hash::default();
    map.to_rows().iter().flatten().for_each(|value| hash.take(u64::from(value.to_bits())));
    for rows in [map.gloss_rows(), map.mask_rows()] {
        hash.take(u64::from(rows.is_some()));
        rows.iter().flatten().for_each(|value| hash.take(u64::from(value.to_bits())));
    }
    let FocusOffset { t, anchor, gloss } = map.background;
    [t, anchor, gloss].iter().for_each(|value| hash.take(value.to_bits()));
    hash.take(u64::from(map.background_mask.to_bits()));
    hash.0
}

/// A place in the picture, (0, 0) its upper left corner, (1, 1) its lower right.
fn random_position(random: &mut Random) -> DVec2 {
    DVec2::new(random.unit(), random.unit())
}

/// A focus near sharp, anchored to the lens, the point or between.
fn random_focus(random: &mut Random) -> FocusOffset {
    let gloss = if random.one_in(3) { random.unit() } else { 0.0 };
    FocusOffset::new(0.8 + 0.4 * random.unit(), random.below(3) as f64 / 2.0).with_gloss(gloss)
}

/// Makes an edit, which may turn out to change nothing or to be refused. Returns its name.
fn edit(session: &mut Session, random: &mut Random) -> Result<String, String> {
    let position = random_position(random);
    let hit = session.picture_ray(position).and_then(|ray| session.pick(&ray));
    let kind = random.below(12);
    let made = match (kind, hit) {
        (0..=3, _) => stroke(session, random, position),
        (4, _) => gradient(session, random),
        (5, _) => select(session, random, hit),
        (6, _) => fill(session, random, hit),
        (7 | 8, _) => edit_layers(session, random),
        (9, _) => edit_camera(session, random, hit),
        (10, _) => edit_keys(session, random, hit),
        _ => edit_all(session, random),
    };
    session.apply(Command::FinishEdit).map_err(|e| e.to_string())?;
    Ok(made)
}

/// Applies a command, which may be refused. Returns its name.
fn apply(session: &mut Session, command: Command) -> String {
    let mut name = format!("{command:?}");
    if let Some((end, _)) = name.char_indices().nth(160) {
        name.truncate(end);
    }
    match session.apply(command) {
        Ok(()) => name,
        Err(error) => format!("{name} (refused: {error})"),
    }
}

fn view(session: &Session) -> ViewFrame {
    let camera = session.document().map(|document| document.camera.clone()).unwrap_or_default();
    ViewFrame::from_camera(&camera)
}

fn stroke(session: &mut Session, random: &mut Random, position: DVec2) -> String {
    let modes = [
        BrushMode::Set,
        BrushMode::Set,
        BrushMode::Add,
        BrushMode::Subtract,
        BrushMode::Smooth,
        BrushMode::Sharpen,
        BrushMode::Clone,
        BrushMode::Reset,
    ];
    let channels = [Channels::All, Channels::T, Channels::Anchor, Channels::Gloss, Channels::Mask];
    let brush = Brush {
        radius: 0.05 + 0.4 * random.unit(),
        hardness: random.unit(),
        strength: 0.3 + 0.7 * random.unit(),
        flow: random.one_of(&[1.0, 0.5]),
        mode: random.one_of(&modes),
        target: random_focus(random),
        clone_offset: [0.3 * random.unit(), 0.1, 0.0],
        channels: if random.one_in(2) { Channels::All } else { random.one_of(&channels) },
        normal_limit_degrees: random.one_of(&[90.0, 180.0]),
        mirror: [random.one_in(4), random.one_in(8), false],
        radial: random.one_of(&[1, 1, 1, 3]),
        mirror_by_object: random.one_in(6),
        ..Brush::default()
    };
    let name = format!("stroke {:?} {:?}", brush.mode, brush.channels);
    if let Err(error) = session.apply(Command::SetBrush(brush)) {
        return format!("{name} (refused: {error})");
    }
    let view = view(session);
    let point = |position: DVec2, random: &mut Random| {
        let target =
            if random.one_in(4) { StrokeTarget::Atlas(position) } else { StrokeTarget::View(view, position) };
        StrokePoint { target, pressure: random.unit() as f32 }
    };
    let first = point(position, random);
    let began = session.apply(Command::BeginStroke(first));
    for _ in 0..random.below(4) {
        let next = StrokePoint { pressure: 1.0, ..point(random_position(random), random) };
        let _ = session.apply(Command::ExtendStroke(next));
    }
    let end = match random.below(12) {
        0 => Command::AbortStroke,
        // Takes the unfinished stroke back.
        1 if session.is_painting() => Command::Undo,
        _ => Command::CommitStroke,
    };
    let ended = apply(session, end);
    format!("{name}, {ended}{}", began.err().map(|e| format!(" (refused: {e})")).unwrap_or_default())
}

fn gradient(session: &mut Session, random: &mut Random) -> String {
    let line = match random.below(2) {
        0 => GradientLine::World([DVec3::ZERO, DVec3::new(random.unit(), 0.1, -4.0)]),
        _ => GradientLine::View(view(session), [random_position(random), random_position(random)]),
    };
    let gradient = Gradient {
        shape: random.one_of(&[GradientShape::Linear, GradientShape::Radial]),
        line,
        from: random_focus(random),
        to: if random.one_in(3) { None } else { Some(random_focus(random)) },
        symmetry: Symmetry { mirror: [random.one_in(3), false, false], ..Symmetry::default() },
    };
    let _ = session.apply(Command::DragGradient(Gradient { from: random_focus(random), ..gradient }));
    let drawn = apply(session, Command::DragGradient(gradient));
    let end = if random.one_in(8) { Command::AbortStroke } else { Command::CommitStroke };
    format!("{drawn}, {}", apply(session, end))
}

fn select(session: &mut Session, random: &mut Random, hit: Option<SurfaceHit>) -> String {
    let combine = random.one_of(&[
        CombineMode::Replace,
        CombineMode::Add,
        CombineMode::Subtract,
        CombineMode::Intersect,
    ]);
    let outline = |random: &mut Random, view| SelectionShape::Outline {
        view,
        points: (0..3 + random.below(4)).map(|_| random_position(random)).collect(),
        through: random.one_in(2),
    };
    let command = match (random.below(7), hit) {
        (0, _) => Command::Select(SelectionShape::Everything, CombineMode::Replace),
        (1, _) => Command::Select(SelectionShape::Inverse, CombineMode::Replace),
        (2, _) => {
            let (near, depth) = (1.0 + 3.0 * random.unit(), 3.0 * random.unit());
            let (origin, axis) = (DVec3::ZERO, DVec3::NEG_Z);
            Command::Select(SelectionShape::Depth { origin, axis, range: [near, near + depth] }, combine)
        }
        (3, Some(hit)) => {
            let (normal, degrees) = (hit.normal, 90.0 * random.unit());
            Command::Select(SelectionShape::Normal { normal, degrees }, combine)
        }
        (4 | 5, Some(hit)) => Command::SelectRegion(region(random, hit), combine),
        _ => Command::Select(outline(random, view(session)), combine),
    };
    apply(session, command)
}

fn region(random: &mut Random, hit: SurfaceHit) -> FillRegion {
    match random.below(5) {
        0 => FillRegion::Node(hit),
        1 => FillRegion::Part(hit),
        2 => FillRegion::Material(hit),
        3 => FillRegion::Chart(hit),
        _ => FillRegion::All,
    }
}

fn fill(session: &mut Session, random: &mut Random, hit: Option<SurfaceHit>) -> String {
    let command = match (random.below(3), hit) {
        (0, _) => Command::SetBackgroundFocus(random_focus(random)),
        (1, _) => {
            let layers = session.document().map(|document| document.layers.layers());
            let layer =
                layers.and_then(|layers| layers.first()).map_or_else(String::new, |layer| layer.name.clone());
            let targets =
                vec![random.one_of(&[FillTarget::Node(0), FillTarget::Chart(0), FillTarget::Everything])];
            Command::ApplyRecordedStep(RecordedStep::Fill(RecordedFill {
                layer,
                targets,
                focus: random_focus(random),
            }))
        }
        (_, Some(hit)) => Command::Fill(region(random, hit), random_focus(random)),
        (_, None) => Command::Fill(FillRegion::All, random_focus(random)),
    };
    apply(session, command)
}

fn edit_layers(session: &mut Session, random: &mut Random) -> String {
    let Some(document) = session.document() else { return String::new() };
    let count = document.layers.layers().len();
    let layer = random.below(count as u64) as usize;
    let adjusted = document.layers.layers()[layer].adjustment.clone();
    let edit = match random.below(16) {
        0 | 1 if count < 6 => LayerEdit::AddPaint,
        2 if count < 6 => LayerEdit::AddCurve,
        3 if count < 6 => LayerEdit::AddPlane,
        4 if count < 6 => LayerEdit::Duplicate(layer),
        0..=4 => LayerEdit::Remove(layer),
        5 => LayerEdit::Rename(layer, format!("Layer {}", random.below(100))),
        6 => LayerEdit::Visible(layer, !random.one_in(3)),
        7 => LayerEdit::Opacity(layer, random.unit()),
        8 => LayerEdit::Blend(layer, random.one_of(&BlendMode::ALL)),
        9 => LayerEdit::Shift { from: layer, to: random.below(count as u64) as usize },
        10 | 11 => match adjusted {
            Some(Adjustment::Curve(_)) => {
                let points = [[0.1, random.unit() + 0.5], [1.0 + random.unit(), random.unit() + 0.5]];
                let Some(curve) = Curve::new(points) else { return "no curve".into() };
                LayerEdit::Curve(layer, DepthCurve { curve, anchor: random.unit() })
            }
            Some(Adjustment::Plane(plane)) => {
                LayerEdit::Plane(layer, FocalPlane { curvature: random.unit() - 0.5, ..plane })
            }
            None => LayerEdit::RemoveMask(layer),
        },
        12 => {
            let mut motion = LayerMotion::default();
            for seconds in 0..random.below(3) {
                let ease = random.one_of(&Ease::ALL).1;
                let _ = motion.opacity.insert(Key { seconds: seconds as f64, value: random.unit(), ease });
            }
            LayerEdit::Motion(layer, motion)
        }
        13 => LayerEdit::AddMask(layer),
        14 => LayerEdit::InvertMask(layer),
        _ => return apply(session, Command::ActivateLayer(layer)),
    };
    apply(session, Command::EditLayers(edit))
}

fn edit_camera(session: &mut Session, random: &mut Random, hit: Option<SurfaceHit>) -> String {
    let Some(document) = session.document() else { return String::new() };
    let camera = document.camera.clone();
    let shapes = [
        ApertureShape::Disc,
        ApertureShape::Square,
        ApertureShape::Polygon {
            blades: 3 + random.below(6) as u32,
            rotation: random.unit(),
            roundness: random.unit(),
        },
    ];
    let edit = match random.below(11) {
        0 => CameraEdit::FocusDistance(1.0 + 3.0 * random.unit()),
        1 => CameraEdit::ApertureRadius(0.1 * random.unit()),
        2 => CameraEdit::FNumber(random.one_of(&[1.4, 2.8, 8.0, f64::INFINITY])),
        3 => {
            let shape = shapes[random.below(shapes.len() as u64) as usize].clone();
            CameraEdit::Aperture(Aperture { shape, ratio: 0.5 + random.unit() })
        }
        4 => CameraEdit::YFov(0.4 + 0.4 * random.unit()),
        5 => CameraEdit::SensorHeight(0.01 + 0.02 * random.unit()),
        6 => CameraEdit::Shift(0.2 * (random_position(random) - DVec2::splat(0.5))),
        7 => CameraEdit::Background(random.one_of(&[None, Some([0.1, 0.2, 0.3]), Some([1.0; 3])])),
        8 => CameraEdit::Size(32 + random.below(64) as u32, 32 + random.below(64) as u32),
        9 => CameraEdit::Pose(DMat4::from_translation(
            0.2 * DVec3::new(random.unit(), random.unit(), random.unit()),
        )),
        _ => match hit {
            Some(hit) => return apply(session, Command::FocusHere(hit)),
            None => {
                CameraEdit::Whole(Box::new(lens::Camera { focus_distance: 1.0 + random.unit(), ..camera }))
            }
        },
    };
    // A slider that is dragged makes one step of many edits.
    if random.one_in(3) {
        let _ = session.apply(Command::EditCamera(edit.clone()));
    }
    apply(session, Command::EditCamera(edit))
}

fn edit_keys(session: &mut Session, random: &mut Random, hit: Option<SurfaceHit>) -> String {
    let Some(document) = session.document() else { return String::new() };
    let mut motion = document.lens_motion.clone();
    let (seconds, ease) = (random.below(5) as f64, random.one_of(&Ease::ALL).1);
    match (random.below(6), hit) {
        (0, _) => motion = LensMotion::default(),
        (5, _) => {
            let character = Character { edges: 2.0 * random.unit() - 1.0, ..Character::default() };
            let _ = motion.character.insert(Key { seconds, value: KeyedCharacter(character), ease });
        }
        (1, Some(hit)) => {
            let _ = motion.focus.insert(Key { seconds, value: FocusTarget::Point(hit.point), ease });
        }
        (2, _) => {
            let _ = motion.f_number.insert(Key { seconds, value: 1.0 + 8.0 * random.unit(), ease });
        }
        (3, Some(hit)) => {
            let position = random_position(random);
            let other = session.picture_ray(position).and_then(|ray| session.pick(&ray)).unwrap_or(hit);
            let seconds = [seconds, seconds + 1.0];
            return apply(session, Command::RackFocus { points: [hit, other], seconds, ease });
        }
        _ => {
            let _ = motion.focus.insert(Key {
                seconds,
                value: FocusTarget::Distance(1.0 + 4.0 * random.unit()),
                ease,
            });
        }
    }
    apply(session, Command::SetLensMotion("Lens keys", motion))
}

/// What concerns the document as a whole.
fn edit_all(session: &mut Session, random: &mut Random) -> String {
    let Some(document) = session.document() else { return String::new() };
    let variants: Vec<String> = document.scene().variants.clone();
    let is_picture = document.scene().picture.is_some();
    let command = match random.below(6) {
        0 => Command::ResetMap,
        1 | 2 => Command::MaskFromSelection,
        _ if is_picture => {
            let repairs =
                [DepthRepair::Nearer, DepthRepair::Farther, DepthRepair::Smooth, DepthRepair::Spread];
            let mut path = Vec::new();
            for _ in 0..1 + random.below(3) {
                path.push([12.0 * random.unit() as f32, 8.0 * random.unit() as f32]);
            }
            Command::RepairDepth(DepthStroke {
                repair: random.one_of(&repairs),
                path,
                radius_px: 1.0 + 3.0 * random.unit() as f32,
                hardness: random.unit() as f32,
                strength: 1.0,
            })
        }
        _ if variants.is_empty() => Command::Fill(FillRegion::All, random_focus(random)),
        _ => {
            let choice = random.below(variants.len() as u64 + 1) as usize;
            Command::SetVariant(variants.get(choice).cloned())
        }
    };
    apply(session, command)
}
