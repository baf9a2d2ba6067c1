//! Opening the aperture and racking the focus: what shows that was baked before, and nobody waits for a bake.

#[allow(dead_code, reason = "shared by several tests")]
mod at_work;

use document::CameraEdit;
use lens::{Camera, Picture};
use session::{Command, Quality, Session, SessionOptions};
use std::path::Path;
use std::time::{Duration, Instant};

const PATIENCE: Duration = Duration::from_secs(300);

/// Polls until `done`.
fn wait(session: &mut Session, what: &str, done: impl Fn(&Session) -> bool) {
    let start = Instant::now();
    while !done(session) {
        assert!(start.elapsed() < PATIENCE, "{what} never comes");
        std::thread::sleep(Duration::from_millis(1));
        session.poll();
    }
}

fn camera(session: &Session) -> Camera {
    session.document().unwrap().camera.clone()
}

/// PSNR of two pictures, of linear values clipped to [0, 1], dB.
fn psnr(a: &Picture, b: &Picture) -> f64 {
    let square = |(a, b): (&f32, &f32)| f64::from(a.clamp(0.0, 1.0) - b.clamp(0.0, 1.0)).powi(2);
    let sum: f64 = a.radiance.as_flattened().iter().zip(b.radiance.as_flattened()).map(square).sum();
    -10.0 * (sum / a.radiance.as_flattened().len() as f64).log10()
}

/// Edits the camera; the fine picture that shows the edit.
fn edited(session: &mut Session, edit: CameraEdit) -> (Camera, Picture) {
    let (begun, last) = (Instant::now(), session.preview().unwrap().id);
    session.apply(Command::EditCamera(edit)).unwrap();
    session.apply(Command::FinishEdit).unwrap();
    let is_new = |session: &Session| session.preview().is_some_and(|preview| preview.id > last);
    wait(session, "a picture", is_new);
    let first = begun.elapsed();
    wait(session, "a fine picture", |session| {
        is_new(session) && session.preview().is_some_and(|preview| preview.quality > Quality::Coarse)
    });
    println!("a picture after {first:.0?}, a fine one after {:.0?}", begun.elapsed());
    (camera(session), (*session.preview().unwrap().picture.fetch().unwrap()).clone())
}

fn opened(project: &Path, exact_delay: Option<Duration>) -> Session {
    let options = SessionOptions { preview_size: 160, exact_delay, ..SessionOptions::default() };
    let mut session = Session::new(options).unwrap();
    session.apply(Command::Open(project.into())).unwrap();
    at_work::settle(&mut session);
    session
}

#[test]
fn a_stop_up_and_a_rack_need_no_bake() {
    let folder = tempfile::tempdir().unwrap();
    let demo = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/demo");
    for name in ["demo.fbrush", "demo.glb"] {
        std::fs::copy(demo.join(name), folder.path().join(name)).unwrap();
    }
    let project = folder.path().join("demo.fbrush");
    // Long enough for all of the following to happen before what is done at rest begins again.
    let mut session = opened(&project, Some(Duration::from_secs(5)));
    wait(&mut session, "a spare", |session| session.baked_light_fields() == 2 && session.jobs().is_empty());
    at_work::settle(&mut session);

    let start = camera(&session);
    // The f-number is held: the aperture grows with the image distance.
    let rack = |camera: &Camera, nearer: f64| Camera {
        focus_distance: camera.focus_distance * nearer,
        aperture_radius: camera.aperture_radius * 1.03,
        ..camera.clone()
    };
    let wide = Camera { aperture_radius: start.aperture_radius * 1.41, ..start.clone() };
    let edits = [
        ("a rack", CameraEdit::Whole(Box::new(rack(&start, 0.8)))),
        ("back", CameraEdit::Whole(Box::new(start.clone()))),
        ("a stop up", CameraEdit::Whole(Box::new(wide.clone()))),
        ("that one racked", CameraEdit::Whole(Box::new(rack(&wide, 1.2)))),
    ];
    let shown: Vec<_> = edits
        .into_iter()
        .map(|(what, edit)| {
            let (camera, picture) = edited(&mut session, edit);
            assert_eq!(session.baked_light_fields(), 2, "{what} baked something");
            (what, camera, picture, 2.0)
        })
        .collect();
    // Beyond the spare, too, something is there at once; what it lacks is baked.
    let (twice, picture) = edited(&mut session, CameraEdit::ApertureRadius(start.aperture_radius * 2.0));
    assert_eq!(session.baked_light_fields(), 2);
    wait(&mut session, "its own light field", |session| session.baked_light_fields() > 2);
    at_work::settle(&mut session);
    let (_, own) = (camera(&session), session.preview().unwrap().picture.fetch().unwrap());

    let mut reference = opened(&project, None);
    let beyond =
        [("two stops up", twice.clone(), picture, 12.0), ("two stops up, baked", twice, (*own).clone(), 0.1)];
    for (what, camera, picture, loss_db) in shown.into_iter().chain(beyond) {
        reference.apply(Command::EditCamera(CameraEdit::Whole(Box::new(camera)))).unwrap();
        at_work::settle(&mut reference);
        let exact = reference.exact_picture().unwrap();
        let own = psnr(&reference.preview().unwrap().picture.fetch().unwrap(), &exact);
        let db = psnr(&picture, &exact);
        println!("{what}: {db:.1} dB, {own:.1} with a light field of its own");
        assert!(db >= own - loss_db, "{what}: {db:.1} dB, {own:.1} with a light field of its own");
    }
}
