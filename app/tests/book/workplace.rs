//! A folder with small stand-ins for the files that the book's commands name.

use crate::program::done;
use crate::{card_light_field, tiny_glb, wall_capture};
use std::path::Path;
use tempfile::TempDir;

/// Makes it. Everything is small, so that hundreds of commands take seconds each at most.
pub fn workplace() -> TempDir {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    let text = |name: &str, text: &str| std::fs::write(folder.join(name), text).unwrap();
    tiny_glb::write(&folder.join("garden.glb"));
    text(
        "camera.json",
        r#"{"width": 96, "height": 64, "focus_distance": 2.0, "aperture_radius": 0.1, "sensor_height": 0.1}"#,
    );
    text("focus.json", r#"{"nodes": {"card": {"t": 1.2, "anchor": 1}}}"#);
    text("world.json", r#"{"environment": "studio"}"#);
    wall_capture::write(&folder.join("photos"));
    card_light_field::write(&folder.join("lightfield"));
    let middle = card_light_field::view([0.0; 2]);
    middle.save(folder.join("cat.png")).unwrap();
    middle.save(folder.join("cat.jpg")).unwrap();
    depth(&folder.join("cat_depth.png"));
    done(folder, "new garden.glb --camera camera.json --focus focus.json -o garden.fbrush");
    place
}

/// White is near.
fn depth(file: &Path) {
    let [width, height] = card_light_field::SIZE;
    let depth = image::GrayImage::from_fn(width, height, |x, y| {
        let (_, disparity) = card_light_field::shown(f64::from(x) + 0.5, f64::from(y) + 0.5, [0.0; 2]);
        image::Luma([if disparity == card_light_field::CARD { 220 } else { 40 }])
    });
    depth.save(file).unwrap();
}
