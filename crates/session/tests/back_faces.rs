//! Faces seen from behind: not unless asked for, in picture, picking, paint and project alike.

mod tiny_glb;

use document::{CameraEdit, StrokePoint};
use glam::{DMat4, DVec2, DVec3};
use scene::BackFaces;
use session::{Command, Event, Quality, Session, SessionOptions};
use std::path::Path;
use std::time::{Duration, Instant};

const PATIENCE: Duration = Duration::from_secs(120);

/// Polls until `done`; what happened.
fn wait(session: &mut Session, what: &str, done: impl Fn(&Session, &[Event]) -> bool) -> Vec<Event> {
    let (start, mut events) = (Instant::now(), Vec::new());
    while !done(session, &events) {
        assert!(start.elapsed() < PATIENCE, "{what} never comes");
        std::thread::sleep(Duration::from_millis(2));
        events.extend(session.poll());
        assert!(!events.iter().any(|event| matches!(event, Event::Failed(_))), "{events:?}");
    }
    events
}

fn opened(file: &Path) -> Session {
    let options = SessionOptions { preview_size: 120, ..SessionOptions::default() };
    let mut session = Session::new(options).unwrap();
    session.apply(Command::Open(file.into())).unwrap();
    wait(&mut session, "a document", |session, _| session.document().is_some());
    session
}

/// Mean radiance of the picture once it is fine.
fn brightness(session: &mut Session) -> f32 {
    let is_fine = |session: &Session| {
        let revision_shown = session.preview().is_some_and(|preview| preview.quality == Quality::Viewing);
        revision_shown && session.is_settled()
    };
    wait(session, "a picture", |session, _| is_fine(session));
    let picture = session.preview().unwrap().picture.fetch().unwrap();
    picture.radiance.iter().flatten().sum::<f32>() / picture.radiance.len() as f32
}

fn switch(session: &mut Session, back_faces: BackFaces) {
    session.apply(Command::SetBackFaces(back_faces)).unwrap();
    wait(session, "another surface", |_, events| events.contains(&Event::SurfaceChanged));
    assert_eq!(session.document().unwrap().stage.scene.back_faces, back_faces);
}

#[test]
fn a_wall_seen_from_behind_is_there_when_it_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("quads.glb");
    tiny_glb::write(&scene);
    let mut session = opened(&scene);
    let middle = DVec2::splat(0.5);
    let sees = |session: &Session| session.pick(&session.picture_ray(middle).unwrap()).is_some();
    assert!(sees(&session) && brightness(&mut session) > 0.1, "from its front the wall is seen");
    // From behind it.
    let pose =
        DMat4::from_translation(DVec3::new(0.0, 0.0, -8.0)) * DMat4::from_rotation_y(std::f64::consts::PI);
    session.apply(Command::EditCamera(CameraEdit::Pose(pose))).unwrap();
    assert!(!sees(&session));
    assert!(brightness(&mut session) == 0.0, "from behind it is not");
    let before = session.document().unwrap().map.clone();
    let stroke = |session: &mut Session| {
        let ray = session.picture_ray(middle).unwrap();
        session.apply(Command::BeginStroke(StrokePoint::from_ray(ray))).unwrap();
        session.apply(Command::CommitStroke).unwrap();
    };
    stroke(&mut session);
    assert!(session.document().unwrap().map == before, "nothing there to paint on");

    switch(&mut session, BackFaces::Show);
    assert!(sees(&session) && brightness(&mut session) > 0.1 && session.document().unwrap().is_unsaved());
    stroke(&mut session);
    assert!(session.document().unwrap().map != before);
    let project = folder.path().join("shown.fbrush");
    session.apply(Command::SaveAs(project.clone())).unwrap();
    wait(&mut session, "the file", |_, events| {
        events.iter().any(|event| matches!(event, Event::FileWritten(_)))
    });
    let mut again = opened(&project);
    assert!(sees(&again) && brightness(&mut again) > 0.1, "a project keeps it");

    switch(&mut again, BackFaces::Hide);
    assert!(!sees(&again) && brightness(&mut again) == 0.0);
    // Two switches in a row: the last one counts.
    again.apply(Command::SetBackFaces(BackFaces::Show)).unwrap();
    again.apply(Command::SetBackFaces(BackFaces::Hide)).unwrap();
    wait(&mut again, "rest", |session, _| session.is_settled());
    assert_eq!(again.document().unwrap().stage.scene.back_faces, BackFaces::Hide);
}
