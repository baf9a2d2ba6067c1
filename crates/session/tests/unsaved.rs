//! What is unsaved, and what is not any more because it was undone.

#[allow(dead_code, reason = "shared by several tests")]
mod at_work;
#[allow(dead_code, reason = "only its quads are needed")]
mod tiny_glb;

use at_work::{opened, settle};
use document::{BookmarkEdit, CameraEdit, FillRegion};
use focus::CombineMode;
use lens::FocusOffset;
use session::{Command, Session};

fn is_unsaved(session: &Session) -> bool {
    session.document().unwrap().is_unsaved()
}

#[test]
fn what_was_undone_is_as_it_was_saved() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("quads.glb");
    tiny_glb::write(&scene);
    let mut session = opened(&scene);
    let wall = session.pick(&session.picture_ray(at_work::ON_WALL).unwrap()).unwrap();
    let mut after = |command: Command| {
        session.apply(command).unwrap();
        settle(&mut session);
        is_unsaved(&session)
    };
    let fill = || Command::Fill(FillRegion::All, FocusOffset::new(1.2, 1.0));
    assert!(after(fill()));
    assert!(!after(Command::Undo), "as it was opened");
    assert!(after(Command::Redo));
    assert!(!after(Command::SaveAs(folder.path().join("a.fbrush"))));
    assert!(after(Command::Undo), "the file has it");
    assert!(!after(Command::Redo));
    assert!(
        !after(Command::SelectRegion(FillRegion::Node(wall), CombineMode::Replace)),
        "no change of the picture"
    );
    assert!(after(Command::EditCamera(CameraEdit::FocusDistance(2.5))));
    assert!(!after(Command::Undo));
    assert!(!after(Command::Undo), "the selection");
    // Another way is another state, as many steps as it may have.
    assert!(after(Command::Undo));
    assert!(after(Command::Fill(FillRegion::All, FocusOffset::new(1.3, 1.0))));
    assert!(after(Command::Undo));
    assert!(!after(Command::Save));
    // A bookmark is no step, and cannot be undone.
    assert!(after(Command::EditBookmarks(BookmarkEdit::Add)));
    assert!(after(fill()) && after(Command::Undo));
}
