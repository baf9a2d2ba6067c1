//! Gaussian splats beside meshes: added, hidden, undone, moved, saved and opened again.

#[allow(dead_code, reason = "shared by several tests")]
mod at_work;
#[allow(dead_code, reason = "shared by several tests")]
mod tiny_glb;

use at_work::{opened, picture, settle, stroke};
use document::{Document, NewDocumentOptions};
use focus::{CombineMode, FillTarget};
use glam::DVec3;
use progress::Unwatched;
use project::{SelectionShape, SplatsFile};
use scene::{SplatCleanup, SplatEdit, SplatTransform};
use session::{Command, Event, Session};
use std::path::{Path, PathBuf};

/// Splats of a wall, and one that floats beside it.
const WALL: usize = 144;

/// A file of splats (.splat): a green wall at the depth of 3, in front of the middle of the grey one, and a floater nearer.
fn scan() -> Vec<u8> {
    let place = |k: usize| [(k % 12) as f32 * 0.05 + 0.2, (k / 12) as f32 * 0.05 - 0.3, 3.0];
    let places = (0..WALL).map(place).chain([[-0.7, 0.6, 2.0]]);
    let row = |place: [f32; 3]| {
        let floats = place.into_iter().chain([0.05, 0.05, 0.01]);
        // The axes of the file are right, down, forward.
        floats.flat_map(f32::to_le_bytes).chain([40, 220, 60, 250, 255, 128, 128, 128]).collect::<Vec<_>>()
    };
    places.flat_map(row).collect()
}

struct Place {
    folder: tempfile::TempDir,
}

impl Place {
    /// A project of a scene and a scan.
    fn new() -> Self {
        let place = Self { folder: tempfile::tempdir().unwrap() };
        tiny_glb::write(&place.path("quads.glb"));
        std::fs::write(place.path("scan.splat"), scan()).unwrap();
        let splats = SplatsFile { file: Some(place.path("scan.splat")), ..SplatsFile::default() };
        let options = NewDocumentOptions { splats: Some(&splats), ..NewDocumentOptions::default() };
        let scene = place.path("quads.glb");
        let document =
            Document::create(&scene, &options, &Default::default(), &Default::default(), &Unwatched);
        document.unwrap().to_project().save(&place.path("both.fbrush")).unwrap();
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn opened(&self) -> Session {
        opened(&self.path("both.fbrush"))
    }
}

fn hidden(session: &Session) -> usize {
    session.document().unwrap().scene().splats.as_ref().unwrap().cloud.hidden_count()
}

fn edit(session: &mut Session, edit: SplatEdit) -> Vec<Event> {
    session.apply(Command::EditSplats("Edit splats", edit.into())).unwrap();
    settle(session)
}

/// How green the picture is where the scan's wall is, and where its floater is.
fn green(session: &Session) -> [f32; 2] {
    let picture = picture(session);
    // Positions are x/z and y/z; the picture is 2 tan 0.3 high.
    let at = |x: f64, y: f64| {
        let half = 0.3f64.tan();
        let column = (0.5 * f64::from(picture.width) + 0.5 * f64::from(picture.height) * x / half) as u32;
        let row = (0.5 * f64::from(picture.height) * (1.0 - y / half)) as u32;
        let [red, green, _] = picture.radiance[(row * picture.width + column) as usize];
        green - red
    };
    [at(0.48 / 3.0, 0.0), at(-0.7 / 2.0, -0.6 / 2.0)]
}

fn floaters(max_distance: f64) -> SplatEdit {
    let cleanup = SplatCleanup { max_distance: Some(max_distance), ..SplatCleanup::default() };
    SplatEdit { cleanup, ..SplatEdit::default() }
}

#[test]
fn a_floater_is_hidden_undone_and_saved_and_paint_stays() {
    let place = Place::new();
    let scan = std::fs::read(place.path("scan.splat")).unwrap();
    let mut session = place.opened();
    let [wall, floater] = green(&session);
    assert!(wall > 0.3 && floater > 0.2, "{wall} {floater}");
    stroke(&mut session);
    session.apply(Command::CommitStroke).unwrap();
    settle(&mut session);
    let map = session.document().unwrap().map.clone();

    assert!(edit(&mut session, floaters(0.2)).contains(&Event::SurfaceChanged));
    assert_eq!(hidden(&session), 1);
    let [wall, floater] = green(&session);
    assert!(wall > 0.3 && floater < 0.1, "{wall} {floater}");
    let document = session.document().unwrap();
    assert!(document.map == map && document.is_unsaved());

    session.apply(Command::Undo).unwrap();
    settle(&mut session);
    assert!(hidden(&session) == 0 && green(&session)[1] > 0.2);
    session.apply(Command::Redo).unwrap();
    settle(&mut session);
    assert_eq!(hidden(&session), 1);
    session.apply(Command::Save).unwrap();
    settle(&mut session);

    let again = place.opened();
    assert_eq!(hidden(&again), 1);
    assert!(again.document().unwrap().map == map && green(&again)[1] < 0.1);
    assert_eq!(again.document().unwrap().warnings, [""; 0]);
    assert_eq!(std::fs::read(place.path("scan.splat")).unwrap(), scan, "the scan's file is never written");
}

#[test]
fn what_is_selected_is_hidden_and_all_is_shown_again() {
    let place = Place::new();
    let mut session = place.opened();
    let error = session.apply(Command::HideSelectedSplats).unwrap_err().to_string();
    assert!(error.contains("no Gaussian splat is selected"), "{error}");
    let scan = session.document().unwrap().scene().nodes.iter().position(|node| node.name == "scan").unwrap();
    let shape = SelectionShape::Targets(vec![FillTarget::Node(scan as u32)]);
    session.apply(Command::Select(shape, CombineMode::Replace)).unwrap();
    settle(&mut session);
    session.apply(Command::HideSelectedSplats).unwrap();
    settle(&mut session);
    assert_eq!(hidden(&session), WALL + 1);
    assert!(green(&session).iter().all(|green| *green < 0.1), "{:?}", green(&session));
    let shown = session.document().unwrap().splat_edit_showing_all().unwrap();
    edit(&mut session, shown);
    assert_eq!(hidden(&session), 0);
    assert!(session.document().unwrap().splat_edit_showing_all().is_none());
}

#[test]
fn splats_are_moved_with_what_is_painted_on_them() {
    let place = Place::new();
    let mut session = place.opened();
    let low = |session: &Session| session.document().unwrap().scene().splats.as_ref().unwrap().bounds().0;
    let before = low(&session);
    let transform = SplatTransform { translation: DVec3::new(0.0, 5.0, 0.0), ..SplatTransform::default() };
    edit(&mut session, SplatEdit { transform, ..SplatEdit::default() });
    assert!((low(&session) - before).distance(DVec3::new(0.0, 5.0, 0.0)) < 1e-9);
    assert!(green(&session).iter().all(|green| *green < 0.1), "they are out of the picture");
    let bad = SplatTransform { scale: f64::NAN, ..transform };
    session
        .apply(Command::EditSplats(
            "Scale splats",
            SplatEdit { transform: bad, ..SplatEdit::default() }.into(),
        ))
        .unwrap();
    let mut events = session.poll();
    while !session.is_idle() {
        std::thread::sleep(std::time::Duration::from_millis(5));
        events.extend(session.poll());
    }
    let failed = |event: &Event| format!("{event:?}").contains("cannot be placed");
    assert!(events.iter().any(failed), "{events:?}");
}

#[test]
fn a_scan_that_is_missing_is_named() {
    let place = Place::new();
    std::fs::remove_file(place.path("scan.splat")).unwrap();
    let file: &Path = &place.path("both.fbrush");
    let error = document::Input::open(file, &Default::default(), &Unwatched).err().unwrap().to_string();
    assert!(error.contains("scan.splat are missing (restore that file)"), "{error}");
}
