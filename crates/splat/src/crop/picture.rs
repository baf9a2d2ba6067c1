//! Sums of a crop to its numbers.

use super::integers::Integers;
use super::row::{CropForm, KNOT_NUMBERS};
use crate::resolve::knots::{KnotSums, Knots};
use crate::resolve::partition::{Parts, Share};
use crate::resolve::parts_to_pixels::Pixels;
use crate::resolve::{BLACK, Light, Overflow, Quanta, Room, Window};
use crate::sums::{RESOLVE_ROWS, Sums};
use lens::Picture;
use rayon::prelude::*;
use std::ops::Range;

/// The contribution of a crop to the picture.
#[derive(Clone, Debug)]
pub struct CropPicture {
    /// What is stored for each pixel.
    pub form: CropForm,
    /// Pixel by pixel, row by row.
    pub numbers: Vec<f32>,
    /// The contribution of each row to each column of knots, [`KNOT_NUMBERS`] each, row by row.
    pub knots: Vec<f32>,
    /// What the whole is to decide.
    pub facts: CropFacts,
}

/// What a crop reports for decisions about the whole picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CropFacts {
    /// The integers that it is summed in.
    pub integers: Integers,
    /// Whether anything of it is painted.
    pub is_painted: bool,
    /// The largest radiance of a sample, at least 1.
    pub brightest: f64,
    /// The largest coverage of a pixel of the standard and of the painted sums, in quanta: of ordinary samples, and of bright ones.
    pub largest: [[i64; 2]; 2],
}

impl CropFacts {
    pub(super) fn empty(integers: Integers) -> Self {
        Self { integers, is_painted: false, brightest: 1.0, largest: [[0; 2]; 2] }
    }
}

/// Where a crop lies in what is summed.
#[derive(Clone, Copy)]
pub(super) struct Inner {
    first: [u32; 2],
    size: [usize; 2],
}

impl Inner {
    /// An inner rectangle whose upper left pixel is `first`, of `size` columns and rows.
    pub fn new(first: [u32; 2], size: [u32; 2]) -> Self {
        Self { first, size: size.map(|side| side as usize) }
    }

    /// Some of its rows, in what is summed.
    fn rows(self, rows: Range<usize>) -> Range<i32> {
        let first = self.first[1] as i32;
        first + rows.start as i32..first + rows.end as i32
    }

    /// Its columns there.
    fn columns(self) -> Range<usize> {
        let first = self.first[0] as usize;
        first..first + self.size[0]
    }
}

/// The numbers of a crop's standard picture.
pub(super) struct Standard {
    pub numbers: Vec<f32>,
    pub knots: Vec<f32>,
    pub shares: Vec<Share>,
    pub largest: [i64; 2],
}

pub(super) fn standard(
    sums: &Sums,
    quanta: [Quanta; 2],
    inner: Inner,
    form: CropForm,
) -> Result<Standard, Overflow> {
    let [width, height] = inner.size;
    let knots = Knots::new(inner.size);
    let of_knots = knots.columns() * KNOT_NUMBERS;
    let mut made = Standard {
        numbers: vec![0.0; width * height * form.numbers()],
        knots: vec![0.0; height * of_knots],
        shares: vec![Share::NONE; width * height],
        largest: [0; 2],
    };
    let numbers = made.numbers.par_chunks_mut(RESOLVE_ROWS * width * form.numbers());
    let of_rows = made.knots.par_chunks_mut(RESOLVE_ROWS * of_knots);
    let shares = made.shares.par_chunks_mut(RESOLVE_ROWS * width);
    let chunks = numbers.zip(of_rows).zip(shares).enumerate();
    made.largest = chunks
        .map_init(Room::default, |room, (chunk, ((numbers, of_rows), shares))| {
            let rows = rows_of(chunk, height);
            let (mut radiance, mut coverage) = (vec![[0.0; 3]; width], vec![0.0; width]);
            let mut knot_sums = vec![KnotSums::default(); knots.columns()];
            lines(sums, quanta, inner, rows, room, |row, parts| {
                let shares = &mut shares[row * width..][..width];
                parts.find_shares(shares);
                knots.sum_row(parts, shares, &mut knot_sums, true);
                let numbers_of_row = knot_sums.iter().flat_map(|sums| sums.0.as_flattened());
                of_rows[row * of_knots..]
                    .iter_mut()
                    .zip(numbers_of_row)
                    .for_each(|(to, number)| *to = *number);
                let numbers = &mut numbers[row * width * form.numbers()..][..width * form.numbers()];
                if form == CropForm::Parts {
                    write_parts(parts, numbers);
                    let factors = numbers.chunks_exact_mut(form.numbers()).zip(shares);
                    factors.for_each(|(pixel, share)| (pixel[8], pixel[9]) = (share.partial, share.even));
                    return;
                }
                let pixels = Pixels { first: 0, radiance: &mut radiance, coverage: &mut coverage };
                parts.join(shares, None, true, pixels);
                let pixels = numbers.chunks_exact_mut(form.numbers()).zip(radiance.iter().zip(&coverage));
                pixels
                    .for_each(|(pixel, ([r, g, b], covered))| pixel.copy_from_slice(&[*r, *g, *b, *covered]));
            })
        })
        .try_reduce(|| [0; 2], |a, b| Ok(larger(a, b)))?;
    Ok(made)
}

/// Puts the light of a painted crop in the place of that of the standard one. Returns the largest coverage.
pub(super) fn painted(
    sums: &Sums,
    quanta: [Quanta; 2],
    inner: Inner,
    numbers: &mut [f32],
) -> Result<[i64; 2], Overflow> {
    let [width, height] = inner.size;
    let a_row = width * CropForm::Parts.numbers();
    numbers
        .par_chunks_mut(RESOLVE_ROWS * a_row)
        .enumerate()
        .map_init(Room::default, |room, (chunk, numbers)| {
            lines(sums, quanta, inner, rows_of(chunk, height), room, |row, parts| {
                write_parts(parts, &mut numbers[row * a_row..][..a_row]);
            })
        })
        .try_reduce(|| [0; 2], |a, b| Ok(larger(a, b)))
}

/// The picture of a matte's sums: not scaled by gains.
pub(super) fn matte(
    sums: &Sums,
    quanta: [Quanta; 2],
    inner: Inner,
    shares: &[Share],
) -> Result<Picture, Overflow> {
    let [width, height] = inner.size;
    let mut picture = Picture::black(width as u32, height as u32);
    let radiance = picture.radiance.par_chunks_mut(RESOLVE_ROWS * width);
    let chunks = radiance.zip(picture.coverage.par_chunks_mut(RESOLVE_ROWS * width)).enumerate();
    chunks.try_for_each_init(Room::default, |room, (chunk, (radiance, coverage))| {
        let rows = rows_of(chunk, height);
        let first = rows.start;
        lines(sums, quanta, inner, rows, room, |row, parts| {
            let here = row * width..(row + 1) * width;
            let pixels =
                Pixels { first: 0, radiance: &mut radiance[here.clone()], coverage: &mut coverage[here] };
            parts.join(&shares[(first + row) * width..][..width], None, false, pixels);
        })
        .map(|_| ())
    })?;
    Ok(picture)
}

fn write_parts(parts: Parts, numbers: &mut [f32]) {
    let lights = parts.free.iter().zip(parts.sharing);
    for (pixel, (free, sharing)) in numbers.chunks_exact_mut(CropForm::Parts.numbers()).zip(lights) {
        pixel[..4].copy_from_slice(free);
        pixel[4..8].copy_from_slice(sharing);
    }
}

fn larger(a: [i64; 2], b: [i64; 2]) -> [i64; 2] {
    [a[0].max(b[0]), a[1].max(b[1])]
}

/// The rows of a chunk.
fn rows_of(chunk: usize, height: usize) -> Range<usize> {
    let first = chunk * RESOLVE_ROWS;
    first..(first + RESOLVE_ROWS).min(height)
}

/// Calls `visit` with each of some rows of a crop, counted from the first of them. Returns the largest coverage of a pixel.
fn lines(
    sums: &Sums,
    quanta: [Quanta; 2],
    inner: Inner,
    rows: Range<usize>,
    room: &mut Room,
    mut visit: impl FnMut(usize, Parts),
) -> Result<[i64; 2], Overflow> {
    // Whole rows: only then can it be detected whether one of their pixels has wrapped.
    let width = sums.free.dim.levels[0].width;
    let window = Window { rows: inner.rows(rows), columns: 0..width as i32 };
    let [mut free_marks, mut sharing_marks] = sums.marks(window.rows.clone());
    let mut free = sums.free.rows(quanta, &window, &mut free_marks, room)?;
    let mut sharing = sums.sharing.rows(quanta, &window, &mut sharing_marks, room)?;
    let mut lights: [Vec<Light>; 2] = [room.take(width), room.take(width)];
    lights.iter_mut().for_each(|line| line.fill(BLACK));
    for (index, row) in window.rows.clone().enumerate() {
        free.read(row, &mut lights[0])?;
        sharing.read(row, &mut lights[1])?;
        let [free, sharing] = lights.each_ref().map(|line| &line[inner.columns()]);
        visit(index, Parts { free, sharing });
    }
    let largest = larger(free.largest(), sharing.largest());
    lights.into_iter().for_each(|line| room.recycle(line));
    [free, sharing].into_iter().for_each(|rows| rows.recycle(room));
    Ok(largest)
}
