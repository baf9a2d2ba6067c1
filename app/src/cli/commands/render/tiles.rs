//! `focus-brush render --tiles`.

use super::{check_options, exposure, open, options, picture_options};
use crate::cli::arguments::{BackendName, BakeDeviceName, RenderArguments};
use crate::cli::console::{Console, path_text, print_json};
use crate::cli::failure::Failure;
use crate::cli::input::camera_and_focus;
use crate::cli::termination;
use render::{Outcome, Renderer, TileGrid, TileOptions, TileReport, TilesReport, render_tiles};
use serde_json::json;
use std::path::Path;
use std::time::Instant;

/// Renders a picture in tiles, or a share of its tiles.
///
/// # Errors
/// The options contradict each other, the scene cannot be opened, or tiles cannot be rendered or written.
pub fn run(arguments: &RenderArguments, grid: TileGrid, console: &Console) -> Result<(), Failure> {
    termination::install_handler()?;
    check_supported(arguments)?;
    check_options(arguments)?;
    let start = Instant::now();
    let input = open(arguments, console)?;
    if input.salf.is_some() {
        let what = "already baked, for the whole picture (leave out --tiles, or give the scene or project)";
        return Err(Failure::wrong_usage(format!("{}: {what}", arguments.file.display())));
    }
    let (camera, focus) = camera_and_focus(&input, &arguments.shot, console)?;
    let camera = camera.overscanned(arguments.overscan);
    if let Err(what) = grid.tiles([camera.width, camera.height]) {
        return Err(Failure::wrong_usage(format!("--tiles: {what}")));
    }
    let tiles = TileOptions {
        render: options(arguments, &input, None)?,
        grid,
        shard: arguments.sequence.shard,
        output: arguments.output.clone(),
        written: picture_options(arguments, exposure(arguments, &input)),
        integers: arguments.integers.unwrap_or_default(),
        on_tile: &|tile| report_tile(console, tile),
        progress: console,
    };
    let report = render_tiles(&input, &camera, &focus, &tiles, console)?;
    summarize(arguments, console, &report, start)
}

/// Checks for options that cannot be combined with tiles.
fn check_supported(arguments: &RenderArguments) -> Result<(), Failure> {
    if arguments.renderer != Renderer::Splat {
        let name = arguments.renderer.name();
        return Err(Failure::wrong_usage(format!(
            "--tiles: --renderer {name} does not support tiles (use splat)"
        )));
    }
    if arguments.backend == BackendName::Gpu || arguments.adapter.is_some() {
        let what = "--tiles: tiles are summed on the processor (leave out --backend gpu and --adapter; the \
                    picture is the same)";
        return Err(Failure::wrong_usage(what));
    }
    if arguments.bake_on == BakeDeviceName::Gpu {
        return Err(Failure::wrong_usage(
            "--tiles: tiles are baked on the processor (leave out --bake-on gpu)",
        ));
    }
    check_exr_output(&arguments.output)
}

/// Checks that the output is an EXR: tiles are merged to nothing else.
///
/// # Errors
/// The extension is another one.
pub fn check_exr_output(output: &Path) -> Result<(), Failure> {
    if output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr")) {
        return Ok(());
    }
    Err(Failure::wrong_usage(format!("{}: tiles are merged to an EXR (name an .exr)", output.display())))
}

/// Reports a finished tile.
fn report_tile(console: &Console, report: &TileReport) {
    let TileReport { tile, tile_count: of, file, outcome, took_seconds } = report;
    let what = match outcome {
        Outcome::Written => format!("wrote {} ({took_seconds:.1} s)", file.display()),
        Outcome::Skipped => format!("{} is finished", file.display()),
        Outcome::Failed(error) => format!("tile {tile} of {of} failed: {error}"),
    };
    console.event(
        &what,
        &json!({
            "tile": tile,
            "of": of,
            "file": path_text(file),
            "state": outcome.name(),
            "seconds": took_seconds,
            "error": outcome.error().map(ToString::to_string),
        }),
    );
}

/// Prints the summary; an error if tiles failed.
fn summarize(
    arguments: &RenderArguments,
    console: &Console,
    report: &TilesReport,
    start: Instant,
) -> Result<(), Failure> {
    let TilesReport { tiles, merged, warnings } = report;
    let count = |state_of: &str| tiles.iter().filter(|tile| tile.outcome.name() == state_of).count();
    let [written, skipped, failed] = ["written", "skipped", "failed"].map(count);
    let of_merging = merged.iter().flat_map(|merged| &merged.warnings);
    let warnings: Vec<String> = warnings.iter().chain(of_merging).cloned().collect();
    console.warn(&warnings);
    if arguments.json {
        let tile = |tile: &TileReport| json!({ "tile": tile.tile, "file": path_text(&tile.file), "state": tile.outcome.name() });
        print_json(&json!({
            "input": path_text(&arguments.file),
            "file": merged.as_ref().map(|_| path_text(&arguments.output)),
            "width": merged.as_ref().map(|merged| merged.size[0]),
            "height": merged.as_ref().map(|merged| merged.size[1]),
            "tiles": tiles.iter().map(tile).collect::<Vec<_>>(),
            "written": written,
            "skipped": skipped,
            "failed": failed,
            "seconds": start.elapsed().as_secs_f64(),
            "warnings": warnings,
        }));
    }
    let mut line = format!("{written} tiles written, {skipped} were finished");
    if failed > 0 {
        line += &format!(", {failed} failed");
    }
    if merged.is_some() {
        line += &format!("; merged to {}", arguments.output.display());
    }
    console.note(&line);
    let first = tiles.iter().find_map(|tile| tile.outcome.error());
    match first {
        None => Ok(()),
        Some(error) if written + skipped > 0 => {
            Err(Failure::partly_done(format!("{failed} of {} tiles failed: {error}", tiles.len())))
        }
        Some(error) => Err(error.clone().into()),
    }
}
