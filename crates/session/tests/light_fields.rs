//! Light fields are kept: a scene that was baked once opens without being baked again, with the same picture.

mod tiny_glb;

use document::{CameraEdit, FillRegion};
use lens::{FocusOffset, Picture};
use render::LightFieldStore;
use session::{Command, Event, FullSizeFieldState, Preview, Quality, Session, SessionOptions};
use std::path::Path;
use std::time::{Duration, Instant};

const PATIENCE: Duration = Duration::from_secs(120);

/// Polls until `done`.
fn wait(session: &mut Session, what: &str, done: impl Fn(&Session) -> bool) {
    let start = Instant::now();
    while !done(session) {
        assert!(start.elapsed() < PATIENCE, "{what} never comes");
        std::thread::sleep(Duration::from_millis(2));
        for event in session.poll() {
            assert!(!matches!(event, Event::Failed(_)), "{event:?}");
        }
    }
}

fn opened(scene: &Path, folder: &Path) -> Session {
    let store = LightFieldStore::new(folder.into()).with_shortest_bake(Duration::ZERO);
    let keep_after = Duration::from_secs(3600);
    let options = SessionOptions {
        preview_size: 240,
        recovery_delay: keep_after,
        light_field_store: Some(store),
        ..SessionOptions::default()
    };
    let mut session = Session::new(options).unwrap();
    session.apply(Command::Open(scene.into())).unwrap();
    wait(&mut session, "a document", |session| session.document().is_some());
    session
}

fn fine(session: &mut Session) -> Picture {
    let is_fine = |preview: &Preview| preview.quality == Quality::Viewing;
    wait(session, "a picture", |session| session.preview().is_some_and(is_fine) && session.is_settled());
    (*session.preview().unwrap().picture.fetch().unwrap()).clone()
}

/// The files that are kept, once there are as many.
fn kept(folder: &Path, count: usize) -> Vec<std::path::PathBuf> {
    let start = Instant::now();
    loop {
        let listing = std::fs::read_dir(folder).into_iter().flatten();
        let files: Vec<_> = listing.map(|entry| entry.unwrap().path()).collect();
        let files: Vec<_> =
            files.into_iter().filter(|file| file.extension().is_some_and(|e| e == "salf")).collect();
        if files.len() == count {
            return files;
        }
        assert!(start.elapsed() < PATIENCE, "{files:?}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_scene_that_was_baked_once_is_not_baked_again() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("quads.glb");
    tiny_glb::write(&scene);
    let store = folder.path().join("kept");
    let mut session = opened(&scene, &store);
    let picture = fine(&mut session);
    let files = kept(&store, 1);
    // The second time it comes from the file: one that says otherwise is believed.
    drop(session);
    assert!(fine(&mut opened(&scene, &store)) == picture, "the same bits");
    let mut file = salf::SalfFile::read(std::fs::File::open(&files[0]).unwrap()).unwrap();
    let salf = std::sync::Arc::make_mut(&mut file.salf);
    salf.samples = salf.samples.changed(|sample| sample.radiance *= 0.5);
    file.write(std::fs::File::create(&files[0]).unwrap()).unwrap();
    let mut session = opened(&scene, &store);
    let dimmed = fine(&mut session);
    let sum = |picture: &Picture| picture.radiance.iter().flatten().map(|&c| f64::from(c)).sum::<f64>();
    assert!((sum(&dimmed) / sum(&picture) - 0.5).abs() < 1e-3, "{} {}", sum(&dimmed), sum(&picture));
    // F5 bakes whatever is kept, and keeps that.
    session.apply(Command::Bake).unwrap();
    wait(&mut session, "another picture", |session| {
        session
            .preview()
            .is_some_and(|p| p.quality == Quality::Viewing && *p.picture.fetch().unwrap() == picture)
    });
    drop(session);
    assert_eq!(kept(&store, 1), files);

    // Paint that reaches further than what is kept, another pose and another scene are baked; so is what is damaged.
    let mut session = opened(&scene, &store);
    fine(&mut session);
    session.apply(Command::EditCamera(CameraEdit::YFov(0.6))).unwrap();
    fine(&mut session);
    kept(&store, 2);
    let radiance_of = |session: &Session| session.preview().unwrap().modelled.sample_count();
    session.apply(Command::Fill(FillRegion::All, FocusOffset::new(1.6, 1.0))).unwrap();
    let before = radiance_of(&session);
    wait(&mut session, "a wider margin", |session| radiance_of(session) > before && session.is_settled());
    drop(session);
    std::fs::write(&files[0], b"FBSALF").unwrap();
    assert!(fine(&mut opened(&scene, &store)) == picture);
}

#[test]
fn an_export_takes_the_light_field_that_is_being_made() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("quads.glb");
    tiny_glb::write(&scene);
    let options = SessionOptions {
        preview_size: 240,
        recovery_delay: Duration::from_secs(3600),
        ..SessionOptions::default()
    };
    let mut session = Session::new(options).unwrap();
    session.apply(Command::Open(scene)).unwrap();
    wait(&mut session, "a document", |session| session.document().is_some());
    session.apply(Command::EditCamera(CameraEdit::Size(240, 160))).unwrap();
    assert_eq!(session.export_field_state(&Default::default()), FullSizeFieldState::InProgress);
    let path = folder.path().join("picture.png");
    session.apply(Command::ExportPicture(path.clone(), Default::default())).unwrap();
    let mut steps = std::collections::BTreeSet::new();
    let start = Instant::now();
    while !path.exists() {
        assert!(start.elapsed() < PATIENCE, "it is never written");
        let rendering = session.jobs().into_iter().filter(|job| job.label.starts_with("rendering"));
        steps.extend(rendering.map(|job| job.step));
        for event in session.poll() {
            assert!(!matches!(event, Event::Failed(_)), "{event:?}");
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    assert!(steps.contains("baking the live picture") && !steps.contains("baking"), "{steps:?}");
    fine(&mut session);
    assert_eq!(session.export_field_state(&Default::default()), FullSizeFieldState::Ready);
    session.apply(Command::EditCamera(CameraEdit::Size(480, 320))).unwrap();
    assert_eq!(
        session.export_field_state(&Default::default()),
        FullSizeFieldState::Missing,
        "the live picture is smaller"
    );
}
