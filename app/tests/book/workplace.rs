//! A folder with small substitutes for the files that the book's commands name.

use crate::program::done;
use crate::{card_light_field, tiny_glb, wall_capture};
use focus::{Brush, FocusLayer, LayerStack, ViewFrame};
use lens::FocusOffset;
use project::{ProjectFile, RecordedStep, RecordedStroke};
use std::path::Path;
use tempfile::TempDir;

/// Creates the folder. All files are small, so that each of hundreds of commands takes seconds at most.
pub fn workplace() -> TempDir {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    let text = |name: &str, text: &str| std::fs::write(folder.join(name), text).unwrap();
    tiny_glb::write(&folder.join("quads.glb"));
    // Light changes how it looks.
    std::fs::write(folder.join("helmet.glb"), tiny_glb::metal(&tiny_glb::QUADS)).unwrap();
    text(
        "camera.json",
        r#"{"width": 96, "height": 64, "focus_distance": 2.0, "aperture_radius": 0.1, "sensor_height": 0.1}"#,
    );
    text("recipe.json", r#"{"nodes": {"card": {"t": 1.2, "anchor": 1}}}"#);
    text("world.json", r#"{"environment": "studio"}"#);
    sky(&folder.join("sky.hdr"));
    wall_capture::write(&folder.join("photos"));
    card_light_field::write(&folder.join("lightfield"));
    let middle = card_light_field::view([0.0; 2]);
    middle.save(folder.join("cat.png")).unwrap();
    middle.save(folder.join("cat.jpg")).unwrap();
    card_light_field::write_depth(&folder.join("cat_depth.png"));
    // A scene with its own lens, and thereby a small picture.
    done(folder, "new quads.glb --camera camera.json -o small.fbrush");
    done(folder, "export small.fbrush --glb garden.glb");
    done(folder, "new garden.glb --focus recipe.json -o garden.fbrush");
    done(folder, "render garden.glb --aperture-radius 0 -o cycles.exr");
    std::fs::copy(folder.join("garden.fbrush"), folder.join("shot.fbrush")).unwrap();
    let project = ProjectFile::load(&folder.join("garden.fbrush")).unwrap();
    layered(project.clone(), &folder.join("layered.fbrush"));
    strokes(&project, &folder.join("strokes.json"));
    place
}

/// All around, brighter above.
fn sky(file: &Path) {
    let pixels: Vec<_> = (0..32 * 16).map(|k| image::Rgb([0.2 + 0.05 * (15 - k / 32) as f32; 3])).collect();
    let writer = std::fs::File::create(file).unwrap();
    image::codecs::hdr::HdrEncoder::new(writer).encode(&pixels, 32, 16).unwrap();
}

/// The project with a second layer.
fn layered(project: ProjectFile, file: &Path) {
    let map = project.focus_map.clone().unwrap();
    let layers = ["Paint", "far lamp"].map(|name| FocusLayer::from_map(name, map.clone()));
    let layers = LayerStack::new(layers.into(), 1);
    ProjectFile { layers, ..project }.save(file).unwrap();
}

/// One stroke across the picture, as the window records it.
fn strokes(project: &ProjectFile, file: &Path) {
    let view = ViewFrame::from_camera(&project.cameras[0].camera);
    let brush = Brush { radius: 0.3, target: FocusOffset::new(1.4, 0.5), ..Brush::default() };
    let points = (0..20).map(|k| [0.3 + 0.02 * f64::from(k), 0.5, 1.0]).collect();
    let stroke = RecordedStroke { layer: "Paint".into(), brush, view: view.into(), points };
    project::write_strokes(file, &[RecordedStep::Stroke(stroke)]).unwrap();
}
