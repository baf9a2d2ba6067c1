//! `focus-brush render`.

pub mod sequence;
pub mod tiles;

use crate::cli::arguments::{
    BackendName, BakeDeviceName, EstimatorName, ExposureName, RenderArguments, SamplerName,
};
use crate::cli::console::{Console, path_text, path_texts, print_json};
use crate::cli::failure::Failure;
use crate::cli::input::{camera_and_focus, check_picture_output, open_input};
use ::render::{LayeredOptions, ScatterOptions, ViewsOptions};
use document::Input;
use graphics_card::Gpu;
use lens::Exposure;
use project::{ColorSpace, Compression, PictureOptions, write_picture};
use render::{Aov, RenderOptions, Rendered, Renderer, Stereo, render_input, render_stereo};
use serde_json::json;
use session::SessionError;
use std::time::Instant;
use trace::truth::{Estimator, Sampler, TruthOptions};

/// Renders one picture and writes it.
///
/// # Errors
/// The options contradict each other, the scene cannot be opened, or the picture cannot be rendered or written.
pub fn run(arguments: &RenderArguments, console: &Console) -> Result<(), Failure> {
    let renderer = arguments.renderer;
    let gpu = gpu(arguments)?;
    let card = gpu.as_ref().map(|gpu| gpu.name().to_owned());
    check_options(arguments)?;

    let start = Instant::now();
    let input = open(arguments, console)?;
    let (camera, focus) = camera_and_focus(&input, &arguments.shot, console)?;
    let open_seconds = start.elapsed().as_secs_f64();

    let options = options(arguments, &input, gpu)?;
    let camera = camera.overscanned(arguments.overscan);
    let (cells_a_side, exposure) = (options.cells_a_side, exposure(arguments, &input));
    let Rendered { picture, layers, attributes, cost, warnings } = match arguments.stereo {
        None => render_input(&input, &camera, &focus, &options, console)?,
        Some(form) => {
            let stereo =
                Stereo { form: form.into(), eyes: arguments.eyes, fixate: arguments.fixate, exposure };
            render_stereo(&input, &camera, &focus, &options, &stereo, console)?
        }
    };
    console.warn(&warnings);
    let card = card.filter(|_| cost.is_on_gpu);
    if arguments.backend == BackendName::Gpu && card.is_none() {
        console.note("the picture does not fit the GPU, or the GPU was lost: it was summed on the processor");
    }

    let write_start = Instant::now();
    let file_options = PictureOptions { attributes, ..picture_options(arguments, exposure) };
    let files = write_picture(&arguments.output, &picture, &layers, &file_options)?;
    let write_seconds = write_start.elapsed().as_secs_f64();
    if arguments.json {
        print_json(&json!({
            "input": path_text(&arguments.file),
            "files": path_texts(&files),
            "renderer": renderer.name(),
            "backend": if card.is_some() { "gpu" } else { "cpu" },
            "adapter": card,
            "width": picture.width,
            "height": picture.height,
            "overscan": arguments.overscan,
            "exposure": format!("{exposure:?}").to_lowercase(),
            "threads": rayon::current_num_threads(),
            "triangles": input.scene.triangles.len(),
            "cells_a_side": renderer.draws_light_field().then_some(cells_a_side),
            "samples_per_pixel": (renderer == Renderer::Truth).then_some(arguments.spp),
            "layers": (renderer == Renderer::Layers).then_some(arguments.layers),
            "views_a_side": (renderer == Renderer::Views).then_some(arguments.views),
            "rays_a_sample": (renderer == Renderer::Scatter).then_some(arguments.rays),
            "seconds": {
                "open": open_seconds,
                "prepare": cost.prepare_seconds,
                "bake": cost.bake_seconds,
                "picture": cost.picture_seconds,
                "write": write_seconds,
                "total": start.elapsed().as_secs_f64(),
            },
            "salf": (cost.salf_bytes > 0).then(|| json!({
                "open_samples": cost.open_samples,
                "partial_samples": cost.partial_samples,
                "background_samples": cost.background_samples,
                "bytes": cost.salf_bytes,
                "margin_px": cost.margin_px,
                "baked_on": cost.baked_on.name(),
            })),
            "warnings": input.warnings.iter().chain(&warnings).collect::<Vec<_>>(),
        }));
    } else {
        files.iter().for_each(|file| console.note(&format!("wrote {}", file.display())));
    }
    Ok(())
}

/// Opens the file to render, and prints its warnings.
///
/// # Errors
/// It cannot be opened, or has no layer of that name.
pub fn open(arguments: &RenderArguments, console: &Console) -> Result<Input, Failure> {
    let layer = arguments.layer.as_deref();
    let appearance = &arguments.shot.appearance;
    let input = open_input(&arguments.file, appearance, layer, console.resources(), console)?;
    console.warn(&input.warnings);
    Ok(input)
}

/// The render options that the arguments select.
///
/// # Errors
/// An option does not apply to this input.
pub fn options(
    arguments: &RenderArguments,
    input: &Input,
    gpu: Option<Gpu>,
) -> Result<RenderOptions, Failure> {
    let defaults = arguments.tolerance.map_or_else(RenderOptions::default, RenderOptions::at_tolerance);
    let cells_a_side = match (&input.salf, arguments.cells) {
        (Some(_), Some(cells)) if cells > 1 => {
            let what =
                "already baked, with one cell per pixel (leave out --cells, or give the scene or project)";
            return Err(Failure::bad_input(format!("{}: {what}", arguments.file.display())));
        }
        (Some(_), _) => 1,
        (None, cells) => cells.unwrap_or(defaults.cells_a_side),
    };
    if input.salf.is_some() && arguments.light.light_passes > 0 {
        let what =
            "already baked, including its light (leave out --light-passes, or give the scene or project)";
        return Err(Failure::bad_input(format!("{}: {what}", arguments.file.display())));
    }
    if input.salf.is_some() && arguments.overscan > 0 {
        let what = "baked for the frame only (leave out --overscan, or give the scene or project)";
        return Err(Failure::bad_input(format!("{}: {what}", arguments.file.display())));
    }
    Ok(RenderOptions {
        cells_a_side,
        light: arguments.light.light_quality(),
        bake_on: open_bake_device(arguments.bake_on, gpu.as_ref(), arguments.adapter.as_deref())?,
        gpu,
        renderer: arguments.renderer,
        truth: ground_truth_options(arguments),
        layered: LayeredOptions { layers: arguments.layers },
        views: ViewsOptions { views_a_side: arguments.views, ..ViewsOptions::default() },
        scatter: ScatterOptions { rays_a_sample: arguments.rays, seed: arguments.seed },
        aovs: arguments.aov.clone(),
        coc: arguments.coc_convention,
        overscan: arguments.overscan,
        ..defaults
    })
}

/// How the picture is written; the attributes of its layers are added later.
pub fn picture_options(arguments: &RenderArguments, exposure: Exposure) -> PictureOptions {
    PictureOptions {
        exposure,
        half: arguments.half,
        compression: arguments.compression,
        color_space: arguments.color_space,
        overscan: arguments.overscan,
        ..PictureOptions::default()
    }
}

/// The exposure that the arguments or the project select.
pub fn exposure(arguments: &RenderArguments, input: &Input) -> Exposure {
    match arguments.exposure {
        None => input.exposure(),
        Some(ExposureName::Conserve) => Exposure::Conserve,
        Some(ExposureName::Normalise) => Exposure::Normalise,
    }
}

/// The graphics card to sum on; `None` for the processor.
///
/// # Errors
/// As [`open_gpu`].
pub fn gpu(arguments: &RenderArguments) -> Result<Option<Gpu>, Failure> {
    let requires_gpu = arguments.backend == BackendName::Gpu || arguments.adapter.is_some();
    if arguments.renderer != Renderer::Splat {
        let message = format!(
            "--renderer {} has no GPU backend (use --backend cpu or auto)",
            arguments.renderer.name()
        );
        return if requires_gpu { Err(SessionError::GpuAbsent(message).into()) } else { Ok(None) };
    }
    open_gpu(arguments.backend, arguments.adapter.as_deref())
}

/// Opens the requested graphics card; `None` for the processor.
///
/// # Errors
/// The requested graphics card is not available.
pub fn open_gpu(backend: BackendName, adapter: Option<&str>) -> Result<Option<Gpu>, Failure> {
    let opened = Gpu::open(backend.into(), adapter);
    Ok(opened.map_err(|absent| SessionError::GpuAbsent(absent.to_string()))?)
}

/// The graphics card to bake on, that which is `open` if one is; `None` for the processor.
///
/// # Errors
/// The requested graphics card is not available.
pub fn open_bake_device(
    device: BakeDeviceName,
    open: Option<&Gpu>,
    adapter: Option<&str>,
) -> Result<Option<Gpu>, Failure> {
    match (device, open) {
        (BakeDeviceName::Cpu, _) => Ok(None),
        (BakeDeviceName::Gpu, Some(gpu)) => Ok(Some(gpu.clone())),
        (BakeDeviceName::Gpu, None) => open_gpu(BackendName::Gpu, adapter),
    }
}

fn ground_truth_options(arguments: &RenderArguments) -> TruthOptions {
    TruthOptions {
        samples_per_pixel: arguments.spp,
        seed: arguments.seed,
        estimator: match arguments.estimator {
            EstimatorName::Sensor => Estimator::Sensor,
            EstimatorName::Surface => Estimator::Surface,
        },
        sampler: match arguments.sampler {
            SamplerName::LowDiscrepancy => Sampler::LowDiscrepancy,
            SamplerName::Independent => Sampler::Independent,
        },
        ..TruthOptions::default()
    }
}

/// Checks for combinations of options that would otherwise fail only after the render.
///
/// # Errors
/// Options contradict each other.
pub fn check_options(arguments: &RenderArguments) -> Result<(), Failure> {
    if arguments.aov.contains(&Aov::StandardError) && arguments.renderer != Renderer::Truth {
        let what = "--aov stderr: only the ground truth has a standard error (use --renderer truth)";
        return Err(Failure::wrong_usage(what));
    }
    if arguments.light.light_passes > 0 && arguments.renderer == Renderer::Truth {
        let what =
            "--light-passes: the ground truth has no cached light to refine (leave it out, or use --spp)";
        return Err(Failure::wrong_usage(what));
    }
    let needs_paths = |aov: &&Aov| aov.needs_paths() && !arguments.renderer.resolves_paths();
    if let Some((name, _)) = arguments.aov.iter().find(needs_paths).and_then(Aov::entry) {
        let what = format!(
            "--aov {name}: not supported by --renderer {} (use splat or truth)",
            arguments.renderer.name()
        );
        return Err(Failure::wrong_usage(what));
    }
    if arguments.aov.contains(&Aov::Crypto) && !arguments.compression.is_lossless() {
        let what = "--compression dwaa: Cryptomatte needs lossless compression (use zips, zip or piz, or \
                    write crypto to another file)";
        return Err(Failure::wrong_usage(what));
    }
    check_picture_output(&arguments.output)?;
    let is_exr = arguments.output.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr"));
    let exr_only = [
        ("--half", arguments.half),
        ("--overscan", arguments.overscan > 0),
        ("--compression", arguments.compression != Compression::default()),
        ("--color-space", arguments.color_space != ColorSpace::default()),
    ];
    match exr_only.into_iter().find(|(_, is_set)| *is_set && !is_exr) {
        Some((option, _)) => {
            let what = format!("{}: {option} applies to EXR only (name an .exr)", arguments.output.display());
            Err(Failure::wrong_usage(what))
        }
        None => Ok(()),
    }
}
