//! Joining the sums of all pieces of a picture, row by row.

use crate::error::RenderError;
use crate::tiles::part::{Part, Piece, Sums};
use lens::Picture;
use progress::Progress;
use project::{NumberReader, PartFile, Section};
use splat::{CropForm, CropJoiner, CropRow, KNOT_NUMBERS};
use std::ops::Range;

/// Reads the numbers of pieces row by row, from the top of the picture.
pub(crate) struct PieceRows<'a> {
    pieces: Vec<PieceReader<'a>>,
}

struct PieceReader<'a> {
    file: &'a PartFile,
    section: Section,
    /// Its columns and rows in the picture.
    columns: Range<u32>,
    rows: Range<u32>,
    /// Numbers per row.
    length: usize,
    open: Option<NumberReader>,
}

impl<'a> PieceRows<'a> {
    /// A reader of the sections that `section_of` selects, with their numbers per row. Rows are those of the finer picture, `cells` per pixel.
    pub fn new(
        parts: &'a [(PartFile, Part)],
        cells: u32,
        section_of: impl Fn(&'a Piece) -> Option<(Section, usize)>,
    ) -> Self {
        let mut pieces: Vec<_> = parts
            .iter()
            .flat_map(|(file, part)| part.pieces.iter().map(move |piece| (file, piece)))
            .filter_map(|(file, piece)| {
                let (section, length) = section_of(piece)?;
                let [columns, rows] = [0, 1].map(|axis| {
                    let first = piece.corner[axis] * cells;
                    first..first + piece.size[axis] * cells
                });
                Some(PieceReader { file, section, columns, rows, length, open: None })
            })
            .collect();
        pieces.sort_by_key(|piece| (piece.columns.start, piece.rows.start));
        Self { pieces }
    }

    /// Reads the next row, which must be `y`: for each piece that it crosses, from left to right, its first column and its numbers.
    ///
    /// # Errors
    /// A part cannot be read.
    pub fn next(&mut self, y: u32) -> Result<Vec<(u32, Vec<f32>)>, RenderError> {
        let mut row = Vec::new();
        for piece in self.pieces.iter_mut().filter(|piece| piece.rows.contains(&y)) {
            let open = match &mut piece.open {
                Some(open) => open,
                none => none.insert(piece.file.read(piece.section)?),
            };
            row.push((piece.columns.start, open.read_floats(piece.length)?));
            if y + 1 == piece.rows.end {
                piece.open = None;
            }
        }
        Ok(row)
    }
}

/// A picture that is resolved from the sums of all parts.
pub(crate) struct JoinedPicture<'a> {
    joining: CropJoiner,
    form: CropForm,
    /// The finer picture's width and height.
    size: [u32; 2],
    cells: u32,
    rows: PieceRows<'a>,
}

impl<'a> JoinedPicture<'a> {
    /// Reads the knots of all parts and solves for the gains. `sums_of` selects the sums of a piece. `None` if there are none.
    pub fn new(
        parts: &'a [(PartFile, Part)],
        sums_of: impl Fn(&'a Piece) -> Option<&'a Sums> + Copy,
        progress: &dyn Progress,
    ) -> Result<Option<Self>, RenderError> {
        let Some((_, first)) = parts.first() else { return Ok(None) };
        let sums = || parts.iter().flat_map(|(_, part)| &part.pieces).filter_map(sums_of);
        let Some(form) = sums().map(Sums::form).next() else { return Ok(None) };
        let is_painted = sums().any(|sums| sums.facts().is_painted);
        let (cells, size) = (first.cells, first.size.map(|side| side * first.cells));
        let mut joining = CropJoiner::new(size, is_painted);
        let check = |y: u32| {
            progress.report(y as f32 / size[1] as f32);
            progress.check()
        };
        let mut knots = PieceRows::new(parts, cells, |piece| {
            let length = CropJoiner::knot_columns(piece.size[0] * cells) * KNOT_NUMBERS;
            Some((sums_of(piece)?.knots.section(), length))
        });
        for y in 0..size[1] {
            check(y)?;
            let row_knots = knots.next(y)?;
            joining.add_knots(y, row_knots.iter().map(|(first, numbers)| (*first, numbers.as_slice())));
        }
        joining.find_gains();
        let pixels = || {
            PieceRows::new(parts, cells, |piece| {
                let sums = sums_of(piece)?;
                Some((sums.numbers.section(), (piece.size[0] * cells) as usize * sums.form().numbers()))
            })
        };
        let mut joined = Self { joining, form, size, cells, rows: pixels() };
        if is_painted {
            for y in 0..size[1] {
                check(y)?;
                let mut row = joined.row(y)?;
                joined.joining.add_shared(y, &mut row);
            }
            joined.joining.find_rest();
            joined.rows = pixels();
        }
        Ok(Some(joined))
    }

    /// Reads the next row of the finer picture, without gains applied.
    fn row(&mut self, y: u32) -> Result<CropRow, RenderError> {
        let mut row = CropRow::black(self.size[0] as usize);
        for (first, numbers) in self.rows.next(y)? {
            row.set(first as usize, self.form, &numbers);
        }
        Ok(row)
    }

    /// Resolves the next rows of the picture, which must follow those resolved before.
    ///
    /// # Errors
    /// A part cannot be read.
    pub fn picture(&mut self, rows: Range<u32>) -> Result<Picture, RenderError> {
        let fine = rows.start * self.cells..rows.end * self.cells;
        let (mut radiance, mut coverage) = (Vec::new(), Vec::new());
        for y in fine.clone() {
            let mut row = self.row(y)?;
            self.joining.join(y, self.form, &mut row);
            radiance.append(&mut row.radiance);
            coverage.append(&mut row.coverage);
        }
        let (width, height) = (self.size[0], fine.len() as u32);
        let picture = Picture { width, height, radiance, coverage, colour_coverage: None };
        Ok(picture.averaged(self.cells))
    }
}
