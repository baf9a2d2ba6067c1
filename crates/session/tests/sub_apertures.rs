//! The scene through one point of the aperture: what is out of focus moves by κ·U, what is in focus stays, paint as well.

#[allow(dead_code, reason = "only its quads are needed")]
mod tiny_glb;

use document::{CameraEdit, FillRegion};
use glam::DVec2;
use lens::{FocusOffset, Picture};
use session::{Command, Quality, Session, SessionOptions};
use std::sync::Arc;
use std::time::{Duration, Instant};

const PATIENCE: Duration = Duration::from_secs(120);

/// The picture once it is fine.
fn picture(session: &mut Session) -> Arc<Picture> {
    let start = Instant::now();
    let is_fine = |session: &Session| {
        let shown = session.preview().is_some_and(|preview| preview.quality == Quality::Viewing);
        shown && session.is_settled()
    };
    while !is_fine(session) {
        assert!(start.elapsed() < PATIENCE, "no picture comes");
        std::thread::sleep(Duration::from_millis(2));
        session.poll();
    }
    session.preview().unwrap().picture.fetch().unwrap()
}

/// Where the light of a picture has its middle, px from the upper left corner, and how far it is spread.
fn middle(picture: &Picture) -> (DVec2, f64) {
    let (mut light, mut moment, mut square) = (0.0, DVec2::ZERO, 0.0);
    for (index, radiance) in picture.radiance.iter().enumerate() {
        let at = DVec2::new((index % picture.width as usize) as f64, (index / picture.width as usize) as f64)
            + 0.5;
        let here = f64::from(radiance.iter().sum::<f32>());
        light += here;
        moment += here * at;
        square += here * at.length_squared();
    }
    let mean = moment / light;
    (mean, (square / light - mean.length_squared()).sqrt())
}

#[test]
fn what_is_out_of_focus_moves_as_its_defocus_says() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("card.glb");
    let card =
        tiny_glb::Quad { name: "card", center: [0.1, 0.0], half: [0.1; 2], depth: 2.0, color: [1.0; 3] };
    std::fs::write(&scene, tiny_glb::glb(&[card])).unwrap();
    let mut session =
        Session::new(SessionOptions { preview_size: 240, ..SessionOptions::default() }).unwrap();
    session.apply(Command::Open(scene)).unwrap();
    let start = Instant::now();
    while session.document().is_none() {
        assert!(start.elapsed() < PATIENCE, "no document comes");
        session.poll();
    }
    for edit in [CameraEdit::ApertureRadius(0.1), CameraEdit::FocusDistance(4.0)] {
        session.apply(Command::EditCamera(edit)).unwrap();
    }
    let whole = picture(&mut session);
    let shown = session.preview().unwrap().camera.clone();
    let optics = shown.optics();
    let radius = optics.splat_radius_px(optics.standard_kappa(1.0 / 2.0));
    assert!(radius < -5.0, "near defocus of some pixels: {radius}");
    let (rest, spread) = middle(&whole);
    for point in [DVec2::new(0.5, 0.25), DVec2::new(-0.7, 0.0), DVec2::new(0.0, -0.9)] {
        session.apply(Command::SetSubAperture(Some(point))).unwrap();
        let (seen, sharper) = middle(&picture(&mut session));
        let wanted = rest + radius * DVec2::new(point.x, -point.y);
        assert!(seen.distance(wanted) < 0.1, "{point}: {seen}, not {wanted}");
        assert!(sharper < spread, "it is hardly blurred");
    }
    // What is painted sharp stays where it is.
    session.apply(Command::Fill(FillRegion::All, FocusOffset::SHARP)).unwrap();
    let (seen, _) = middle(&picture(&mut session));
    assert!(seen.distance(rest) < 0.1, "{seen}, not {rest}");
    session.apply(Command::Undo).unwrap();
    session.apply(Command::SetSubAperture(None)).unwrap();
    let again = picture(&mut session);
    assert_eq!(again.radiance, whole.radiance, "the whole lens's picture is what it was");
    assert_eq!(
        session.document().unwrap().camera.aperture,
        lens::Aperture::default(),
        "no part of the document"
    );
}
