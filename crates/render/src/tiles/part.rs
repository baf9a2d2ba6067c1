//! The contents of a part file.

use crate::error::RenderError;
use crate::picture::Aov;
use crate::tiles::grid::TileGrid;
use lens::Exposure;
use project::{ColorSpace, Compression, PartFile, PictureOptions, Section};
use serde::{Deserialize, Serialize};
use splat::{Crop, CropFacts, CropForm, CropJoiner, Integers, KNOT_NUMBERS};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A drawn tile.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Part {
    /// Hex hash of everything the picture depends on, including the tile grid.
    pub plan: String,
    /// Number of the tile, from 0, row by row.
    pub tile: u32,
    /// Columns and rows of tiles.
    pub tiles: [u32; 2],
    /// Width and height of the whole picture, px.
    pub size: [u32; 2],
    /// Cells per side of a pixel.
    pub cells: u32,
    /// Names of the AOVs, in order.
    pub aovs: Vec<String>,
    /// How the picture is written.
    pub output: Output,
    /// Things of the mattes, by kind.
    pub things: Vec<NamedThings>,
    /// The pieces that the tile was drawn in.
    pub pieces: Vec<Piece>,
}

/// Serialized [`PictureOptions`].
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Output {
    conserves: bool,
    half: bool,
    compression: String,
    color_space: String,
    overscan: u32,
    attributes: BTreeMap<String, String>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct NamedThings {
    /// The kind's name in Cryptomatte.
    pub kind: String,
    /// The kind's plural name in messages.
    #[serde(rename = "said")]
    pub plural_name: String,
    pub names: Vec<String>,
}

/// A rectangle of the picture.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Piece {
    /// Its first column and row, px.
    pub corner: [u32; 2],
    /// Its columns and rows.
    pub size: [u32; 2],
    pub picture: Sums,
    pub pinhole: Option<Sums>,
    /// Further channels by name, one number per pixel.
    pub planes: BTreeMap<String, NumbersAt>,
    /// Mattes by kind of things.
    pub mattes: Vec<Matte>,
}

/// The sums of a picture.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Sums {
    /// Whether the numbers are those of [`CropForm::Evened`]: nothing is painted.
    is_evened: bool,
    pub numbers: NumbersAt,
    pub knots: NumbersAt,
    integers: [i32; 2],
    is_painted: bool,
    brightest: f64,
    largest: [[i64; 2]; 2],
}

/// The shares of each pixel that things of a kind cover.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Matte {
    /// Number of entries of each row.
    pub counts: NumbersAt,
    /// Column, thing and share of each entry.
    pub entries: NumbersAt,
    pub needed: usize,
    pub left_out: f32,
}

/// A section of numbers in the file.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct NumbersAt {
    first: u64,
    pub count: u64,
}

impl From<Section> for NumbersAt {
    fn from(Section { first, count }: Section) -> Self {
        Self { first, count }
    }
}

impl NumbersAt {
    /// Where the numbers lie in the part.
    pub fn section(self) -> Section {
        Section { first: self.first, count: self.count }
    }
}

impl Sums {
    /// What a part records of a crop's sums: form, facts, and where its numbers and knots lie.
    pub fn new(form: CropForm, facts: CropFacts, [numbers, knots]: [Section; 2]) -> Self {
        let CropFacts { integers: Integers { standard, painted }, is_painted, brightest, largest } = facts;
        Self {
            is_evened: form == CropForm::Evened,
            numbers: numbers.into(),
            knots: knots.into(),
            integers: [standard, painted],
            is_painted,
            brightest,
            largest,
        }
    }

    /// The form of the crop.
    pub fn form(&self) -> CropForm {
        if self.is_evened { CropForm::Evened } else { CropForm::Parts }
    }

    /// What the crop reports for decisions about the whole picture.
    pub fn facts(&self) -> CropFacts {
        let [standard, painted] = self.integers;
        let integers = Integers { standard, painted };
        CropFacts { integers, is_painted: self.is_painted, brightest: self.brightest, largest: self.largest }
    }

    /// Whether the sections have the right length for a crop of this size.
    fn is_valid_for(&self, size: [u32; 2]) -> bool {
        let [width, height] = size.map(u64::from);
        let knots = (CropJoiner::knot_columns(size[0]) * KNOT_NUMBERS) as u64;
        self.numbers.count == width * height * self.form().numbers() as u64
            && self.knots.count == height * knots
            && self.facts().integers.are_valid()
    }
}

impl Output {
    /// The names of the options by which the picture is written.
    pub fn new(options: &PictureOptions) -> Self {
        let name = |all: &[(&'static str, Compression)]| {
            all.iter()
                .find(|(_, compression)| *compression == options.compression)
                .map_or("", |(name, _)| name)
                .to_string()
        };
        let space = ColorSpace::ALL.iter().find(|(_, color_space)| *color_space == options.color_space);
        Self {
            conserves: options.exposure == Exposure::Conserve,
            half: options.half,
            compression: name(&Compression::ALL),
            color_space: space.map_or("", |(name, _)| name).to_string(),
            overscan: options.overscan,
            attributes: options.attributes.clone(),
        }
    }

    /// Deserializes the options. `None` if they contain names that this version of the program does not know.
    pub fn options(&self) -> Option<PictureOptions> {
        let space = ColorSpace::ALL.iter().find(|(name, _)| *name == self.color_space)?;
        Some(PictureOptions {
            exposure: if self.conserves { Exposure::Conserve } else { Exposure::Normalise },
            half: self.half,
            compression: Compression::from_name(&self.compression)?,
            color_space: space.1,
            overscan: self.overscan,
            attributes: self.attributes.clone(),
        })
    }
}

impl Part {
    /// Opens a part file.
    ///
    /// # Errors
    /// The file is incomplete, not a part, or written by another version of the program.
    pub fn open(file: &Path) -> Result<(PartFile, Self), RenderError> {
        let opened = PartFile::open(file)?;
        let part = serde_json::from_value::<Self>(opened.description.clone()).ok().filter(Self::is_valid);
        let part = part.ok_or_else(|| {
            let what = "is a part written by another version of the program (render its tile again)";
            RenderError::bad_file(file, what)
        })?;
        Ok((opened, part))
    }

    /// Whether the description is consistent.
    fn is_valid(&self) -> bool {
        let grid = TileGrid { columns: self.tiles[0], rows: self.tiles[1] };
        let is_small = self.size.iter().chain(&self.tiles).all(|side| (1..=1 << 15).contains(side));
        let tile = is_small.then(|| grid.tiles(self.size).ok()).flatten();
        let Some(tile) = tile.and_then(|tiles| tiles.get(self.tile as usize).copied()) else { return false };
        let area = |size: [u32; 2]| u64::from(size[0]) * u64::from(size[1]);
        let is_within = |piece: &Piece| {
            (0..2).all(|axis| {
                let (first, end) = (piece.corner[axis], piece.corner[axis].saturating_add(piece.size[axis]));
                first >= tile.corner[axis]
                    && end <= tile.corner[axis] + tile.size[axis]
                    && first.is_multiple_of(Crop::ALIGNMENT)
            })
        };
        let cells = self.cells;
        let is_valid = |piece: &Piece| {
            let finer = piece.size.map(|side| side.saturating_mul(cells));
            is_within(piece)
                && piece.picture.is_valid_for(finer)
                && piece.pinhole.iter().all(|sums| sums.is_valid_for(finer))
                && piece.planes.values().all(|plane| plane.count == area(piece.size))
                && piece.mattes.len() == self.things.len()
                && piece.mattes.iter().all(|matte| matte.counts.count == u64::from(piece.size[1]))
        };
        (1..=crate::picture::MAX_CELLS_A_SIDE).contains(&cells)
            && self.pieces.iter().all(is_valid)
            && self.pieces.iter().map(|piece| area(piece.size)).sum::<u64>() == area(tile.size)
            && self.aovs.iter().all(|name| Aov::named(name).is_some())
            && self.output.options().is_some()
    }

    /// The facts of the picture's pieces.
    pub fn facts(&self) -> impl Iterator<Item = CropFacts> {
        self.pieces.iter().map(|piece| piece.picture.facts())
    }
}

/// The path of the part of a tile (from 0) beside a picture.
pub(crate) fn part_path(picture: &Path, grid: TileGrid, tile: u32) -> PathBuf {
    let count = grid.count();
    let digits = count.to_string().len();
    let number = tile + 1;
    picture.with_extension(format!("tile{number:0digits$}-of-{count}.part"))
}
