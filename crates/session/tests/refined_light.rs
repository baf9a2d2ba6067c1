//! Light that is refined: begun when nothing changes, taken up where it is better, kept, and stopped when the user says so.

#[allow(dead_code, reason = "shared by several tests")]
mod tiny_glb;

use document::{CameraEdit, StrokePoint};
use focus::Brush;
use glam::DVec2;
use lens::{FocusOffset, Picture};
use render::LightFieldStore;
use session::{Command, Event, Preview, Quality, Session, SessionOptions};
use std::path::Path;
use std::time::{Duration, Instant};

const PATIENCE: Duration = Duration::from_secs(120);

/// Polls until `done`.
fn wait(session: &mut Session, what: &str, done: impl Fn(&Session) -> bool) {
    let start = Instant::now();
    while !done(session) {
        assert!(start.elapsed() < PATIENCE, "{what} never comes: {:?}", session.preview().map(|p| p.costs));
        std::thread::sleep(Duration::from_millis(2));
        for event in session.poll() {
            assert!(!matches!(event, Event::Failed(_)), "{event:?}");
        }
    }
}

fn preview(session: &Session) -> &Preview {
    session.preview().expect("a preview")
}

fn shown(session: &Session) -> Picture {
    (*preview(session).picture.fetch().unwrap()).clone()
}

fn is_exact_by(session: &Session, passes: u32) -> bool {
    let has_seen_all = |preview: &Preview| preview.map_serial == session.map_serial();
    session.preview().is_some_and(|preview| {
        preview.quality == Quality::Exact && preview.costs.light_passes >= passes && has_seen_all(preview)
    })
}

/// A session whose light is refined by at most so many passes, its light fields kept in a folder.
fn opened(scene: &Path, light_passes: u32, store: Option<&Path>) -> Session {
    let light_fields =
        store.map(|folder| LightFieldStore::new(folder.to_path_buf()).with_shortest_bake(Duration::ZERO));
    let options = SessionOptions {
        preview_size: 60,
        exact_delay: Some(Duration::from_millis(20)),
        light_passes,
        light_field_store: light_fields,
        ..SessionOptions::default()
    };
    let mut session = Session::new(options).unwrap();
    session.apply(Command::Open(scene.into())).unwrap();
    wait(&mut session, "a document", |session| session.document().is_some());
    session
}

fn of_metal(folder: &Path) -> std::path::PathBuf {
    let scene = folder.join("metal.glb");
    std::fs::write(&scene, tiny_glb::metal(&tiny_glb::QUADS)).unwrap();
    scene
}

/// How far two pictures are apart, root mean square.
fn apart(a: &Picture, b: &Picture) -> f64 {
    let pairs = a.radiance.iter().flatten().zip(b.radiance.iter().flatten());
    let sum: f64 = pairs.map(|(a, b)| f64::from(a - b).powi(2)).sum();
    (sum / (3 * a.radiance.len()) as f64).sqrt()
}

fn is_refining(session: &Session) -> bool {
    session.jobs().iter().any(|job| job.label.contains("light"))
}

#[test]
fn light_is_refined_when_nothing_changes_and_what_was_refined_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let scene = of_metal(folder.path());
    let store = folder.path().join("kept");
    let mut session = opened(&scene, 256, Some(&store));
    wait(&mut session, "the exact picture", |session| is_exact_by(session, 0));
    let at_once = shown(&session);
    assert_eq!(preview(&session).costs.light_passes, 0);
    wait(&mut session, "better light", |session| is_exact_by(session, 1));
    let first = preview(&session).costs;
    assert!(first.light_passes >= 16, "the first is only compared with: {first:?}");
    let told = first.light_psnr.expect("how far the light at once is off");
    wait(&mut session, "the best light", |session| is_exact_by(session, 256));
    let best = shown(&session);
    assert_eq!(preview(&session).costs.light_psnr, Some(told), "it is still told");
    let found = -20.0 * apart(&at_once, &best).log10();
    assert!((found - told).abs() < 3.0, "{found} dB apart, {told} dB told");
    wait(&mut session, "an end of it", |session| !is_refining(session));
    drop(session);

    // Another session has it from the folder, and nothing to refine.
    let mut again = opened(&scene, 256, Some(&store));
    wait(&mut again, "what was kept", |session| is_exact_by(session, 0));
    assert_eq!(preview(&again).costs.light_passes, 256);
    assert!(apart(&shown(&again), &best) < 1e-6, "it is the same picture");
    assert!(!is_refining(&again));
}

#[test]
fn paint_does_not_stop_it_and_a_moved_camera_and_the_user_do() {
    let folder = tempfile::tempdir().unwrap();
    let scene = of_metal(folder.path());
    let mut session = opened(&scene, 64, None);
    wait(&mut session, "light that is refined", is_refining);
    // A stroke shows while it goes on, and is there when it is done.
    let before = shown(&session);
    let target = FocusOffset::new(1.2, 1.0);
    let brush = Brush { radius: 0.3, target, ..session.document().unwrap().brush.clone() };
    session.apply(Command::SetBrush(brush)).unwrap();
    let ray = session.picture_ray(DVec2::new(0.75, 0.75)).unwrap();
    session.apply(Command::BeginStroke(StrokePoint::from_ray(ray))).unwrap();
    session.apply(Command::CommitStroke).unwrap();
    wait(&mut session, "the stroke", |session| preview(session).map_serial == session.map_serial());
    assert!(apart(&shown(&session), &before) > 1e-4, "it shows");
    wait(&mut session, "the best light", |session| is_exact_by(session, 64));
    let painted = shown(&session);
    session.apply(Command::Undo).unwrap();
    wait(&mut session, "the picture without the stroke", |session| is_exact_by(session, 64));
    let unpainted = shown(&session);
    assert!(apart(&unpainted, &painted) > 1e-4, "the stroke was still there, and went");

    session
        .apply(Command::EditCamera(CameraEdit::Pose(glam::DMat4::from_translation(glam::DVec3::X * 0.1))))
        .unwrap();
    wait(&mut session, "the other view", |session| {
        preview(session).quality >= Quality::Viewing && preview(session).costs.light_passes == 0
    });
    wait(&mut session, "light that is refined", is_refining);
    let job = session.jobs().into_iter().find(|job| job.label.contains("light")).unwrap();
    session.apply(Command::Cancel(job.id)).unwrap();
    wait(&mut session, "an end of it", |session| !is_refining(session));
    let until = Instant::now() + Duration::from_millis(300);
    while Instant::now() < until {
        session.poll();
        assert!(!is_refining(&session), "it does not begin by itself");
    }
}
