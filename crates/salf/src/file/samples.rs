//! Samples in a `.salf` file.

use super::SalfFileError;
use super::little_endian::{FIRST_CAPACITY, bytes, read_f32s, read_f64s, write_f32s, write_f64s};
use crate::samples::{Chunk, Patch, Plane, Record, Samples, Starts};
use crate::{Sample, Visibility};
use glam::{DVec2, IVec2, Vec2, Vec3};
use std::io::{self, Read, Write};
use surface::SurfacePoint;

const BACKGROUND: u32 = u32::MAX;
/// Added to the number of words of visibility: the light is carried.
const CARRIED: u8 = 0x80;

/// Writes samples: the counts of their lists (u64), then the lists.
///
/// # Errors
/// Errors of `to`.
pub fn write_samples(to: &mut impl Write, samples: &Samples) -> io::Result<()> {
    let Samples { chunks, records, planes, sub_cells, patches, codes, loose } = samples;
    let counts =
        [chunks.len(), records.len(), planes.len(), sub_cells.len(), patches.len(), codes.len(), loose.len()];
    counts.iter().try_for_each(|&count| to.write_all(&(count as u64).to_le_bytes()))?;
    for Chunk { corner, starts } in chunks {
        corner.to_array().iter().try_for_each(|px| to.write_all(&px.to_le_bytes()))?;
        let Starts { records, planes, sub_cells, patches, codes } = starts;
        [records, planes, sub_cells, patches, codes]
            .iter()
            .try_for_each(|at| to.write_all(&at.to_le_bytes()))?;
    }
    records.iter().try_for_each(|record| to.write_all(&record.to_bytes()))?;
    planes.iter().try_for_each(|plane| to.write_all(&plane.to_bytes()))?;
    sub_cells.iter().try_for_each(|some| to.write_all(&some.to_le_bytes()))?;
    patches.iter().try_for_each(|patch| to.write_all(&patch.to_bytes()))?;
    to.write_all(codes)?;
    loose.iter().try_for_each(|sample| write_sample(to, sample))
}

impl Samples {
    /// The lists that samples begin with in a file, their counts before them: how many items each has, and of how many bytes.
    pub(super) fn lists(&self) -> impl Iterator<Item = (usize, usize)> {
        let Samples { chunks, records, planes, sub_cells, patches, codes, .. } = self;
        [
            (7, size_of::<u64>()),
            (chunks.len(), 7 * size_of::<u32>()),
            (records.len(), Record::BYTES),
            (planes.len(), Plane::BYTES),
            (sub_cells.len(), size_of::<u16>()),
            (patches.len(), Patch::BYTES),
            (codes.len(), 1),
        ]
        .into_iter()
    }
}

/// Reads samples whose surfaces are among `triangles` of the scene, and checks them.
///
/// # Errors
/// `from` cannot be read or ends too early, or the samples are not valid.
pub fn read_samples(from: &mut impl Read, triangles: u32) -> Result<Samples, SalfFileError> {
    let mut counts = [0; 7];
    for count in &mut counts {
        *count = u64::from_le_bytes(bytes(from)?);
    }
    let [chunks, records, planes, sub_cells, patches, codes, loose] = counts;
    if counts.iter().any(|&count| count > u64::from(u32::MAX)) {
        return Err(SalfFileError::Damaged(format!("{records} samples")));
    }
    let samples = Samples {
        chunks: read_many(from, chunks, read_chunk)?,
        records: read_many(from, records, |from| Ok(Record::from_bytes(bytes(from)?)))?,
        planes: read_many(from, planes, |from| Ok(Plane::from_bytes(bytes(from)?)))?,
        sub_cells: read_many(from, sub_cells, |from| Ok(u16::from_le_bytes(bytes(from)?)))?,
        patches: read_many(from, patches, |from| Ok(Patch::from_bytes(bytes(from)?)))?,
        codes: read_codes(from, codes)?,
        loose: read_many(from, loose, read_sample)?,
    };
    samples.check(triangles).map_err(SalfFileError::Damaged)?;
    Ok(samples)
}

fn read_many<R: Read, T>(
    from: &mut R,
    count: u64,
    mut read: impl FnMut(&mut R) -> Result<T, SalfFileError>,
) -> Result<Vec<T>, SalfFileError> {
    let mut all = Vec::with_capacity(count.min(FIRST_CAPACITY) as usize);
    for _ in 0..count {
        all.push(read(from)?);
    }
    all.shrink_to_fit();
    Ok(all)
}

fn read_codes(from: &mut impl Read, count: u64) -> Result<Vec<u8>, SalfFileError> {
    let mut codes = Vec::new();
    from.take(count).read_to_end(&mut codes)?;
    if (codes.len() as u64) < count { Err(SalfFileError::CutShort) } else { Ok(codes) }
}

fn read_chunk(from: &mut impl Read) -> Result<Chunk, SalfFileError> {
    let [x, y] = [i32::from_le_bytes(bytes(from)?), i32::from_le_bytes(bytes(from)?)];
    let mut at = [0; 5];
    for at in &mut at {
        *at = u32::from_le_bytes(bytes(from)?);
    }
    let [records, planes, sub_cells, patches, codes] = at;
    Ok(Chunk { corner: IVec2::new(x, y), starts: Starts { records, planes, sub_cells, patches, codes } })
}

fn write_sample(to: &mut impl Write, sample: &Sample) -> io::Result<()> {
    let Sample { center, half_size, inverse_depth, weight, tilt, radiance, surface, is_carried, visibility } =
        sample;
    write_f32s(to, &[center.x, center.y, half_size.x, half_size.y, *inverse_depth, *weight, tilt.x, tilt.y])?;
    write_f32s(to, &radiance.to_array())?;
    match surface {
        None => to.write_all(&BACKGROUND.to_le_bytes())?,
        Some(point) => {
            to.write_all(&point.triangle.to_le_bytes())?;
            write_f64s(to, &point.barycentric.to_array())?;
        }
    }
    let carried = if *is_carried { CARRIED } else { 0 };
    match visibility {
        Visibility::Open => to.write_all(&[carried]),
        Visibility::Cells { words } => {
            to.write_all(&[words.len() as u8 | carried])?;
            words.iter().try_for_each(|word| to.write_all(&word.to_le_bytes()))
        }
    }
}

fn read_sample(from: &mut impl Read) -> Result<Sample, SalfFileError> {
    let [cx, cy, hx, hy, inverse_depth, weight, tx, ty, r, g, b] = read_f32s(from)?;
    let surface = match u32::from_le_bytes(bytes(from)?) {
        BACKGROUND => None,
        triangle => {
            let barycentric = DVec2::from_array(read_f64s(from)?);
            Some(SurfacePoint { triangle, barycentric })
        }
    };
    let [flags] = bytes(from)?;
    let visibility = match flags & !CARRIED {
        0 => Visibility::Open,
        count @ (1 | 4) => {
            let words = (0..count).map(|_| Ok(u64::from_le_bytes(bytes(from)?)));
            Visibility::Cells { words: words.collect::<Result<_, SalfFileError>>()? }
        }
        count => return Err(SalfFileError::Damaged(format!("{count} words of visibility"))),
    };
    let finite = [cx, cy, hx, hy, inverse_depth, weight, tx, ty, r, g, b].iter().all(|x| x.is_finite());
    let addressed = surface.is_none_or(|point| point.barycentric.is_finite());
    if !(finite && addressed) {
        return Err(SalfFileError::Damaged("a sample that is not finite".into()));
    }
    Ok(Sample {
        center: Vec2::new(cx, cy),
        half_size: Vec2::new(hx, hy),
        inverse_depth,
        weight,
        tilt: Vec2::new(tx, ty),
        radiance: Vec3::new(r, g, b),
        surface,
        is_carried: flags & CARRIED != 0,
        visibility,
    })
}
