//! A floor that catches shadows: put under a scene, undone, kept with the project; paint stays where it is.

#[allow(dead_code, reason = "shared by several tests")]
mod at_work;
#[allow(dead_code, reason = "shared by several tests")]
mod tiny_glb;

use at_work::{opened, picture, settle, stroke};
use glam::Vec3;
use scene::{Backdrop, World};
use session::{Command, Event, Session};
use std::time::Duration;

fn is_on_floor(session: &Session) -> Option<bool> {
    session.document().unwrap().scene().floor.map(|floor| floor.is_shown)
}

fn apply(session: &mut Session, command: Command) -> Vec<Event> {
    session.apply(command).unwrap();
    settle(session)
}

/// The focus map, as far down as it was without a floor.
fn upper_rows(session: &Session, texels: usize) -> Vec<[f32; 2]> {
    session.document().unwrap().map.to_rows()[..texels].to_vec()
}

#[test]
fn it_comes_goes_and_is_saved() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("quads.glb");
    std::fs::write(&file, tiny_glb::metal(&tiny_glb::QUADS)).unwrap();
    let mut session = opened(&file);
    stroke(&mut session);
    apply(&mut session, Command::CommitStroke);
    let painted = session.document().unwrap().map.to_rows();
    let count = painted.len();
    assert!(painted.iter().any(|texel| *texel != painted[0]), "the stroke painted something");
    apply(&mut session, Command::EditLayers(focus::LayerEdit::Opacity(0, 0.5)));
    let faded = session.document().unwrap().map.to_rows();
    let before = picture(&session).radiance;

    apply(&mut session, Command::SetFloor(true));
    assert_eq!(is_on_floor(&session), Some(true));
    let document = session.document().unwrap();
    assert!(document.map.to_rows().len() > count && document.map.size() == document.layers.size());
    assert_eq!(upper_rows(&session, count), faded);
    assert_ne!(picture(&session).radiance, before, "the floor is seen");

    apply(&mut session, Command::Undo);
    assert_eq!(is_on_floor(&session), Some(false));
    apply(&mut session, Command::Undo);
    assert_eq!(upper_rows(&session, count), painted, "a step from before the floor is undone");
    apply(&mut session, Command::Undo);
    assert!(session.document().unwrap().map.to_rows().iter().all(|texel| *texel == painted[0]));
    for _ in 0..3 {
        apply(&mut session, Command::Redo);
    }
    assert_eq!((is_on_floor(&session), upper_rows(&session, count)), (Some(true), faded.clone()));

    let project = folder.path().join("floor.fbrush");
    apply(&mut session, Command::SaveAs(project.clone()));
    let shown = picture(&session).radiance;
    drop(session);
    let again = opened(&project);
    assert_eq!((is_on_floor(&again), upper_rows(&again, count)), (Some(true), faded));
    assert_eq!(again.document().unwrap().warnings, [""; 0]);
    assert_eq!(picture(&again).radiance, shown);
}

#[test]
fn it_takes_the_colour_of_another_backdrop() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("quads.glb");
    std::fs::write(&file, tiny_glb::metal(&tiny_glb::QUADS[1..])).unwrap();
    let mut session = opened(&file);
    apply(&mut session, Command::SetFloor(true));
    let color = |session: &Session| session.document().unwrap().scene().floor_color().unwrap();
    let grey = color(&session);
    let red = Backdrop::Color(Vec3::new(0.3, 0.02, 0.02));
    apply(&mut session, Command::SetWorld(Some(World { backdrop: red, ..World::studio() })));
    let after = color(&session);
    assert!(after.x > 1.2 * grey.x && after.y < 0.5 * grey.y, "{grey} {after}");
}

#[test]
fn a_scene_that_casts_no_shadow_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("quads.glb");
    tiny_glb::write(&file);
    let mut session = opened(&file);
    session.apply(Command::SetFloor(true)).unwrap();
    let failure = loop {
        let failed = session.poll().into_iter().find_map(|event| match event {
            Event::Failed(why) => Some(why),
            _ => None,
        });
        match failed {
            Some(why) => break why,
            None => std::thread::sleep(Duration::from_millis(5)),
        }
    };
    assert!(failure.contains("no shadow") && is_on_floor(&session).is_none(), "{failure}");
}
