//! A camera that moves: its focus goes along, pictures follow it, and bookmarks bring it back.

#[allow(dead_code, reason = "shared by several tests")]
mod at_work;
#[allow(dead_code, reason = "only its quads are needed")]
mod tiny_glb;

use at_work::{opened, settle};
use document::{BookmarkEdit, CameraEdit, Document};
use glam::{DMat4, DVec3};
use lens::Camera;
use project::FocusHold;
use session::{Command, PreviewKind, Session};
use std::path::PathBuf;
use std::time::Duration;
use tempfile::TempDir;

fn quads() -> (Session, PathBuf, TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("quads.glb");
    tiny_glb::write(&scene);
    (opened(&scene), scene, folder)
}

fn document(session: &Session) -> &Document {
    session.document().unwrap()
}

/// The camera, moved ahead along its axis.
fn ahead(camera: &Camera, by: f64) -> CameraEdit {
    CameraEdit::Pose(camera.camera_to_world * DMat4::from_translation(DVec3::NEG_Z * by))
}

#[test]
fn what_was_clicked_stays_sharp_in_a_dolly_to_half_the_distance() {
    let (mut session, _, _folder) = quads();
    let hit = session.pick(&session.picture_ray(at_work::ON_WALL).unwrap()).unwrap();
    session.apply(Command::FocusHere(hit)).unwrap();
    let far = document(&session).held_camera();
    let distance = far.camera.focus_distance;
    assert_eq!(far.focus_hold, FocusHold::Point(hit.position));
    // A drag: many edits, one step.
    for step in 1..=10 {
        let moved = ahead(&far.camera, distance / 2.0 * f64::from(step) / 10.0);
        session.apply(Command::EditCamera(moved)).unwrap();
    }
    session.apply(Command::FinishEdit).unwrap();
    let near = document(&session).camera.clone();
    assert!((near.focus_distance - distance / 2.0).abs() < 1e-9 * distance, "{}", near.focus_distance);
    session.apply(Command::Undo).unwrap();
    assert_eq!(document(&session).held_camera(), far);
    session.apply(Command::Undo).unwrap();
    assert_ne!(document(&session).focus_hold, far.focus_hold, "what it was held on before");
    session.apply(Command::Redo).unwrap();
    session.apply(Command::EditCamera(CameraEdit::FocusOn(FocusHold::Distance))).unwrap();
    session.apply(Command::EditCamera(ahead(&far.camera, distance / 2.0))).unwrap();
    assert_eq!(document(&session).camera.focus_distance, distance, "the number can be held instead");
}

#[test]
fn bookmarks_are_saved_with_what_the_focus_is_held_on() {
    let (mut session, scene, _folder) = quads();
    let start = document(&session).held_camera();
    session.apply(Command::EditBookmarks(BookmarkEdit::Add)).unwrap();
    session.apply(Command::EditCamera(ahead(&start.camera, 0.5))).unwrap();
    session.apply(Command::EditBookmarks(BookmarkEdit::Add)).unwrap();
    session.apply(Command::EditCamera(CameraEdit::FocusOn(FocusHold::Distance))).unwrap();
    session.apply(Command::EditBookmarks(BookmarkEdit::Add)).unwrap();
    let held = document(&session).held_camera();
    let names = |session: &Session| -> Vec<String> {
        document(session).bookmarks().map(|bookmark| bookmark.name.clone()).collect()
    };
    assert_eq!(names(&session), ["View 1", "View 2", "View 3"]);
    for number in [0, 2] {
        session.apply(Command::EditBookmarks(BookmarkEdit::Rename(number, " door ".into()))).unwrap();
    }
    assert_eq!(names(&session), ["door", "View 2", "door 1"], "two of one name could not be told apart");
    session.apply(Command::EditBookmarks(BookmarkEdit::Remove(1))).unwrap();
    session.apply(Command::EditBookmarks(BookmarkEdit::Remove(7))).unwrap();
    assert!(session.apply(Command::GoToBookmark(2)).is_err());
    session.apply(Command::GoToBookmark(0)).unwrap();
    assert_eq!(document(&session).held_camera(), start);
    let project = scene.with_extension("fbrush");
    session.apply(Command::SaveAs(project.clone())).unwrap();
    settle(&mut session);
    drop(session);

    let mut session = opened(&project);
    assert_eq!(names(&session), ["door", "door 1"]);
    assert_eq!(document(&session).held_camera(), start);
    session.apply(Command::GoToBookmark(1)).unwrap();
    assert_eq!(document(&session).held_camera(), held);
    session.apply(Command::Undo).unwrap();
    assert_eq!(document(&session).held_camera(), start);
}

#[test]
fn pictures_without_blur_follow_a_camera_that_does_not_rest() {
    let (mut session, _, _folder) = quads();
    let start = document(&session).camera.clone();
    let (mut followed, mut last) = (0, session.preview().map_or(0, |preview| preview.id));
    // An edit every millisecond: every picture is out of date before it is finished.
    for step in 1..=2_000 {
        session.apply(Command::EditCamera(ahead(&start, f64::from(step) * 1e-4))).unwrap();
        session.poll();
        let shown = session.preview().filter(|preview| preview.id > last);
        if let Some(shown) = shown {
            assert_eq!(shown.kind, PreviewKind::Pinhole);
            (followed, last) = (followed + 1, shown.id);
        }
        if followed == 5 {
            break;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    assert_eq!(followed, 5, "the picture stands still while the camera moves");
    session.apply(Command::FinishEdit).unwrap();
    settle(&mut session);
    let shown = session.preview().unwrap();
    assert_eq!(shown.camera.camera_to_world, document(&session).camera.camera_to_world);
    assert_ne!(shown.kind, PreviewKind::Pinhole, "blur comes when it rests");
}
