//! Painted, looked at, undone.

#[allow(dead_code, reason = "shared by several tests")]
mod at_work;
#[allow(dead_code, reason = "shared by several tests")]
mod tiny_glb;

use at_work::{ON_WALL, opened, picture, settle, stroke};
use document::{CameraEdit, FillRegion};
use glam::DVec2;
use lens::FocusOffset;
use render::{Display, Tone, to_screen};
use session::{Command, Event, Session, SessionError};

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
        session.screen().pixels() == to_screen(&session.preview().unwrap().picture.fetch().unwrap(), tone)
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

    let wrong = session.apply(Command::EditCamera(CameraEdit::FocusDistance(-1.0)));
    assert!(matches!(wrong, Err(SessionError::BadInput(_))));
    session.apply(Command::EditCamera(CameraEdit::FNumber(1.0))).unwrap();
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
fn depth_curves_follow_the_camera_and_come_back_with_it() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("quads.glb");
    tiny_glb::write(&scene);
    let mut session = opened(&scene);
    let blank = picture(&session);
    session.apply(Command::EditLayers(focus::LayerEdit::AddCurve)).unwrap();
    let curve = focus::Curve::new([[2.5f64.ln(), 1.0], [4.0f64.ln(), 1.3]]).unwrap();
    let curve = focus::DepthCurve { curve, anchor: 1.0 };
    session.apply(Command::EditLayers(focus::LayerEdit::Curve(1, curve))).unwrap();
    settle(&mut session);
    let wall = session.pick(&session.picture_ray(ON_WALL).unwrap()).unwrap();
    assert!((session.focus_at(&wall).unwrap().t - 1.3).abs() < 1e-5, "the wall stands at 4");
    let (map, curved) = (session.document().unwrap().map.clone(), picture(&session));
    assert!(curved != blank);

    let mut pose = session.document().unwrap().camera.camera_to_world;
    pose.w_axis.z -= 1.5;
    session.apply(Command::EditCamera(CameraEdit::Pose(pose))).unwrap();
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
