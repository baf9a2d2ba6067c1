//! `focus-brush bake`.

use crate::cli::arguments::BakeArguments;
use crate::cli::commands::render::open_bake_device;
use crate::cli::console::{Console, path_text, print_json};
use crate::cli::failure::Failure;
use crate::cli::input::{camera_and_focus, check_folder, open_input, refuse_additions};
use document::InputKind;
use render::{RenderOptions, write_salf};
use serde_json::json;
use std::sync::Arc;
use std::time::Instant;

/// Bakes a light field into a file.
///
/// # Errors
/// The scene cannot be opened, baking fails or is cancelled, or the output cannot be written.
pub fn run(arguments: &BakeArguments, console: &Console) -> Result<(), Failure> {
    if InputKind::from_path(&arguments.file)? == InputKind::LightField {
        let what = "already baked (give the scene or project)";
        return Err(Failure::bad_input(format!("{}: {what}", arguments.file.display())));
    }
    refuse_additions(&arguments.shot.appearance)?;
    check_folder(&arguments.output)?;
    let start = Instant::now();
    let input = open_input(&arguments.file, &arguments.shot.appearance, None, console.resources(), console)?;
    console.warn(&input.warnings);
    let (camera, focus) = camera_and_focus(&input, &arguments.shot, console)?;
    let open_seconds = start.elapsed().as_secs_f64();
    let bake_start = Instant::now();
    let lit = input.lit_scene()?;
    let bake_on = open_bake_device(arguments.bake_on, None, arguments.adapter.as_deref())?;
    let light = arguments.light.light_quality();
    let options = RenderOptions { light, bake_on, ..RenderOptions::default() };
    let salf = Arc::new(options.bake(&lit, &camera, &focus, console)?);
    let bake_seconds = bake_start.elapsed().as_secs_f64();
    let bytes = write_salf(&arguments.output, &arguments.file, &input.scene, &salf)?;
    let statistics = salf.statistics();
    if arguments.json {
        print_json(&json!({
            "input": path_text(&arguments.file),
            "files": [path_text(&arguments.output)],
            "width": camera.width,
            "height": camera.height,
            "threads": rayon::current_num_threads(),
            "triangles": input.scene.triangles.len(),
            "seconds": { "open": open_seconds, "bake": bake_seconds, "total": start.elapsed().as_secs_f64() },
            "salf": {
                "open_samples": statistics.open,
                "partial_samples": statistics.partial,
                "background_samples": statistics.background,
                "bytes": statistics.bytes,
                "margin_px": salf.margin_px,
                "baked_on": salf.baked_on.name(),
            },
            "file_bytes": bytes,
            "warnings": input.warnings,
        }));
    } else {
        let samples = salf.samples.len();
        console.note(&format!(
            "wrote {}: {samples} samples, {} MiB",
            arguments.output.display(),
            bytes >> 20
        ));
    }
    Ok(())
}
