//! What was painted is recorded, and paints the same map again.

#[allow(dead_code, reason = "shared by several tests")]
mod at_work;
#[allow(dead_code, reason = "shared by several tests")]
mod tiny_glb;

use at_work::{opened, opened_with, settle, shot_view};
use document::StrokePoint;
use focus::BrushMode;
use glam::DVec2;
use lens::FocusOffset;
use project::RecordedStep;
use session::{Command, Session, SessionOptions};
use std::time::Duration;

/// A wave across the picture, `bunch` events between two polls.
fn wave(session: &mut Session, y: f64, bunch: usize) {
    let view = shot_view(session);
    let point = |k: usize| {
        let at = DVec2::new(0.1 + 0.016 * k as f64, y + 0.1 * (k as f64 * 0.3).sin());
        let pressure = 0.4 + 0.6 * (k as f32 / 50.0);
        StrokePoint { target: document::StrokeTarget::View(view, at), pressure }
    };
    session.apply(Command::BeginStroke(point(0))).unwrap();
    for k in 1..=50 {
        session.apply(Command::ExtendStroke(point(k))).unwrap();
        if k % bunch == 0 {
            session.poll();
        }
    }
    session.apply(Command::CommitStroke).unwrap();
}

#[test]
fn recorded_strokes_paint_the_same_map_again_whatever_the_timing() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("quads.glb");
    tiny_glb::write(&scene);
    let paint = |bunch: usize| {
        // However slow the machine, no recovery file is written, which the next session would take up.
        let keep_after = Duration::from_secs(3600);
        let mut session =
            opened_with(&scene, SessionOptions { recovery_delay: keep_after, ..SessionOptions::default() });
        for (k, mode) in
            [BrushMode::Set, BrushMode::Add, BrushMode::Smooth, BrushMode::Sharpen].iter().enumerate()
        {
            let brush = focus::Brush {
                radius: 0.2,
                mode: *mode,
                flow: 0.7,
                target: FocusOffset::new(1.1 + 0.1 * k as f64, 1.0),
                mirror: [k == 1, false, false],
                ..focus::Brush::default()
            };
            session.apply(Command::SetBrush(brush)).unwrap();
            wave(&mut session, 0.4 + 0.02 * k as f64, bunch);
        }
        session.apply(Command::EditLayers(focus::LayerEdit::AddPaint)).unwrap();
        let target = FocusOffset::new(0.8, 1.0);
        let brush = focus::Brush { radius: 0.2, target, ..focus::Brush::default() };
        session.apply(Command::SetBrush(brush)).unwrap();
        wave(&mut session, 0.6, bunch);
        // Taken back: no part of the recording.
        wave(&mut session, 0.2, bunch);
        session.apply(Command::Undo).unwrap();
        session
    };
    let mut live = paint(1);
    let strokes = folder.path().join("strokes.json");
    live.apply(Command::ExportStrokes(strokes.clone())).unwrap();
    settle(&mut live);
    let document = live.document().unwrap();
    let other = paint(50);
    assert!(other.document().unwrap().layers == document.layers, "events in another rhythm");

    let steps = project::read_strokes(&strokes).unwrap();
    assert_eq!(steps.len(), 6);
    assert_eq!(steps[4], RecordedStep::Layers(focus::LayerEdit::AddPaint));
    let RecordedStep::Stroke(first) = &steps[0] else { panic!("a stroke: {:?}", steps[0]) };
    assert_eq!(first.points.len(), 51);
    let strokes: Vec<_> = steps.iter().filter(|s| matches!(s, RecordedStep::Stroke(_))).cloned().collect();
    let nobody = progress::Unwatched;
    let mut again = document::Document::create(
        &scene,
        &Default::default(),
        &Default::default(),
        &Default::default(),
        &nobody,
    )
    .unwrap();
    let missing = document::replay(&mut again, &strokes).unwrap_err().to_string();
    assert!(
        missing.contains("step 5") && missing.contains("Layer 1") && missing.contains("Paint"),
        "{missing}"
    );

    let mut again = document::Document::create(
        &scene,
        &Default::default(),
        &Default::default(),
        &Default::default(),
        &nobody,
    )
    .unwrap();
    assert_eq!(document::replay(&mut again, &steps).unwrap(), 6);
    assert!(again.map == document.map && again.layers == document.layers);

    // On a project that has the layer: the same bits, saved and opened as well.
    let mut blank = opened(&scene);
    blank.apply(Command::EditLayers(focus::LayerEdit::AddPaint)).unwrap();
    let project = folder.path().join("blank.fbrush");
    blank.apply(Command::SaveAs(project.clone())).unwrap();
    settle(&mut blank);
    let mut again =
        document::Document::open_saved(&project, &Default::default(), &Default::default(), &nobody).unwrap();
    assert_eq!(document::replay(&mut again, &strokes).unwrap(), 5);
    assert!(again.map == document.map && again.layers.layers()[0] == document.layers.layers()[0]);
    assert_eq!(again.undo_names().count(), 5);
    assert!(live.apply(Command::ExportStrokes(folder.path().join("none/strokes.json"))).is_err());
}

#[test]
fn a_stroke_is_mirrored_about_the_object_it_begins_on_and_so_is_its_recording() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("quads.glb");
    tiny_glb::write(&scene);
    let mut session = opened(&scene);
    let target = FocusOffset::new(1.2, 1.0);
    let brush = focus::Brush {
        radius: 0.05,
        target,
        mirror: [true, false, false],
        mirror_by_object: true,
        ..focus::Brush::default()
    };
    session.apply(Command::SetBrush(brush.clone())).unwrap();
    // On the card's right, 2 away: its middle is at x = −0.4.
    let camera = session.document().unwrap().camera.clone();
    let place = |x: f64| {
        let pixel = camera.pixel_from_q(camera.optics().chief(glam::DVec3::new(x, 0.0, 2.0)));
        pixel / DVec2::new(camera.width as f64, camera.height as f64)
    };
    let (right, left) = (place(-0.25), place(-0.55));
    let view = shot_view(&session);
    let point = StrokePoint { target: document::StrokeTarget::View(view, right), pressure: 1.0 };
    session.apply(Command::BeginStroke(point)).unwrap();
    session.apply(Command::CommitStroke).unwrap();
    let focus_at = |session: &Session, at: DVec2| {
        session.focus_at(&session.pick(&session.picture_ray(at).unwrap()).unwrap()).unwrap().t
    };
    assert!((focus_at(&session, right) - 1.2).abs() < 1e-6);
    assert!((focus_at(&session, left) - 1.2).abs() < 1e-6, "its image on the card");
    assert_eq!(focus_at(&session, place(0.25)), 1.0, "and none on the other side of the world");

    let strokes = folder.path().join("strokes.json");
    session.apply(Command::ExportStrokes(strokes.clone())).unwrap();
    let text = std::fs::read_to_string(&strokes).unwrap();
    assert!(text.contains("mirror_center") && !text.contains("mirror_by_object"), "{text}");
    let steps = project::read_strokes(&strokes).unwrap();
    let nobody = progress::Unwatched;
    let mut again = document::Document::create(
        &scene,
        &Default::default(),
        &Default::default(),
        &Default::default(),
        &nobody,
    )
    .unwrap();
    assert_eq!(document::replay(&mut again, &steps).unwrap(), 1);
    assert!(again.map == session.document().unwrap().map);

    // A fill takes the object at the image of the click: on the card that is the card itself.
    let card = session.pick(&session.picture_ray(right).unwrap()).unwrap();
    let symmetry = session.document().unwrap().symmetry_at(Some(&card));
    assert!((symmetry.center[0] + 0.4).abs() < 1e-6 && symmetry.has_world_axes(), "{symmetry:?}");
    let world = session.document().unwrap().symmetry_at(None);
    assert_eq!(world.center, [0.0; 3], "where there is no object");
}
