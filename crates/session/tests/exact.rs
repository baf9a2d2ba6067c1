//! The exact picture: drawn when nothing changes, given up when something does, never lost where nothing did.

mod tiny_glb;

use document::{CameraEdit, StrokePoint};
use focus::Brush;
use glam::DVec2;
use lens::{FocusOffset, Picture};
use render::{Tone, to_screen};
use session::{Command, Event, Preview, Quality, Session, SessionOptions};
use splat::Tolerance;
use std::path::Path;
use std::time::{Duration, Instant};

const PATIENCE: Duration = Duration::from_secs(120);

/// Polls until `done`.
fn wait(session: &mut Session, what: &str, done: impl Fn(&Session) -> bool) {
    let start = Instant::now();
    while !done(session) {
        assert!(start.elapsed() < PATIENCE, "{what} never comes: {:?}", session.preview().map(|p| p.quality));
        std::thread::sleep(Duration::from_millis(2));
        for event in session.poll() {
            assert!(!matches!(event, Event::Failed(_)), "{event:?}");
        }
    }
}

fn preview(session: &Session) -> &Preview {
    session.preview().expect("a preview")
}

/// The picture of this quality that has seen all changes.
fn wait_for(session: &mut Session, quality: Quality) -> Picture {
    wait(session, &format!("{quality:?}"), |session| {
        let preview = session.preview();
        preview
            .is_some_and(|preview| preview.quality == quality && preview.map_serial == session.map_serial())
            && session.is_settled()
    });
    (*preview(session).picture.fetch().unwrap()).clone()
}

fn opened(scene: &Path, exact_after: Option<Duration>) -> Session {
    let keep_after = Duration::from_secs(3600);
    let options = SessionOptions {
        preview_size: 240,
        exact_delay: exact_after,
        recovery_delay: keep_after,
        ..SessionOptions::default()
    };
    let mut session = Session::new(options).unwrap();
    session.apply(Command::Open(scene.into())).unwrap();
    wait(&mut session, "a document", |session| session.document().is_some());
    session
}

/// A dab on the wall, as a stroke of one point.
fn dab(session: &mut Session, x: f64) {
    let target = FocusOffset::new(1.2, 1.0);
    let brush = Brush { radius: 0.15, target, ..session.document().unwrap().brush.clone() };
    session.apply(Command::SetBrush(brush)).unwrap();
    let ray = session.picture_ray(DVec2::new(x, 0.75)).unwrap();
    session.apply(Command::BeginStroke(StrokePoint::from_ray(ray))).unwrap();
    session.apply(Command::CommitStroke).unwrap();
}

/// What is on screen is the preview's picture.
fn shows_preview(session: &Session) -> bool {
    let tone = Tone { exposure: session.document().unwrap().exposure, display: session.display() };
    session.screen().pixels() == to_screen(&preview(session).picture.fetch().unwrap(), tone)
}

#[test]
fn idle_makes_the_picture_exact_and_a_stroke_leaves_the_rest_of_it_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("quads.glb");
    tiny_glb::write(&scene);
    // Long enough that a busy machine sees the picture before.
    let mut session = opened(&scene, Some(Duration::from_secs(1)));
    let viewing = wait_for(&mut session, Quality::Viewing);
    assert_eq!(preview(&session).costs.viewing_psnr, None, "nothing is known yet");
    let exact = wait_for(&mut session, Quality::Exact);
    assert!(exact != viewing && shows_preview(&session));
    let psnr = preview(&session).costs.viewing_psnr.expect("now it is known");
    assert!((20.0..200.0).contains(&psnr), "{psnr} dB");

    // Every dab is local, also the first.
    let paints = |session: &mut Session, x: f64, before: &Picture| {
        dab(session, x);
        let painted = wait_for(session, Quality::Viewing);
        assert!(shows_preview(session));
        let changed = painted.radiance.iter().zip(&before.radiance).filter(|(a, b)| a != b).count();
        assert!(changed > 50, "the dab shows");
        assert!(changed < painted.radiance.len() / 4, "and the exact picture stays beside it: {changed}");
        painted
    };
    paints(&mut session, 0.75, &exact);
    let exact_of_first = wait_for(&mut session, Quality::Exact);
    let painted = paints(&mut session, 0.6, &exact_of_first);
    assert!(preview(&session).costs.viewing_psnr.is_some(), "what is known of the lens stays known");
    let after = wait_for(&mut session, Quality::Exact);
    assert!(after != painted && shows_preview(&session));

    // The same bits as in a session that knows no tolerance.
    let mut other = opened(&scene, None);
    other.apply(Command::SetTolerance(Tolerance::NONE)).unwrap();
    assert!(wait_for(&mut other, Quality::Exact) == exact);
    dab(&mut other, 0.75);
    assert!(wait_for(&mut other, Quality::Exact) == exact_of_first);
    dab(&mut other, 0.6);
    assert!(wait_for(&mut other, Quality::Exact) == after);

    session.apply(Command::Undo).unwrap();
    session.apply(Command::Undo).unwrap();
    wait_for(&mut session, Quality::Viewing);
    assert!(wait_for(&mut session, Quality::Exact) == exact);
    // Another lens is another picture.
    session.apply(Command::EditCamera(CameraEdit::FocusDistance(2.5))).unwrap();
    wait_for(&mut session, Quality::Viewing);
    assert!(wait_for(&mut session, Quality::Exact) != exact);
}

#[test]
fn without_the_wish_no_exact_picture_is_drawn_and_the_tolerance_is_the_users() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("quads.glb");
    tiny_glb::write(&scene);
    let mut session = opened(&scene, None);
    // Blurred enough that much can be drawn from coarse nodes.
    session.apply(Command::EditCamera(CameraEdit::FNumber(0.7))).unwrap();
    session.apply(Command::EditCamera(CameraEdit::FocusDistance(0.8))).unwrap();
    wait(&mut session, "the lens", |session| session.is_settled());
    let fine = wait_for(&mut session, Quality::Viewing);
    std::thread::sleep(Duration::from_millis(300));
    session.poll();
    assert_eq!(preview(&session).quality, Quality::Viewing);
    assert_eq!(session.exact_picture_progress(), None);
    let distance = |a: &Picture, b: &Picture| -> f64 {
        let pairs = a.radiance.iter().flatten().zip(b.radiance.iter().flatten());
        pairs.map(|(a, b)| f64::from(a - b).powi(2)).sum()
    };
    session.apply(Command::SetTolerance(Tolerance { share_of_circle: 1.0 })).unwrap();
    wait(&mut session, "a coarser picture", |session| *preview(session).picture.fetch().unwrap() != fine);
    let coarse = wait_for(&mut session, Quality::Viewing);
    session.apply(Command::SetTolerance(Tolerance::NONE)).unwrap();
    let exact = wait_for(&mut session, Quality::Exact);
    let [fine, coarse] = [fine, coarse].map(|picture| distance(&picture, &exact));
    assert!(coarse > fine && fine > 0.0, "coarser is worse: {coarse} and {fine}");
}
