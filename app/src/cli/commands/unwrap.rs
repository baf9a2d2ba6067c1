//! `focus-brush unwrap`.

use crate::cli::arguments::UnwrapArguments;
use crate::cli::console::{Console, path_text, print_json};
use crate::cli::failure::Failure;
use crate::cli::input::{check_folder, unwrap_options};
use document::{Input, InputKind};
use render::write_unwrapped;
use serde_json::json;
use std::time::Instant;

/// Unwraps a scene and writes it with the atlas.
///
/// # Errors
/// The scene cannot be opened or unwrapped, or the output cannot be written.
pub fn run(arguments: &UnwrapArguments, console: &Console) -> Result<(), Failure> {
    if InputKind::from_path(&arguments.scene)? != InputKind::Scene {
        let what = "not a scene (give a .glb or .gltf; `export --glb` writes the scene of a project)";
        return Err(Failure::bad_input(format!("{}: {what}", arguments.scene.display())));
    }
    check_folder(&arguments.output)?;
    let start = Instant::now();
    let input = Input::open(&arguments.scene, console.resources(), console)?;
    console.warn(&input.warnings);
    let open_seconds = start.elapsed().as_secs_f64();
    let unwrapping = Instant::now();
    let atlas = input.atlas(&unwrap_options(Some(&arguments.atlas)), console)?;
    let unwrap_seconds = unwrapping.elapsed().as_secs_f64();
    write_unwrapped(&arguments.output, &input.scene, &atlas, None, console)?;
    if arguments.json {
        print_json(&json!({
            "input": path_text(&arguments.scene),
            "files": [path_text(&arguments.output)],
            "triangles": input.scene.triangles.len(),
            "width": atlas.width,
            "height": atlas.height,
            "charts": atlas.charts.len(),
            "texels_per_unit": atlas.density,
            "hash": atlas.hash,
            "notes": atlas.notes,
            "seconds": { "open": open_seconds, "unwrap": unwrap_seconds, "total": start.elapsed().as_secs_f64() },
            "warnings": input.warnings,
        }));
    } else {
        atlas.notes.iter().for_each(|note| console.note(note));
        let (width, height, charts) = (atlas.width, atlas.height, atlas.charts.len());
        let file = arguments.output.display();
        console.note(&format!("wrote {file}: {charts} charts in {width} × {height} texels"));
    }
    Ok(())
}
