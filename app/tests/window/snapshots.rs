//! How the window, its panels and its dialogs look, at 100 % and at 200 %.
//!
//! `UPDATE_SNAPSHOTS=1 cargo test -p focus-brush --test window snapshots` draws the pictures of `tests/snapshots` anew: look at them
//! before they are kept.

use crate::fitting::OPENERS;
use crate::small_scene::opened;
use egui_kittest::{SnapshotOptions, try_image_snapshot_options};
use image::{Rgba, RgbaImage};
use session::CommandId;

/// Pixels that may differ: names of temporary folders, and the edges of what another driver rasterises.
const DIFFERENT_PIXELS: usize = 600;

/// Grey below what the window leaves open: it is cleared with the panel's colour.
const PANEL: f32 = 38.0;

#[test]
fn panels_and_dialogs_look_as_before() {
    let options = SnapshotOptions::new().threshold(1.5).max_failed_pixels(DIFFERENT_PIXELS);
    let mut problems = Vec::new();
    for (steps, scale) in [(0, "100"), (8, "200")] {
        let (mut person, _folder) = opened();
        person.does(CommandId::PaintAsNavigator);
        for _ in 0..steps {
            person.does(CommandId::ScaleUp);
        }
        person.window.run_steps(8);
        let mut compare = |window: &mut egui_kittest::Harness<'static, _>, what: &str| {
            let drawn = halved(&window.render().expect("the window is drawn"));
            let compared = try_image_snapshot_options(&drawn, format!("{what}-{scale}"), &options);
            problems.extend(compared.err().map(|error| error.to_string()));
        };
        compare(&mut person.window, "window");
        for opener in OPENERS {
            person.does(opener);
            person.window.run_steps(6);
            let name = opener.info().name.to_lowercase().replace([' ', '…'], "-");
            compare(&mut person.window, name.trim_end_matches('-'));
            person.presses(egui::Modifiers::NONE, egui::Key::Escape);
            person.window.run_steps(3);
        }
    }
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

/// A picture of half the size, over the panel's colour.
fn halved(picture: &RgbaImage) -> RgbaImage {
    RgbaImage::from_fn(picture.width() / 2, picture.height() / 2, |x, y| {
        let corners =
            [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[dx, dy]| picture.get_pixel(2 * x + dx, 2 * y + dy).0);
        let channel = |k: usize| {
            let over = |pixel: &[u8; 4]| f32::from(pixel[k]) + PANEL * (1.0 - f32::from(pixel[3]) / 255.0);
            (corners.iter().map(over).sum::<f32>() / 4.0).round() as u8
        };
        Rgba([channel(0), channel(1), channel(2), u8::MAX])
    })
}
