//! Drawing tiles one after another.

use crate::error::RenderError;
use crate::picture::{RenderOptions, cut_off_warning, lit_scene_of};
use crate::sequence::{Outcome, Shard, still_frame_plan};
use crate::tiles::crop::CropFailure;
use crate::tiles::draw::Shot;
use crate::tiles::grid::TileGrid;
use crate::tiles::merge::{MergeFailure, Merged, merge};
use crate::tiles::part::{Output, Part, part_path};
use document::Input;
use focus::Focus;
use lens::Camera;
use light::Steps;
use progress::Progress;
use project::{PartWriter, PictureOptions};
use splat::{Crop, Integers};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// How a picture is drawn in tiles, and where it is written.
pub struct TileOptions<'a> {
    /// How it is rendered. The renderer must be the splat, on the processor.
    pub render: RenderOptions,
    /// The tile grid.
    pub grid: TileGrid,
    /// The shard of tiles to draw as parts that are merged later. `None` draws all tiles and merges them.
    pub shard: Option<Shard>,
    /// The picture, an EXR file.
    pub output: PathBuf,
    /// How it is written.
    pub written: PictureOptions,
    /// The finest integers of its sums.
    pub integers: Integers,
    /// Called after each tile.
    pub on_tile: &'a dyn Fn(&TileReport),
    /// Checked for cancellation before each tile.
    pub progress: &'a dyn Progress,
}

/// The report on one tile.
#[derive(Clone, Debug, PartialEq)]
pub struct TileReport {
    /// Number of the tile, from 1, row by row.
    pub tile: u32,
    /// Number of tiles.
    pub tile_count: u32,
    /// Its part file.
    pub file: PathBuf,
    /// Whether it was written.
    pub outcome: Outcome,
    /// Processing time, s.
    pub took_seconds: f64,
}

/// The report on a tiled picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TilesReport {
    /// The tiles, in order.
    pub tiles: Vec<TileReport>,
    /// The picture, if all tiles were merged.
    pub merged: Option<Merged>,
    /// What the tiles that were drawn lack, one sentence each.
    pub warnings: Vec<String>,
}

/// Draws the tiles of a picture that are not yet finished as parts. If all tiles are requested, merges them and removes the parts. If a
/// tile fails, the others are still drawn.
///
/// # Errors
/// The picture cannot be divided into this grid, the work was cancelled, or there is a temporary problem of the machine. Finished parts
/// stay.
pub fn render_tiles(
    input: &Input,
    camera: &Camera,
    focus: &Focus,
    options: &TileOptions<'_>,
    steps: &dyn Steps,
) -> Result<TilesReport, RenderError> {
    if !camera.character.is_neutral() {
        let what = "a picture of a lens with a character cannot be drawn in tiles (render it whole, or take the character out of the camera)";
        return Err(RenderError::bad_file(&options.output, what));
    }
    let lit = lit_scene_of(input, camera)?;
    if lit.tracer().has_splats() {
        let what = "pictures of Gaussian splats are rendered whole (leave out --tiles)";
        return Err(RenderError::bad_file(&input.path, what));
    }
    let shot = Shot { lit: &lit, camera, focus, options: &options.render };
    let size = [camera.width, camera.height];
    let tiles = options.grid.tiles(size).map_err(|what| RenderError::bad_file(&options.output, what))?;
    let written = PictureOptions { attributes: shot.attributes(), ..options.written.clone() };
    let TileGrid { columns, rows } = options.grid;
    let plan = still_frame_plan(
        &lit,
        camera,
        focus,
        &options.render,
        &format!("{written:?} tiles {columns}x{rows}"),
    );
    let aov_name = |aov: &crate::picture::Aov| aov.entry().map(|(name, _)| name.to_string());
    let blank = Part {
        plan: hex::encode(plan),
        tile: 0,
        tiles: [columns, rows],
        size,
        cells: options.render.cells_a_side,
        aovs: options.render.aovs.iter().filter_map(aov_name).collect(),
        output: Output::new(&written),
        things: shot.things(),
        pieces: Vec::new(),
    };
    let mut integers = options.integers;
    loop {
        let mut report = TilesReport::default();
        for (number, tile) in (0..).zip(&tiles) {
            if !options.shard.is_none_or(|shard| shard.contains(number as usize)) {
                continue;
            }
            options.progress.check()?;
            let start = Instant::now();
            let file = part_path(&options.output, options.grid, number);
            let part = Part { tile: number, ..blank.clone() };
            let outcome = match draw_tile(shot, *tile, part, integers, &file, steps) {
                Ok(outcome) => outcome,
                Err(error @ (RenderError::Cancelled | RenderError::TryAgain(_))) => return Err(error),
                Err(error) => Outcome::Failed(error),
            };
            let took_seconds = start.elapsed().as_secs_f64();
            let (tile, tile_count) = (number + 1, options.grid.count());
            let tile_report = TileReport { tile, tile_count, file, outcome, took_seconds };
            (options.on_tile)(&tile_report);
            report.tiles.push(tile_report);
        }
        report.warnings.extend(cut_off_warning(&lit));
        let is_whole = report.tiles.iter().all(|tile| tile.outcome.error().is_none());
        if options.shard.is_some() || !is_whole {
            return Ok(report);
        }
        let files: Vec<_> = report.tiles.iter().map(|tile| tile.file.clone()).collect();
        match merge(&files, &options.output, steps) {
            Ok(merged) => {
                report.merged = Some(merged);
                // A part that cannot be removed does no harm.
                files.iter().for_each(|file| drop(std::fs::remove_file(file)));
                return Ok(report);
            }
            Err(MergeFailure::Other(error)) => return Err(error),
            Err(MergeFailure::TooFine { integers: needed, .. }) => {
                steps.notice("the picture needs coarser integers: its tiles are drawn again");
                integers = integers.coarsest(needed);
            }
        }
    }
}

/// Draws a tile unless it is finished.
fn draw_tile(
    shot: Shot,
    tile: Crop,
    part: Part,
    mut integers: Integers,
    file: &Path,
    steps: &dyn Steps,
) -> Result<Outcome, RenderError> {
    if is_finished(file, &part, integers) {
        return Ok(Outcome::Skipped);
    }
    loop {
        let mut writer = PartWriter::create(file)?;
        match shot.draw(tile, integers, &mut writer, steps) {
            Ok(pieces) => {
                let part = Part { pieces, ..part };
                let what = serde_json::to_value(&part);
                writer.finish(&what.map_err(|error| RenderError::Internal(error.to_string()))?)?;
                return Ok(Outcome::Written);
            }
            Err(CropFailure::Other(error)) => return Err(error),
            Err(CropFailure::TooFine(kind)) => {
                integers = integers.coarser(kind).ok_or(splat::SplatError::Overflow)?;
            }
        }
    }
}

/// Whether the part of a tile exists, complete and made by the same plan.
fn is_finished(file: &Path, expected: &Part, integers: Integers) -> bool {
    let Ok((_, part)) = Part::open(file) else { return false };
    let is_coarse = part.facts().all(|facts| facts.integers == facts.integers.coarsest(integers));
    part.plan == expected.plan && part.tile == expected.tile && is_coarse
}
