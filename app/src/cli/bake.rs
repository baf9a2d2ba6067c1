//! `focus-brush bake`.

use super::arguments::BakeArguments;
use super::console::{Console, path_text, say_json};
use super::failure::Failure;
use super::shot::{check_folder, opened, shot};
use serde_json::json;
use session::{InputKind, RenderOptions, write_salf};
use std::sync::Arc;
use std::time::Instant;
use trace::Tracer;

/// Bakes a light field into a file.
pub fn run(arguments: &BakeArguments, console: &Console) -> Result<(), Failure> {
    if InputKind::of(&arguments.file)? == InputKind::LightField {
        let what = "is baked already (give the scene or project)";
        return Err(Failure::bad(format!("{}: {what}", arguments.file.display())));
    }
    check_folder(&arguments.output)?;
    let start = Instant::now();
    let input = opened(&arguments.file, &arguments.shot.scene_look, console)?;
    console.warn(&input.warnings);
    let (camera, focus) = shot(&input, &arguments.shot, console)?;
    let open_seconds = start.elapsed().as_secs_f64();
    let baking = Instant::now();
    let tracer = Arc::new(Tracer::new(input.scene.clone()));
    let options = RenderOptions { light: arguments.light.quality(), ..RenderOptions::default() };
    let salf = Arc::new(options.bake(&tracer, &camera, &focus, console)?);
    let bake_seconds = baking.elapsed().as_secs_f64();
    let bytes = write_salf(&arguments.output, &arguments.file, &input.scene, &salf)?;
    let statistics = salf.statistics();
    if arguments.json {
        say_json(&json!({
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
