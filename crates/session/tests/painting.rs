//! A document from opening to reopening: painted, looked at, undone, saved, recovered.

mod tiny_glb;

use focus::BrushMode;
use glam::DVec2;
use lens::{FocusOffset, Picture};
use project::RecordedStep;
use session::{
    CameraEdit, Command, Display, Event, FillRegion, PreviewKind, Session, SessionError, SessionOptions,
    StrokePoint, Tone, to_screen,
};
use std::path::Path;
use std::time::{Duration, Instant};

/// Polls until all work is done; what happened.
fn settle(session: &mut Session) -> Vec<Event> {
    let start = Instant::now();
    let mut events = session.poll();
    while !session.is_settled() {
        assert!(
            start.elapsed() < Duration::from_secs(120),
            "the session never settles: {:?}",
            session.jobs()
        );
        std::thread::sleep(Duration::from_millis(5));
        events.extend(session.poll());
    }
    events.extend(session.poll());
    let failed = events.iter().find(|event| matches!(event, Event::Failed(_)));
    assert!(failed.is_none(), "{failed:?}");
    events
}

fn opened(path: &Path) -> Session {
    opened_with(path, SessionOptions::default())
}

fn opened_with(path: &Path, options: SessionOptions) -> Session {
    let options = SessionOptions { preview_size: 240, ..options };
    let mut session = Session::new(options).unwrap();
    session.apply(Command::Open(path.into())).unwrap();
    let events = settle(&mut session);
    assert!(events.contains(&Event::Opened));
    session
}

fn picture(session: &Session) -> Picture {
    let preview = session.preview().expect("a preview");
    assert_ne!(preview.kind, PreviewKind::Pinhole);
    (*preview.picture.bring().unwrap()).clone()
}

/// A point of the picture on the wall, away from card and dot.
const ON_WALL: DVec2 = DVec2::new(0.75, 0.75);

fn stroke(session: &mut Session) {
    let brush = focus::Brush {
        radius: 0.3,
        target: FocusOffset::new(1.3, 1.0),
        ..session.document().unwrap().brush.clone()
    };
    session.apply(Command::SetBrush(brush)).unwrap();
    let ray = |session: &Session, x: f64| session.picture_ray(DVec2::new(x, ON_WALL.y)).unwrap();
    let begin = StrokePoint::ray(ray(session, 0.6));
    session.apply(Command::BeginStroke(begin)).unwrap();
    for k in 1..=4 {
        let point = StrokePoint::ray(ray(session, 0.6 + 0.05 * k as f64));
        session.apply(Command::ExtendStroke(point)).unwrap();
    }
}

#[test]
fn paint_shows_while_the_stroke_goes_on_and_undo_brings_the_same_bits_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("quads.glb");
    tiny_glb::write(&path);
    let mut session = opened(&path);
    let blank = picture(&session);
    let document = session.document().unwrap();
    assert!(!document.is_unsaved());
    assert_eq!(document.undo_name(), None);

    let seen = session.screen().serial();
    stroke(&mut session);
    let events = settle(&mut session);
    assert!(session.is_painting());
    let shown = |session: &Session| {
        let tone = Tone { exposure: session.document().unwrap().exposure, display: session.display() };
        session.screen().pixels() == to_screen(&session.preview().unwrap().picture.bring().unwrap(), tone)
    };
    assert!(shown(&session), "what was made anew piece by piece is the whole");
    let [columns, rows] = session.screen().changed_since(seen).expect("a change");
    let [width, height] = session.screen().size();
    let changed = columns.len() * rows.len();
    assert!(changed > 100 && changed < (width * height) as usize * 3 / 4, "{columns:?} {rows:?}");
    let brighter = Display { stops: 1.0, ..Display::default() };
    session.apply(Command::SetDisplay(brighter)).unwrap();
    assert!(!shown(&session), "until the picture is put on screen anew");
    settle(&mut session);
    assert!(shown(&session));
    session.apply(Command::SetDisplay(Display::default())).unwrap();
    assert!(events.iter().any(|event| matches!(event, Event::MapChanged(..))));
    let painted = picture(&session);
    assert!(painted != blank, "the preview follows while the pen is down");
    session.apply(Command::CommitStroke).unwrap();
    settle(&mut session);
    let document = session.document().unwrap();
    assert!(document.is_unsaved());
    assert_eq!(document.undo_name(), Some("Brush stroke"));
    let hit = session.pick(&session.picture_ray(ON_WALL).unwrap()).unwrap();
    assert!((hit.position.z + 4.0).abs() < 1e-6, "on the wall: {}", hit.position);
    let focus = session.focus_at(&hit).unwrap();
    assert!((focus.t - 1.3).abs() < 1e-6 && focus.anchor == 1.0, "{focus:?}");

    session.apply(Command::Undo).unwrap();
    settle(&mut session);
    assert!(picture(&session) == blank);
    session.apply(Command::Redo).unwrap();
    settle(&mut session);
    assert!(picture(&session) == painted);

    // A stroke that is given up leaves no trace.
    stroke(&mut session);
    session.apply(Command::AbortStroke).unwrap();
    settle(&mut session);
    assert!(picture(&session) == painted);
    assert_eq!(session.document().unwrap().redo_name(), None);
    assert_eq!(session.document().unwrap().undo_names().count(), 1);
}

#[test]
fn the_lens_is_undone_with_the_paint_and_bad_values_change_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("quads.glb");
    tiny_glb::write(&path);
    let mut session = opened(&path);
    let blank = picture(&session);
    let card = session.pick(&session.picture_ray(DVec2::new(0.5 - 0.1, 0.5)).unwrap()).unwrap();
    session.apply(Command::FocusHere(card)).unwrap();
    settle(&mut session);
    let distance = session.document().unwrap().camera.focus_distance;
    assert!((distance - 2.0).abs() < 1e-5, "the axial depth of the card: {distance}");
    assert!(picture(&session) != blank);

    let wrong = session.apply(Command::Camera(CameraEdit::FocusDistance(-1.0)));
    assert!(matches!(wrong, Err(SessionError::BadInput(_))));
    session.apply(Command::Camera(CameraEdit::FNumber(1.0))).unwrap();
    settle(&mut session);
    session.apply(Command::Undo).unwrap();
    session.apply(Command::Undo).unwrap();
    settle(&mut session);
    assert!(picture(&session) == blank, "a wider aperture came and went");

    session.apply(Command::Fill(FillRegion::Node(card), FocusOffset::SHARP)).unwrap();
    settle(&mut session);
    assert_eq!(session.focus_at(&card), Some(FocusOffset::SHARP));
    session.apply(Command::Pick(card)).unwrap();
    assert_eq!(session.document().unwrap().brush.target, FocusOffset::SHARP);
    session.apply(Command::ResetMap).unwrap();
    settle(&mut session);
    assert!(picture(&session) == blank);
}

#[test]
fn what_is_saved_is_opened_again() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("quads.glb");
    let project = folder.path().join("quads.fbrush");
    tiny_glb::write(&scene);
    let mut session = opened(&scene);
    assert!(session.apply(Command::Save).is_err(), "there is no file yet");
    stroke(&mut session);
    session.apply(Command::CommitStroke).unwrap();
    session.apply(Command::Camera(CameraEdit::FocusDistance(2.5))).unwrap();
    session.apply(Command::SetView(serde_json::json!({"yaw": 0.25}))).unwrap();
    let card = session.pick(&session.picture_ray(DVec2::new(0.4, 0.5)).unwrap()).unwrap();
    session.apply(Command::SelectRegion(FillRegion::Node(card), focus::Combine::Replace)).unwrap();
    let selection = session.document().unwrap().selection.clone();
    assert!(selection.is_some());
    session.apply(Command::SaveAs(project.clone())).unwrap();
    let events = settle(&mut session);
    assert!(events.contains(&Event::Written(project.clone())));
    let document = session.document().unwrap();
    assert!(!document.is_unsaved());
    assert_eq!(document.name(), "quads.fbrush");
    let (map, painted) = (document.map.clone(), picture(&session));

    let mut again = opened(&project);
    let document = again.document().unwrap();
    assert!(document.map == map);
    assert!(document.selection == selection, "what may be painted is kept");
    assert_eq!(document.camera.focus_distance, 2.5);
    assert_eq!(document.brush.mode, BrushMode::Set);
    assert_eq!(document.view["yaw"], 0.25);
    assert!(!document.is_unsaved());
    assert!(picture(&again) == painted);

    // Its focus map, written and read back, is the same document.
    let exported = folder.path().join("focus.exr");
    again.apply(Command::ExportFocusMap(exported.clone())).unwrap();
    settle(&mut again);
    again.apply(Command::ResetMap).unwrap();
    again.apply(Command::ImportFocusMap(exported)).unwrap();
    settle(&mut again);
    assert!(again.document().unwrap().map == map);
    let shot = folder.path().join("shot.png");
    again.apply(Command::ExportPicture(shot.clone())).unwrap();
    settle(&mut again);
    assert!(shot.is_file());
}

#[test]
fn the_unwrapped_scene_is_written_in_the_background_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("quads.glb");
    tiny_glb::write(&scene);
    let mut session = opened(&scene);
    let unwrapped = folder.path().join("unwrapped.glb");
    session.apply(Command::ExportScene(unwrapped.clone())).unwrap();
    let job = session.jobs().pop().expect("it is done in the background");
    assert!(job.label.contains("unwrapped.glb") && job.can_cancel, "{job:?}");
    let events = settle(&mut session);
    assert!(events.contains(&Event::Written(unwrapped.clone())));
    let again = session::load_scene(&unwrapped, &progress::Unwatched).unwrap();
    let document = session.document().unwrap();
    assert_eq!(again.triangles.len(), document.scene().triangles.len());
    let size = glam::Vec2::new(document.stage.atlas.width as f32, document.stage.atlas.height as f32);
    let place = again.corner_uv(0, 1)[0] * size;
    assert!(place.distance(document.stage.atlas.corners[0][0]) < 1e-3, "TEXCOORD_1 is the atlas");

    let wrong = folder.path().join("unwrapped.obj");
    session.apply(Command::ExportScene(wrong.clone())).unwrap();
    while !session.is_settled() {
        std::thread::sleep(Duration::from_millis(5));
        let failed = session.poll().into_iter().any(|event| matches!(event, Event::Failed(_)));
        assert!(!failed || !wrong.exists());
    }

    // Cancelled before it began: there is no file.
    let progress = session::JobProgress::default();
    progress.cancel();
    let never = folder.path().join("never.glb");
    let stage = &session.document().unwrap().stage;
    let stopped = atlas::write_glb(&stage.scene, &stage.atlas, &never, &progress);
    assert!(matches!(stopped, Err(atlas::AtlasError::Cancelled)) && !never.exists());
}

#[test]
fn a_template_begins_a_document_without_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("quads.glb");
    let template = folder.path().join("template.fbrush");
    tiny_glb::write(&scene);
    let recipe = folder.path().join("recipe.json");
    std::fs::write(&recipe, r#"{"nodes": {"card": {"t": 1.1, "anchor": 1}}}"#).unwrap();
    let unwrap = Default::default();
    let begun = session::Document::begin(&scene, None, Some(&recipe), &unwrap, &progress::Unwatched).unwrap();
    begun.to_project().save(&template).unwrap();
    let bytes = std::fs::read(&template).unwrap();

    let mut session = Session::new(SessionOptions { preview_size: 120, ..Default::default() }).unwrap();
    session.apply(Command::OpenTemplate(template.clone())).unwrap();
    settle(&mut session);
    let document = session.document().unwrap();
    assert_eq!((document.path.as_ref(), document.is_unsaved()), (None, false));
    let card = session.pick(&session.picture_ray(DVec2::new(0.4, 0.5)).unwrap()).unwrap();
    assert!((session.focus_at(&card).unwrap().t - 1.1).abs() < 1e-6);
    assert!(session.apply(Command::Save).is_err(), "a template is not saved over");
    let own = folder.path().join("own.fbrush");
    session.apply(Command::SaveAs(own.clone())).unwrap();
    settle(&mut session);
    assert_eq!(session.document().unwrap().path.as_ref(), Some(&own));
    assert_eq!(std::fs::read(&template).unwrap(), bytes);
}

#[test]
fn unsaved_work_is_restored() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("quads.glb");
    let project = folder.path().join("quads.fbrush");
    tiny_glb::write(&scene);
    let options = SessionOptions { keep_after: Duration::from_millis(100), ..SessionOptions::default() };
    let mut session = opened_with(&scene, options);
    session.apply(Command::SaveAs(project.clone())).unwrap();
    settle(&mut session);
    stroke(&mut session);
    session.apply(Command::CommitStroke).unwrap();
    let recovery = project::recovery_path_for(&project);
    assert!(!recovery.exists());
    let start = Instant::now();
    while !recovery.exists() {
        settle(&mut session);
        assert!(start.elapsed() < Duration::from_secs(60), "unsaved work is kept");
    }
    settle(&mut session);
    let map = session.document().unwrap().map.clone();
    // A crash: nothing is put in order.
    std::mem::forget(session);

    let mut again = opened(&project);
    let document = again.document().unwrap();
    assert!(document.map == map);
    assert!(document.is_unsaved());
    assert!(document.warnings.iter().any(|warning| warning.contains("restored")));
    again.apply(Command::Save).unwrap();
    settle(&mut again);
    assert!(!recovery.exists(), "saving makes it superfluous");
    assert!(!opened(&project).document().unwrap().is_unsaved());
}

#[test]
fn a_failed_open_leaves_the_document_and_says_why() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("quads.glb");
    tiny_glb::write(&scene);
    let mut session = opened(&scene);
    let broken = folder.path().join("broken.glb");
    std::fs::write(&broken, b"glTF\x02\0\0\0").unwrap();
    session.apply(Command::Open(broken)).unwrap();
    let mut events = Vec::new();
    while !session.is_settled() {
        events.extend(session.poll());
        std::thread::sleep(Duration::from_millis(5));
    }
    events.extend(session.poll());
    let failed = events.iter().find_map(|event| match event {
        Event::Failed(why) => Some(why),
        _ => None,
    });
    assert!(failed.is_some_and(|why| why.contains("broken.glb")), "{events:?}");
    assert_eq!(session.document().unwrap().name(), "quads.glb");
}

/// The picture as a view that is painted in.
fn shot_view(session: &Session) -> focus::ViewFrame {
    let camera = &session.document().unwrap().camera;
    let (camera_to_world, yfov, aspect) = (camera.camera_to_world, camera.yfov, camera.aspect());
    focus::ViewFrame { camera_to_world, yfov, aspect }
}

/// A wave across the picture, `bunch` events between two polls.
fn wave(session: &mut Session, y: f64, bunch: usize) {
    let view = shot_view(session);
    let point = |k: usize| {
        let at = DVec2::new(0.1 + 0.016 * k as f64, y + 0.1 * (k as f64 * 0.3).sin());
        let pressure = 0.4 + 0.6 * (k as f32 / 50.0);
        StrokePoint { at: session::StrokeTarget::View(view, at), pressure }
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
        let mut session = opened_with(&scene, SessionOptions { keep_after, ..SessionOptions::default() });
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
        session.apply(Command::Layer(focus::LayerEdit::AddPaint)).unwrap();
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
    let mut again = session::Document::begin(&scene, None, None, &Default::default(), &nobody).unwrap();
    let missing = session::replay(&mut again, &strokes).unwrap_err().to_string();
    assert!(
        missing.contains("step 5") && missing.contains("Layer 1") && missing.contains("Paint"),
        "{missing}"
    );

    let mut again = session::Document::begin(&scene, None, None, &Default::default(), &nobody).unwrap();
    assert_eq!(session::replay(&mut again, &steps).unwrap(), 6);
    assert!(again.map == document.map && again.layers == document.layers);

    // On a project that has the layer: the same bits, saved and opened as well.
    let mut blank = opened(&scene);
    blank.apply(Command::Layer(focus::LayerEdit::AddPaint)).unwrap();
    let project = folder.path().join("blank.fbrush");
    blank.apply(Command::SaveAs(project.clone())).unwrap();
    settle(&mut blank);
    let mut again = session::Document::open_saved(&project, &Default::default(), &nobody).unwrap();
    assert_eq!(session::replay(&mut again, &strokes).unwrap(), 5);
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
    let point = StrokePoint { at: session::StrokeTarget::View(view, right), pressure: 1.0 };
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
    let mut again = session::Document::begin(&scene, None, None, &Default::default(), &nobody).unwrap();
    assert_eq!(session::replay(&mut again, &steps).unwrap(), 1);
    assert!(again.map == session.document().unwrap().map);

    // A fill takes the object at the image of the click: on the card that is the card itself.
    let card = session.pick(&session.picture_ray(right).unwrap()).unwrap();
    let symmetry = session.document().unwrap().symmetry_at(Some(&card));
    assert!((symmetry.center[0] + 0.4).abs() < 1e-6 && symmetry.is_along_world(), "{symmetry:?}");
    let world = session.document().unwrap().symmetry_at(None);
    assert_eq!(world.center, [0.0; 3], "where there is no object");
}

#[test]
fn depth_curves_follow_the_camera_and_come_back_with_it() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("quads.glb");
    tiny_glb::write(&scene);
    let mut session = opened(&scene);
    let blank = picture(&session);
    session.apply(Command::Layer(focus::LayerEdit::AddCurve)).unwrap();
    let curve = focus::Curve::new([[2.5f64.ln(), 1.0], [4.0f64.ln(), 1.3]]).unwrap();
    let curve = focus::DepthCurve { curve, anchor: 1.0 };
    session.apply(Command::Layer(focus::LayerEdit::Curve(1, curve))).unwrap();
    settle(&mut session);
    let wall = session.pick(&session.picture_ray(ON_WALL).unwrap()).unwrap();
    assert!((session.focus_at(&wall).unwrap().t - 1.3).abs() < 1e-5, "the wall stands at 4");
    let (map, curved) = (session.document().unwrap().map.clone(), picture(&session));
    assert!(curved != blank);

    let mut pose = session.document().unwrap().camera.camera_to_world;
    pose.w_axis.z -= 1.5;
    session.apply(Command::Camera(CameraEdit::Pose(pose))).unwrap();
    settle(&mut session);
    assert!((session.focus_at(&wall).unwrap().t - 1.0).abs() < 1e-5, "now at 2.5");
    session.apply(Command::Undo).unwrap();
    settle(&mut session);
    assert!(session.document().unwrap().map == map);
    for _ in 0..2 {
        session.apply(Command::Undo).unwrap();
    }
    settle(&mut session);
    assert!(picture(&session) == blank);
    for _ in 0..3 {
        session.apply(Command::Redo).unwrap();
    }
    settle(&mut session);
    assert!((session.focus_at(&wall).unwrap().t - 1.0).abs() < 1e-5);
    session.apply(Command::Undo).unwrap();
    settle(&mut session);
    assert!(session.document().unwrap().map == map && picture(&session) == curved);
}
