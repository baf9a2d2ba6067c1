//! Compressed PLY of SuperSplat: ranges for each 256 splats, and four integers for each splat.
//!
//! Mean and ln s have 11, 10 and 11 bits between the least and the largest of the chunk; the rotation 2 bits for the component of w x y z
//! that is left out and 10 for each of the others; colour and opacity (as it is) 8 bits each. Coefficients beyond degree 0 are bytes, all of
//! red, then green, then blue.

use super::super::format::SplatFormat;
use super::super::quaternion::from_smallest_three;
use super::super::reading::Reading;
use super::super::splat_file::SplatFile;
use super::header::{Element, Header};
use super::rows::Rows;
use crate::cloud::harmonics::degree_of;
use crate::cloud::{CloudTraits, Splat};
use crate::error::GaussianError;
use glam::Vec3;
use std::io::BufRead;

/// Splats that share their ranges.
const CHUNK: u64 = 256;

/// # Errors
/// A table or column is missing, has another number of rows than it must, or exceeds the limits.
pub(super) fn read(
    reading: Reading<'_>,
    header: &Header,
    mut rows: Rows<impl BufRead>,
) -> Result<SplatFile, GaussianError> {
    let vertices = header.vertices(&reading)?;
    let count = vertices.count;
    let (mut chunks, mut packed, mut builder) = (Vec::new(), Vec::new(), None);
    let beside = count.saturating_mul(size_of::<Packed>() as u64);
    for element in &header.elements {
        match element.name.as_str() {
            "chunk" if chunks.is_empty() => chunks = read_chunks(&reading, &mut rows, element)?,
            "vertex" if packed.is_empty() => {
                packed = read_packed(&reading, &mut rows, element, chunks.len() as u64)?;
            }
            "sh" if builder.is_none() => {
                if packed.is_empty() {
                    return Err(reading.malformed("sh", "comes before the table vertex"));
                }
                let coefficients = Coefficients::new(&reading, element, count)?;
                rows.check_count(&reading, element)?;
                let filling = builder.insert(reading.builder(coefficients.degree, count, beside)?);
                let (mut row, mut values) = (Vec::new(), Vec::new());
                for (index, splat) in packed.iter().enumerate() {
                    reading.at_row(index as u64, count)?;
                    rows.next(&reading, element, &mut row)?;
                    coefficients.decode(&row, &mut values);
                    filling.push(splat.decode(&chunks[index / CHUNK as usize]), &values);
                }
            }
            _ => rows.skip(&reading, element)?,
        }
    }
    let builder = match builder {
        Some(builder) => builder,
        None => {
            let mut filling = reading.builder(0, count, beside)?;
            for (index, splat) in packed.iter().enumerate() {
                filling.push(splat.decode(&chunks[index / CHUNK as usize]), &[]);
            }
            filling
        }
    };
    let traits = CloudTraits { is_antialiased: header.is_antialiased, ..CloudTraits::default() };
    reading.finish(builder, traits, SplatFormat::CompressedPly)
}

/// The ranges of a chunk.
struct Chunk {
    mean: [Vec3; 2],
    log_scale: [Vec3; 2],
    color: [Vec3; 2],
}

fn read_chunks(
    reading: &Reading<'_>,
    rows: &mut Rows<impl BufRead>,
    element: &Element,
) -> Result<Vec<Chunk>, GaussianError> {
    let columns = |end: &str, names: [&str; 3]| {
        let [a, b, c] = names.map(|name| element.column(&format!("{end}_{name}")));
        Some([a?, b?, c?])
    };
    let range = |names| Some([columns("min", names)?, columns("max", names)?]);
    let missing = || reading.malformed("chunk", "has not the ranges min_x to max_scale_z");
    let mean = range(["x", "y", "z"]).ok_or_else(missing)?;
    let log_scale = range(["scale_x", "scale_y", "scale_z"]).ok_or_else(missing)?;
    let color = range(["r", "g", "b"]);
    rows.check_count(reading, element)?;
    reading.check_memory("the ranges take", element.count.saturating_mul(size_of::<Chunk>() as u64))?;
    let mut chunks = Vec::with_capacity(element.count as usize);
    let mut row = Vec::new();
    for _ in 0..element.count {
        rows.next(reading, element, &mut row)?;
        let ends =
            |range: [[usize; 3]; 2]| range.map(|end| Vec3::from_array(end.map(|column| row[column] as f32)));
        let color = color.map_or([Vec3::ZERO, Vec3::ONE], ends);
        chunks.push(Chunk { mean: ends(mean), log_scale: ends(log_scale), color });
    }
    Ok(chunks)
}

/// The integers of a splat.
struct Packed {
    position: u32,
    rotation: u32,
    scale: u32,
    color: u32,
}

fn read_packed(
    reading: &Reading<'_>,
    rows: &mut Rows<impl BufRead>,
    element: &Element,
    chunks: u64,
) -> Result<Vec<Packed>, GaussianError> {
    let column = |name: &str| {
        element.column(name).ok_or_else(|| reading.malformed("vertex", format!("has no property {name}")))
    };
    let columns = [
        column("packed_position")?,
        column("packed_rotation")?,
        column("packed_scale")?,
        column("packed_color")?,
    ];
    rows.check_count(reading, element)?;
    if element.count.div_ceil(CHUNK) != chunks {
        let what = format!(
            "{} rows need {} chunks, but {chunks} come before them",
            element.count,
            element.count.div_ceil(CHUNK)
        );
        return Err(reading.malformed("vertex", what));
    }
    reading
        .check_memory("the packed splats take", element.count.saturating_mul(size_of::<Packed>() as u64))?;
    let mut packed = Vec::with_capacity(element.count as usize);
    let mut row = Vec::new();
    for index in 0..element.count {
        reading.at_row(index, element.count)?;
        rows.next(reading, element, &mut row)?;
        let [position, rotation, scale, color] = columns.map(|column| row[column] as u32);
        packed.push(Packed { position, rotation, scale, color });
    }
    Ok(packed)
}

/// The lowest `bits` of a number as a share of their largest value.
fn share(value: u32, bits: u32) -> f32 {
    let most = (1 << bits) - 1;
    (value & most) as f32 / most as f32
}

/// Three shares of 11, 10 and 11 bits.
fn three_shares(value: u32) -> Vec3 {
    Vec3::new(share(value >> 21, 11), share(value >> 11, 10), share(value, 11))
}

impl Packed {
    fn decode(&self, chunk: &Chunk) -> Splat {
        let between = |[from, to]: [Vec3; 2], at: Vec3| from * (1.0 - at) + to * at;
        let color =
            Vec3::new(share(self.color >> 24, 8), share(self.color >> 16, 8), share(self.color >> 8, 8));
        let component = |shift: u32| f64::from(share(self.rotation >> shift, 10)) * 2.0 - 1.0;
        Splat {
            mean: between(chunk.mean, three_shares(self.position)),
            rotation: from_smallest_three(
                (self.rotation >> 30) as usize,
                [component(20), component(10), component(0)],
            ),
            log_scale: between(chunk.log_scale, three_shares(self.scale)),
            opacity: share(self.color, 8),
            base_color: between(chunk.color, color).map(Splat::base_of_color),
        }
    }
}

/// The columns of the coefficients beyond degree 0.
struct Coefficients {
    degree: u32,
    columns: Vec<usize>,
}

impl Coefficients {
    fn new(reading: &Reading<'_>, element: &Element, count: u64) -> Result<Self, GaussianError> {
        let columns: Vec<usize> = (0..).map_while(|k| element.column(&format!("f_rest_{k}"))).collect();
        if element.count != count || !element.is_fixed() {
            let what = format!("has {} rows for {count} splats, or lists", element.count);
            return Err(reading.malformed("sh", what));
        }
        match degree_of(columns.len() / 3).filter(|_| columns.len().is_multiple_of(3)) {
            Some(degree) => Ok(Self { degree, columns }),
            None => {
                let what = format!(
                    "has {} properties f_rest, where 9, 24, 45 or 72 belong to a degree",
                    columns.len()
                );
                Err(reading.malformed("sh", what))
            }
        }
    }

    /// The bytes of a row as coefficients, those of a colour beside each other: 0 is −4 and 255 is 4, between them the middle of the
    /// 256th of that range.
    fn decode(&self, row: &[f64], values: &mut Vec<f32>) {
        let count = self.columns.len() / 3;
        values.clear();
        values.extend((0..3 * count).map(|k| {
            let byte = row[self.columns[k % 3 * count + k / 3]] as f32;
            let share = if byte == 0.0 || byte == 255.0 { byte / 255.0 } else { (byte + 0.5) / 256.0 };
            (share - 0.5) * 8.0
        }));
    }
}
