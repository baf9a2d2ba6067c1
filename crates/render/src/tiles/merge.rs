//! Merging part files into the picture.

use crate::error::RenderError;
use crate::mattes::{Entry, left_out_warning, ranks_of};
use crate::picture::Aov;
use crate::tiles::grid::TileGrid;
use crate::tiles::joined_picture::{JoinedPicture, PieceRows};
use crate::tiles::part::{Matte, NamedThings, NumbersAt, Part, part_path};
use lens::{Exposure, Picture};
use light::Steps;
use project::{Cryptomatte, Layer, NumberReader, PartFile, write_picture_in_bands};
use splat::{Integers, Kind};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// A merged picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Merged {
    /// Width and height of the picture, px.
    pub size: [u32; 2],
    /// Number of tiles.
    pub tiles: u32,
    /// What the picture lacks, one sentence each.
    pub warnings: Vec<String>,
}

/// Why parts could not be merged.
pub(crate) enum MergeFailure {
    /// A part was summed with finer integers than the whole picture allows.
    TooFine { part: PathBuf, integers: Integers },
    /// Any other error.
    Other(RenderError),
}

impl<E: Into<RenderError>> From<E> for MergeFailure {
    fn from(error: E) -> Self {
        Self::Other(error.into())
    }
}

/// Merges the parts of a picture, one per tile in any order, into an EXR. The bytes are the same as those of the picture rendered at
/// once.
///
/// # Errors
/// A part is missing, duplicated, incomplete, belongs to another picture, or was summed with finer integers than the picture allows; the
/// message names it. Or the picture cannot be written.
pub fn merge_tiles(parts: &[PathBuf], output: &Path, steps: &dyn Steps) -> Result<Merged, RenderError> {
    merge(parts, output, steps).map_err(|failure| match failure {
        MergeFailure::Other(error) => error,
        MergeFailure::TooFine { part, integers: Integers { standard, painted } } => RenderError::bad_file(
            &part,
            format!(
                "its integer sums are finer than the whole picture allows (render its tile again with --integers {standard},{painted})"
            ),
        ),
    })
}

pub(crate) fn merge(files: &[PathBuf], output: &Path, steps: &dyn Steps) -> Result<Merged, MergeFailure> {
    let opening = steps.begin("parts");
    let mut parts = Vec::with_capacity(files.len());
    for (index, file) in files.iter().enumerate() {
        opening.check()?;
        parts.push(Part::open(file)?);
        opening.report((index + 1) as f32 / files.len() as f32);
    }
    drop(opening);
    check_plan(&parts)?;
    check_tiles(&parts)?;
    check_integers(&parts)?;
    let Some((_, first)) = parts.first() else {
        return Err(RenderError::BadInput("no parts were given (name all of them)".into()).into());
    };
    let unknown_format =
        || RenderError::bad_file(output, "the parts do not describe its format (render the tiles again)");
    let options = first.output.options().ok_or_else(unknown_format)?;
    let aovs: Vec<Aov> = first.aovs.iter().filter_map(|name| Aov::named(name)).collect();
    let progress = steps.begin("gains");
    let picture = JoinedPicture::new(&parts, |piece| Some(&piece.picture), &*progress)?;
    let pinhole = JoinedPicture::new(&parts, |piece| piece.pinhole.as_ref(), &*progress)?;
    drop(progress);
    let mut bands = Bands {
        size: first.size,
        aovs,
        picture: picture.ok_or_else(unknown_format)?,
        pinhole,
        planes: planes(&parts),
        mattes: mattes(&parts),
    };
    let progress = steps.begin("merging");
    let layers = bands.layer_names();
    let height = first.size[1];
    write_picture_in_bands(output, first.size, &layers, &options, |rows| {
        progress.check()?;
        progress.report(rows.start as f32 / height as f32);
        bands.next(rows)
    })?;
    let warnings = bands.mattes.iter().filter_map(|matte| {
        let left_out = matte.pieces.iter().map(|piece| piece.matte.left_out).fold(0.0, f32::max);
        left_out_warning(&matte.things.plural_name, left_out)
    });
    Ok(Merged { size: first.size, tiles: parts.len() as u32, warnings: warnings.collect() })
}

/// Checks that all parts have the same plan; reports one that differs from the most common plan.
fn check_plan(parts: &[(PartFile, Part)]) -> Result<(), RenderError> {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    parts.iter().for_each(|(_, part)| *counts.entry(&part.plan).or_default() += 1);
    let most_common_plan =
        parts.iter().map(|(_, part)| &part.plan).rev().max_by_key(|plan| counts[plan.as_str()]);
    match parts.iter().find(|(_, part)| Some(&part.plan) != most_common_plan) {
        None => Ok(()),
        Some((file, _)) => {
            let what = "is of another plan than the others: other input, options, tiles or version (leave it out, or render its tile again)";
            Err(RenderError::bad_file(&file.file, what))
        }
    }
}

/// Checks that each tile is present exactly once.
fn check_tiles(parts: &[(PartFile, Part)]) -> Result<(), RenderError> {
    let mut file_of_tile: BTreeMap<u32, &Path> = BTreeMap::new();
    for (file, part) in parts {
        if let Some(other) = file_of_tile.insert(part.tile, &file.file) {
            let what = format!("is the same tile as {} (give one of them)", other.display());
            return Err(RenderError::bad_file(&file.file, what));
        }
    }
    let Some((file, part)) = parts.first() else { return Ok(()) };
    let grid = TileGrid { columns: part.tiles[0], rows: part.tiles[1] };
    let missing: Vec<u32> = (0..grid.count()).filter(|tile| !file_of_tile.contains_key(tile)).collect();
    let Some(&tile) = missing.first() else { return Ok(()) };
    // Parts are named after the picture.
    let name = file.file.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let suffix = part_path(Path::new("x"), grid, part.tile).to_string_lossy()[1..].to_string();
    let stem = name.strip_suffix(&suffix).unwrap_or("*").to_string();
    let missing_part = part_path(&file.file.with_file_name(format!("{stem}.x")), grid, tile);
    let others = match missing.len() {
        1 => String::new(),
        more => format!(", and {} others", more - 1),
    };
    let what = format!(
        "the part of tile {} of {} is missing{others} (render it with --shard, and pass it too)",
        tile + 1,
        grid.count()
    );
    Err(RenderError::bad_file(&missing_part, what))
}

/// Checks that all parts are summed with the integers of the whole picture: the finest that do not overflow.
fn check_integers(parts: &[(PartFile, Part)]) -> Result<(), MergeFailure> {
    let facts = || parts.iter().flat_map(|(_, part)| part.facts());
    let brightest = facts().map(|facts| facts.brightest).fold(1.0, f64::max);
    let is_painted = facts().any(|facts| facts.is_painted);
    let kinds = if is_painted { &[Kind::Standard, Kind::Painted][..] } else { &[Kind::Standard] };
    let mut integers = facts().fold(Integers::default(), |all, facts| all.coarsest(facts.integers));
    for &kind in kinds {
        let fits = |integers: Integers| {
            facts()
                .filter(|facts| facts.integers.bits(kind) == integers.bits(kind))
                .all(|facts| integers.can_hold(kind, facts.largest[kind as usize], brightest))
        };
        if !fits(integers) {
            let what =
                "the scene's radiance is too high to be summed exactly (keep the brightest light below 1e6)";
            integers = integers.coarser(kind).ok_or_else(|| RenderError::BadInput(what.into()))?;
        }
    }
    let is_finer = |part: &Part| {
        part.facts().any(|facts| kinds.iter().any(|&kind| facts.integers.bits(kind) > integers.bits(kind)))
    };
    match parts.iter().find(|(_, part)| is_finer(part)) {
        None => Ok(()),
        Some((file, _)) => Err(MergeFailure::TooFine { part: file.file.clone(), integers }),
    }
}

/// Readers of the planes of all pieces, by name. A piece without a plane that others have counts as 0.
fn planes(parts: &[(PartFile, Part)]) -> BTreeMap<String, PieceRows<'_>> {
    let names: BTreeSet<&String> =
        parts.iter().flat_map(|(_, part)| &part.pieces).flat_map(|piece| piece.planes.keys()).collect();
    let rows = |name: &String| {
        PieceRows::new(parts, 1, |piece| Some((piece.planes.get(name)?.section(), piece.size[0] as usize)))
    };
    names.into_iter().map(|name| (name.clone(), rows(name))).collect()
}

/// The mattes of a kind of things, from all pieces.
struct MergedMatte<'a> {
    things: &'a NamedThings,
    needed: usize,
    pieces: Vec<MattePieceReader<'a>>,
}

struct MattePieceReader<'a> {
    file: &'a PartFile,
    matte: &'a Matte,
    first_column: u32,
    rows: Range<u32>,
    open: Option<[NumberReader; 2]>,
}

fn mattes(parts: &[(PartFile, Part)]) -> Vec<MergedMatte<'_>> {
    let Some((_, first)) = parts.first() else { return Vec::new() };
    let of_kind = |(kind, things)| {
        let pieces = parts.iter().flat_map(|(file, part)| part.pieces.iter().map(move |piece| (file, piece)));
        let pieces: Vec<_> = pieces
            .map(|(file, piece)| MattePieceReader {
                file,
                matte: &piece.mattes[kind],
                first_column: piece.corner[0],
                rows: piece.corner[1]..piece.corner[1] + piece.size[1],
                open: None,
            })
            .collect();
        let needed = pieces.iter().map(|piece| piece.matte.needed).max().unwrap_or(0).max(1);
        MergedMatte { things, needed, pieces }
    };
    first.things.iter().enumerate().map(of_kind).collect()
}

impl MergedMatte<'_> {
    /// Reads the entries of the next row, column by column.
    fn row(&mut self, y: u32) -> Result<Vec<Entry>, RenderError> {
        let mut row = Vec::new();
        for piece in self.pieces.iter_mut().filter(|piece| piece.rows.contains(&y)) {
            let open = match &mut piece.open {
                Some(open) => open,
                none => {
                    let read = |numbers: NumbersAt| piece.file.read(numbers.section());
                    none.insert([read(piece.matte.counts)?, read(piece.matte.entries)?])
                }
            };
            let [counts, entries] = open;
            let count = counts.read_words(1)?.first().copied().unwrap_or(0);
            let count = u64::from(count).min(piece.matte.entries.count) as usize;
            let numbers = entries.read_words(3 * count)?;
            let (entries, _) = numbers.as_chunks::<3>();
            row.extend(entries.iter().map(|&[column, thing, share]| Entry {
                column: piece.first_column.saturating_add(column),
                thing,
                share: f32::from_bits(share),
            }));
            if y + 1 == piece.rows.end {
                piece.open = None;
            }
        }
        Ok(row)
    }

    /// The Cryptomatte layers of some rows.
    fn layers(&self, rows: &[Vec<Entry>], width: usize) -> Vec<Layer> {
        let ranks = ranks_of(rows.iter().map(Vec::as_slice), width, self.needed);
        let NamedThings { kind, names, .. } = self.things.clone();
        Cryptomatte { kind, names, ranks }.layers()
    }
}

/// Resolves the picture and its layers, some rows at a time.
struct Bands<'a> {
    size: [u32; 2],
    aovs: Vec<Aov>,
    picture: JoinedPicture<'a>,
    pinhole: Option<JoinedPicture<'a>>,
    planes: BTreeMap<String, PieceRows<'a>>,
    mattes: Vec<MergedMatte<'a>>,
}

impl Bands<'_> {
    /// The names of all layers.
    fn layer_names(&self) -> Vec<String> {
        let mut names: Vec<String> = self.planes.keys().cloned().collect();
        if self.aovs.contains(&Aov::Coverage) {
            names.push(Layer::coverage(&Picture::black(0, 0)).name);
        }
        if self.pinhole.is_some() {
            names.extend(Layer::from_colors(Layer::PINHOLE, &[]).map(|layer| layer.name));
        }
        for matte in &self.mattes {
            names.extend(matte.layers(&[], 0).into_iter().map(|layer| layer.name));
        }
        names
    }

    /// Resolves the next rows.
    fn next(&mut self, rows: Range<u32>) -> Result<(Picture, Vec<Layer>), RenderError> {
        let picture = self.picture.picture(rows.clone())?;
        let width = self.size[0] as usize;
        let mut layers = Vec::new();
        if self.aovs.contains(&Aov::Coverage) {
            layers.push(Layer::coverage(&picture));
        }
        if let Some(pinhole) = &mut self.pinhole {
            let pinhole = pinhole.picture(rows.clone())?;
            layers.extend(Layer::from_colors(Layer::PINHOLE, &pinhole.exposed(Exposure::Normalise)));
        }
        for (name, plane) in &mut self.planes {
            let mut values = vec![0.0; width * rows.len()];
            for (index, y) in rows.clone().enumerate() {
                for (first, numbers) in plane.next(y)? {
                    let at = index * width + first as usize;
                    values[at..at + numbers.len()].copy_from_slice(&numbers);
                }
            }
            layers.push(Layer { name: name.clone(), values });
        }
        for matte in &mut self.mattes {
            let entries = rows.clone().map(|y| matte.row(y)).collect::<Result<Vec<_>, _>>()?;
            let is_valid = |entry: &Entry| {
                (entry.column as usize) < width && (entry.thing as usize) < matte.things.names.len()
            };
            let entries: Vec<_> =
                entries.into_iter().map(|row| row.into_iter().filter(is_valid).collect()).collect();
            layers.extend(matte.layers(&entries, width));
        }
        Ok((picture, layers))
    }
}
