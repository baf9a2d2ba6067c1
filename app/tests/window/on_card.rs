//! The picture summed and displayed on the window's own device: it equals the processor's, and is not read back
//! for display.
//!
//! Skipped with a message if the window's device cannot sum.

use crate::acting::{Person, at, difference};
use crate::small_scene;
use egui::{Key, Modifiers, Pos2, Rect};
use focus_brush::window::WindowOptions;
use graphics_card::BackendChoice;
use image::RgbaImage;
use session::{LivePicture, Quality};
use std::path::Path;
use std::time::Duration;

impl Person {
    fn watches(file: &Path, backend: BackendChoice) -> Self {
        let options = WindowOptions { backend, ..Self::usual(Some(file)) };
        let mut person = Self::starts_with(options);
        person.waits();
        person.wait_until("a picture within the tolerance", |shell| {
            shell.session().preview().is_some_and(|preview| preview.quality > Quality::Coarse)
        });
        person.waits();
        person
    }

    fn live(&self) -> &LivePicture {
        &self.shell().session().preview().expect("a picture").picture
    }

    /// The picture's pixels on screen.
    fn sees(&mut self) -> (RgbaImage, Rect) {
        self.window.remove_cursor();
        self.window.run_steps(2);
        (self.window.render().unwrap(), self.picture_rect())
    }
}

/// The largest and mean difference of two screenshots within a rectangle, of 255.
fn apart((a, rect): &(RgbaImage, Rect), (b, _): &(RgbaImage, Rect)) -> (u8, f64) {
    let inner = rect.shrink(2.0);
    let columns = inner.left() as u32..inner.right() as u32;
    let rows = inner.top() as u32..inner.bottom() as u32;
    let pixels = rows.flat_map(|y| columns.clone().map(move |x| (x, y)));
    let differences: Vec<u8> = pixels
        .flat_map(|(x, y)| {
            let (a, b) = (a.get_pixel(x, y).0, b.get_pixel(x, y).0);
            [0, 1, 2].map(|c| a[c].abs_diff(b[c]))
        })
        .collect();
    let mean = differences.iter().map(|&x| f64::from(x)).sum::<f64>() / differences.len() as f64;
    (differences.into_iter().max().unwrap_or(0), mean)
}

fn stroke(person: &mut Person) {
    for _ in 0..12 {
        person.presses(Modifiers::NONE, Key::Period);
    }
    let rect = person.picture_rect();
    let path: Vec<Pos2> = (0..6).map(|k| at(rect, 0.65, 0.25 + 0.08 * k as f32)).collect();
    person.paints(&path);
}

#[test]
fn a_picture_on_the_card_is_shown_as_the_processors_is() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("wall.glb");
    small_scene::write(&file);
    let mut here = Person::watches(&file, BackendChoice::Cpu);
    let mut there = Person::watches(&file, BackendChoice::Gpu);
    if matches!(there.live(), LivePicture::InMemory(_)) {
        eprintln!("SKIPPED: the window's device does not sum");
        return;
    }
    let screen = |person: &Person| person.shell().session().screen().pixels().len();
    assert_eq!((screen(&there), screen(&here) > 0), (0, true), "what is shown there never was here");
    assert_eq!(difference(&there.picture(), &here.picture()), 0.0);
    let (before, there_before) = (here.sees(), there.sees());
    assert!(apart(&before, &there_before).0 <= 2, "{:?}", apart(&before, &there_before));

    // A stroke, in one rectangle of it.
    stroke(&mut here);
    stroke(&mut there);
    assert!(matches!(there.live(), LivePicture::OnCard(_)));
    assert_eq!(difference(&there.picture(), &here.picture()), 0.0);
    let (painted, there_painted) = (here.sees(), there.sees());
    assert!(apart(&before, &painted).0 > 20, "the stroke shows");
    assert!(apart(&painted, &there_painted).0 <= 2, "{:?}", apart(&painted, &there_painted));

    // Every tone curve.
    for _ in 0..2 {
        for person in [&mut here, &mut there] {
            person.presses(Modifiers::NONE, Key::T);
            person.waits();
        }
        let (toned, there_toned) = (here.sees(), there.sees());
        assert!(apart(&toned, &painted).1 > 1.0, "another curve: {:?}", apart(&toned, &painted));
        assert!(apart(&toned, &there_toned).0 <= 2, "{:?}", apart(&toned, &there_toned));
    }
    for person in [&mut here, &mut there] {
        person.presses(Modifiers::COMMAND, Key::Z);
        person.presses(Modifiers::NONE, Key::T);
        person.waits();
    }
    assert_eq!(difference(&there.picture(), &here.picture()), 0.0);
    assert!(apart(&before, &there.sees()).0 <= 2, "undone");
    assert!(there.complaints().is_empty(), "{:?}", there.complaints());
}

#[test]
fn the_exact_picture_comes_from_the_card_and_a_stroke_goes_over_it() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("wall.glb");
    small_scene::write(&file);
    let exact_after = Some(Duration::from_millis(300));
    let options = WindowOptions { exact_after, backend: BackendChoice::Gpu, ..Person::usual(Some(&file)) };
    let mut person = Person::starts_with(options);
    let exact = |shell: &focus_brush::window::Shell| {
        shell.session().preview().is_some_and(|preview| preview.quality == Quality::Exact)
    };
    person.wait_until("the exact picture", exact);
    if matches!(person.live(), LivePicture::InMemory(_)) {
        eprintln!("SKIPPED: the window's device does not sum");
        return;
    }
    let session = person.shell().session();
    assert!(session.preview().unwrap().costs.viewing_psnr > Some(20.0));
    let converged = session.exact_picture().unwrap();
    assert!(difference(&person.picture(), &converged) < 0.05);
    stroke(&mut person);
    person.wait_until("the exact picture again", exact);
    let converged = person.shell().session().exact_picture().unwrap();
    assert!(difference(&person.picture(), &converged) < 0.05);
}
