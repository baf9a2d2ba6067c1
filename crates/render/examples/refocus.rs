//! Bakes the light field of a scene once, and writes two pictures of it that are focused at different distances.
//!
//! `cargo run -p render --example refocus -- assets/demo/demo.glb out` writes `out/near.exr` and `out/far.exr`.

use document::Input;
use focus::Focus;
use lens::{Camera, FocusOffset};
use light::Resources;
use progress::Unwatched;
use project::{PictureOptions, write_picture};
use render::RenderOptions;
use std::path::Path;
use std::sync::Arc;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, scene, folder] = &arguments[..] else { return Err("usage: refocus SCENE FOLDER".into()) };
    std::fs::create_dir_all(folder)?;
    let input = Input::open(Path::new(scene), &Resources::default(), &Unwatched)?;
    let lit = input.lit_scene()?;
    let camera = Camera { width: 480, height: 270, ..input.camera.clone() };
    // Nothing is painted: every surface has the focus of the lens.
    let focus = Focus::constant(input.scene.clone(), FocusOffset::STANDARD);
    let options = RenderOptions::default();
    let salf = Arc::new(options.bake(&lit, &camera, &focus, &Unwatched)?);
    for (name, factor) in [("near.exr", 0.7), ("far.exr", 1.5)] {
        let refocused = Camera { focus_distance: camera.focus_distance * factor, ..camera.clone() };
        let rendered = options.sum_light_field(salf.clone(), &lit, &refocused, &focus, &Unwatched)?;
        let file = Path::new(folder).join(name);
        write_picture(&file, &rendered.picture, &rendered.layers, &PictureOptions::default())?;
    }
    Ok(())
}
