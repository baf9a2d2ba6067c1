//! A scene that another program writes again while it is open.

#[allow(dead_code, reason = "shared by several tests")]
mod at_work;
#[allow(dead_code, reason = "shared by several tests")]
mod tiny_glb;

use at_work::{opened, settle, stroke};
use session::{Command, Event, Session};
use std::path::Path;
use std::time::{Duration, Instant};
use tiny_glb::{QUADS, Quad};

/// Polls until the scene was followed, or for a while.
fn followed(session: &mut Session, wait: Duration) -> bool {
    let start = Instant::now();
    while start.elapsed() < wait {
        if session.poll().contains(&Event::Opened) {
            settle(session);
            return true;
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    false
}

fn write_moved(scene: &Path) {
    let moved = QUADS.map(|quad| Quad { center: [quad.center[0] + 1.0, quad.center[1]], ..quad });
    std::fs::write(scene, tiny_glb::glb(&moved)).unwrap();
}

#[test]
fn a_scene_of_a_bridge_is_followed_with_its_paint_and_others_are_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("quads.glb");
    tiny_glb::write(&scene);
    let mut session = opened(&scene);
    stroke(&mut session);
    session.apply(Command::CommitStroke).unwrap();
    settle(&mut session);
    let place = |session: &Session| session.document().unwrap().scene().positions[0].x;
    let painted = |session: &Session| {
        let document = session.document().unwrap();
        let rows = document.map.to_rows();
        rows.iter().filter(|[t, _]| (t - 1.0).abs() > 0.01).count()
    };
    let (before, count) = (place(&session), painted(&session));
    assert!(count > 100);
    write_moved(&scene);
    assert!(!followed(&mut session, Duration::from_secs(3)), "nobody looks at a scene without a manifest");

    tiny_glb::write(&scene);
    std::fs::write(folder.path().join("focus-brush.json"), "{}").unwrap();
    let project = folder.path().join("quads.fbrush");
    session.apply(Command::SaveAs(project.clone())).unwrap();
    settle(&mut session);
    session.apply(Command::Open(project.clone())).unwrap();
    settle(&mut session);
    write_moved(&scene);
    assert!(followed(&mut session, Duration::from_secs(30)));
    assert!((place(&session) - before - 1.0).abs() < 1e-6, "the scene is the new one");
    let now = painted(&session);
    assert!(now.abs_diff(count) * 20 < count, "the paint came along: {now} of {count} texels");
    let document = session.document().unwrap();
    assert!(document.is_unsaved() && document.path.as_deref() == Some(project.as_path()));
    session.apply(Command::Undo).unwrap();
    settle(&mut session);
    assert_eq!(painted(&session), 0, "it can be taken back");
}
