//! Comparisons of the picture: wipe, ordinary lens, pinhole, ray-traced picture.

use crate::acting::{Person, at, color_at};
use crate::small_scene;
use document::FillRegion;
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use session::{Command, ReferenceKind};

#[test]
fn a_wipe_shows_the_ordinary_lens_on_the_left_of_a_line_that_can_be_dragged() {
    let (mut person, _folder) = small_scene::opened();
    // All painted with strong blur: beside it the ordinary lens, focused on the wall, is sharp.
    let blur = lens::FocusOffset::new(1.2, 1.0);
    person.window.state_mut().apply(Command::Fill(FillRegion::All, blur));
    person.waits();
    let map = person.document().map.clone();
    person.presses(Modifiers::NONE, Key::W);
    person.wait_until("the ordinary lens is drawn", |shell| {
        shell.session().reference(ReferenceKind::Standard).is_some()
    });
    person.waits();
    person.window.remove_cursor();
    person.window.run_steps(2);
    let reference = person.shell().session().reference(ReferenceKind::Standard).unwrap().clone();
    let image = person.picture_rect();
    let inspector = person.window.get_by_label("f-number").rect();
    assert!(image.right() <= inspector.left(), "the header does not push the view under the inspector");
    // Contrast of the chequerboard along a row.
    let contrast = |person: &mut Person, from: f32, to: f32| {
        let screen = person.window.render().unwrap();
        let greys = (0..200).map(|k| {
            let x = from + (to - from) * k as f32 / 199.0;
            color_at(&screen, at(image, x, 0.85))[1]
        });
        let (low, high) = greys.fold((255.0f32, 0.0f32), |(low, high), g| (low.min(g), high.max(g)));
        high - low
    };
    let (left, right) = (contrast(&mut person, 0.05, 0.45), contrast(&mut person, 0.55, 0.95));
    assert!(left > 2.0 * right, "sharp on the left, blurred on the right: {left} {right}");

    let line = person.window.get_by_label("Wipe line").rect().center();
    assert!((line.x - image.center().x).abs() < 1.0);
    let path: Vec<_> = (0..=8).map(|k| line + egui::vec2(image.width() * 0.045 * k as f32, 0.0)).collect();
    person.paints(&path);
    person.window.remove_cursor();
    person.window.run_steps(2);
    assert_eq!(person.document().map, map, "dragging the line paints nothing");
    let right = contrast(&mut person, 0.55, 0.8);
    assert!(right > 0.8 * left, "now the ordinary lens reaches further: {right} {left}");

    // Paint does not affect the reference picture; the lens does.
    person.presses(Modifiers::COMMAND, Key::Z);
    person.waits();
    let same = person.shell().session().reference(ReferenceKind::Standard).unwrap();
    assert!(std::sync::Arc::ptr_eq(&same.picture, &reference.picture));
    person.presses(Modifiers::NONE, Key::Plus);
    person.wait_until("the ordinary lens is drawn anew", |shell| {
        let session = shell.session();
        session.is_reference_current(ReferenceKind::Standard)
            && session.reference(ReferenceKind::Standard).unwrap().camera != reference.camera
    });
    person.waits();
    person.presses(Modifiers::NONE, Key::W);
    assert!(person.window.query_by_label("Wipe line").is_none());
    assert!(person.complaints().is_empty(), "{:?}", person.complaints());
}

#[test]
fn the_ray_traced_picture_is_shown_and_says_when_it_is_old() {
    let (mut person, _folder) = small_scene::opened();
    person.presses(Modifiers::NONE, Key::F12);
    person.wait_until("it is traced", |shell| shell.session().is_reference_current(ReferenceKind::Truth));
    person.waits();
    assert_eq!(person.shell().picture_view().displayed, focus_brush::window::DisplayedPicture::Truth);
    person.window.state_mut().apply(Command::Fill(FillRegion::All, lens::FocusOffset::SHARP));
    person.waits();
    assert!(!person.shell().session().is_reference_current(ReferenceKind::Truth));
    person.window.get_by_label("Shown picture").click();
    person.window.run_steps(3);
    person.window.get_by_label("Pinhole").click();
    person.window.run_steps(2);
    person.wait_until("the pinhole is drawn", |shell| {
        shell.session().is_reference_current(ReferenceKind::Pinhole)
    });
    person.waits();
    let session = person.shell().session();
    let pinhole = &session.reference(ReferenceKind::Pinhole).unwrap().picture;
    assert!(pinhole.coverage.iter().all(|c| *c == 1.0));
    assert!(person.complaints().is_empty(), "{:?}", person.complaints());
}

#[test]
fn a_rectangle_is_checked_by_rays_better_and_better_and_can_be_closed() {
    let (mut person, _folder) = small_scene::opened();
    let map = person.document().map.clone();
    person.presses(Modifiers::NONE, Key::R);
    let image = person.picture_rect();
    let path: Vec<_> = (0..=6).map(|k| at(image, 0.3 + 0.05 * k as f32, 0.4 + 0.05 * k as f32)).collect();
    person.drags(&path);
    person.lets_go(path[6]);
    assert_eq!(person.document().map, map, "drawing the rectangle paints nothing");
    let samples = |shell: &focus_brush::window::Shell| {
        let known = shell.session().verification().and_then(|v| v.estimate.clone());
        known.map_or(0, |estimate| estimate.samples_per_pixel)
    };
    person.wait_until("something is known", |shell| samples(shell) > 0);
    let first = samples(person.shell());
    person.waits();
    assert!(samples(person.shell()) > first, "it got better in passes: {first}");
    let session = person.shell().session();
    let verification = session.verification().unwrap();
    let (width, height) = (verification.camera.width as f32, verification.camera.height as f32);
    assert!((verification.region.width as f32 / width - 0.3).abs() < 0.03, "{:?}", verification.region);
    assert!((verification.region.y as f32 / height - 0.4).abs() < 0.03, "{:?}", verification.region);
    let preview = session.preview().unwrap();
    let error = verification.error_of(preview, lens::Exposure::Normalise).unwrap().unwrap();
    assert!(
        error.psnr > 25.0 && error.signed_mean_error.abs() < 0.02,
        "{} {}",
        error.psnr,
        error.signed_mean_error
    );
    assert!(person.window.query_by_label_contains("PSNR").is_some());
    // Negative control: another picture differs much.
    let mut wrong = preview.clone();
    let mut picture = (*wrong.picture.fetch().unwrap()).clone();
    picture.radiance.iter_mut().for_each(|rgb| *rgb = [0.5; 3]);
    wrong.picture = session::LivePicture::InMemory(std::sync::Arc::new(picture));
    let far = verification.error_of(&wrong, lens::Exposure::Normalise).unwrap().unwrap();
    assert!(far.psnr < error.psnr - 8.0, "{} {}", far.psnr, error.psnr);

    // Outdated after a change, gone when closed.
    person.window.state_mut().apply(Command::Fill(FillRegion::All, lens::FocusOffset::SHARP));
    person.waits();
    assert!(!person.shell().session().is_verification_current());
    person.window.get_by_label("Close verification").click();
    person.window.run_steps(3);
    assert!(person.shell().session().verification().is_none());
    assert!(person.complaints().is_empty(), "{:?}", person.complaints());
}
