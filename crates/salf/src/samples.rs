//! The samples of a light field, packed to what tells them apart.
//!
//! A [`Sample`] takes a hundred bytes and more. Packed, a cell of the picture, or a part of one, takes 16 bytes: which cell
//! of which block, the plane it lies on (a number among those of its block), its surface address, depth and radiance. Where
//! its footprint is and what it weighs follows from the cell and its sub-cells ([`crate::Cell::part`]), how its weight changes over the
//! aperture from the plane. A patch of surface takes 10 bytes more, a partly visible aperture about 4 ([`masks`]). What does
//! not fit such a form, like a radiance of 2⁶⁴, is kept as it is.
//!
//! What is lost: depths are exact to 2⁻¹⁷ of themselves, radiances to 2⁻¹⁰ of their largest channel, addresses to 1/65535 of
//! their triangle, weights over the aperture to 2⁻¹¹ beside its centre; places of patches to 1/4096 px. Footprints and
//! weights of cells, and visibility, are exact.

mod masks;
mod numbers;
mod pack;
mod record;
mod run;

use crate::sample::{Sample, Visibility};
use glam::IVec2;
use half::f16;
pub(crate) use pack::{Found, Packer, block_corner};
use rayon::prelude::*;
use record::Shape;
pub(crate) use record::{Patch, Record};
pub use run::{Addresses, Run, Spot};
use scene::SurfacePoint;

/// The samples of a light field, numbered from 0.
///
/// Those of a block of the picture follow each other, in one run or several.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Samples {
    pub(crate) chunks: Vec<Chunk>,
    pub(crate) records: Vec<Record>,
    pub(crate) planes: Vec<Plane>,
    /// Which sub-cells of a cell, or of a quadrant of one, a part of it is: a word a quadrant.
    pub(crate) sub_cells: Vec<u16>,
    pub(crate) patches: Vec<Patch>,
    /// Visibility of the partly occluded ones.
    pub(crate) codes: Vec<u8>,
    /// Those that could not be packed.
    pub(crate) loose: Vec<Sample>,
}

/// Samples of one block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Chunk {
    /// Upper left corner of the block, px.
    pub corner: IVec2,
    /// Where its parts begin.
    pub starts: Starts,
}

/// Places in the arrays of [`Samples`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Starts {
    pub records: u32,
    pub planes: u32,
    pub sub_cells: u32,
    pub patches: u32,
    pub codes: u32,
}

/// A triangle, and how the weight of what lies on it changes over the aperture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(C, packed(2))]
pub(crate) struct Plane {
    pub triangle: u32,
    /// Toward the aperture's centre, and its change with u and v, as half floats: for cells as a share of their
    /// weight, for patches of their largest.
    pub weights: [u16; 3],
}

impl Plane {
    pub const BYTES: usize = size_of::<Self>();

    pub fn to_bytes(self) -> [u8; Self::BYTES] {
        let mut bytes = [0; Self::BYTES];
        bytes[..4].copy_from_slice(&{ self.triangle }.to_le_bytes());
        let weights = self.weights;
        for (place, weight) in bytes[4..].chunks_mut(2).zip(weights) {
            place.copy_from_slice(&weight.to_le_bytes());
        }
        bytes
    }

    pub fn from_bytes([a, b, c, d, w0, w1, u0, u1, v0, v1]: [u8; Self::BYTES]) -> Self {
        let weights = [[w0, w1], [u0, u1], [v0, v1]].map(u16::from_le_bytes);
        Self { triangle: u32::from_le_bytes([a, b, c, d]), weights }
    }

    fn weights(&self) -> [f32; 3] {
        { self.weights }.map(|bits| f16::from_bits(bits).to_f32())
    }
}

/// No block lies farther from the frame's corner, px.
const FARTHEST: i32 = 1 << 20;

/// Samples that are not packed go in runs of this many.
const LOOSE_RUN: usize = 1024;

impl Samples {
    /// How many there are.
    pub fn len(&self) -> usize {
        self.records.len() + self.loose.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// How many runs they go in.
    pub fn run_count(&self) -> usize {
        self.chunks.len() + self.loose.len().div_ceil(LOOSE_RUN)
    }

    /// A run of them; together, in order, the runs have all samples in order.
    pub fn run(&self, run: usize) -> Run<'_> {
        if run < self.chunks.len() {
            let [start, end] = [run, run + 1].map(|chunk| self.starts(chunk).records);
            return Run { samples: self, chunk: Some(run), indices: start..end };
        }
        let [start, end] = [0, 1].map(|k| (run - self.chunks.len() + k) * LOOSE_RUN);
        let [start, end] = [start, end.min(self.loose.len())].map(|k| (self.records.len() + k) as u32);
        Run { samples: self, chunk: None, indices: start..end }
    }

    /// The runs.
    pub fn runs(&self) -> impl Iterator<Item = Run<'_>> {
        (0..self.run_count()).map(|run| self.run(run))
    }

    /// Every sample, in order.
    pub fn iter(&self) -> impl Iterator<Item = Sample> {
        self.runs().flat_map(|run| run.iter())
    }

    /// Every sample, not packed.
    pub fn to_vec(&self) -> Vec<Sample> {
        (0..self.run_count()).into_par_iter().flat_map_iter(|run| self.run(run).iter()).collect()
    }

    /// The samples with `change` made to each of them; they are not packed then.
    pub fn changed(&self, mut change: impl FnMut(&mut Sample)) -> Self {
        let mut samples = self.to_vec();
        samples.iter_mut().for_each(&mut change);
        Self::from(samples)
    }

    /// A sample. What others its visibility was coded with are decoded, too: for many samples ask for their runs.
    pub fn get(&self, index: u32) -> Sample {
        self.run(self.run_of(index)).sample(index).expect("the run that holds it")
    }

    /// Where a sample is.
    pub fn spot(&self, index: u32) -> Spot {
        self.run(self.run_of(index)).spot(index).expect("the run that holds it")
    }

    /// The surface addresses of samples.
    pub fn addresses(&self) -> Addresses<'_> {
        Addresses { samples: self, run: None }
    }

    /// Bytes in memory, and of these what the partly occluded samples take.
    pub fn bytes(&self) -> [usize; 2] {
        let partial = |sample: &&Sample| sample.visibility != Visibility::Open;
        let loose_bytes = |sample: &Sample| match &sample.visibility {
            Visibility::Open => size_of::<Sample>(),
            Visibility::Cells { words } => size_of::<Sample>() + size_of_val(&**words),
        };
        let loose: usize = self.loose.iter().map(loose_bytes).sum();
        let loose_partial: usize = self.loose.iter().filter(partial).map(loose_bytes).sum();
        let shared = size_of_val(&*self.chunks)
            + size_of_val(&*self.planes)
            + size_of_val(&*self.sub_cells)
            + size_of_val(&*self.patches);
        let records = self.records.len();
        let partial = self.records.iter().filter(|record| record.is_partial()).count();
        let shared_partial = (shared as u128 * partial as u128 / records.max(1) as u128) as usize;
        let all = shared + records * Record::BYTES + self.codes.len() + loose;
        [all, shared_partial + partial * Record::BYTES + self.codes.len() + loose_partial]
    }

    /// How many see the whole aperture, how many part of it, and how many of all are of the background.
    pub(crate) fn counts(&self) -> [usize; 3] {
        let partial = self.records.iter().filter(|record| record.is_partial()).count()
            + self.loose.iter().filter(|sample| sample.visibility != Visibility::Open).count();
        let background = self.records.iter().filter(|record| record.plane == Record::BACKGROUND).count()
            + self.loose.iter().filter(|sample| sample.surface.is_none()).count();
        [self.len() - partial, partial, background]
    }

    /// Parts, one after the other; what is not packed comes last.
    pub(crate) fn join(parts: impl IntoIterator<Item = Self>) -> Self {
        let parts: Vec<_> = parts.into_iter().collect();
        let mut all = Self::default();
        let sum = |of: fn(&Self) -> usize| parts.iter().map(of).sum();
        all.chunks.reserve_exact(sum(|part| part.chunks.len()));
        all.records.reserve_exact(sum(|part| part.records.len()));
        all.planes.reserve_exact(sum(|part| part.planes.len()));
        all.sub_cells.reserve_exact(sum(|part| part.sub_cells.len()));
        all.patches.reserve_exact(sum(|part| part.patches.len()));
        all.codes.reserve_exact(sum(|part| part.codes.len()));
        all.loose.reserve_exact(sum(|part| part.loose.len()));
        for part in parts {
            let before = all.ends();
            all.chunks.extend(part.chunks.iter().map(|chunk| chunk.after(before)));
            all.records.extend(part.records);
            all.planes.extend(part.planes);
            all.sub_cells.extend(part.sub_cells);
            all.patches.extend(part.patches);
            all.codes.extend(part.codes);
            all.loose.extend(part.loose);
        }
        all
    }

    /// Whether all that refers to something finds it, with surfaces among `triangles`; else what does not.
    pub(crate) fn check(&self, triangles: u32) -> Result<(), String> {
        let lies_elsewhere = |triangle: u32| triangle >= triangles;
        if self.planes.iter().any(|plane| lies_elsewhere(plane.triangle))
            || self.loose.iter().any(|s| s.surface.is_some_and(|point| lies_elsewhere(point.triangle)))
        {
            return Err("a sample lies on a triangle that the scene does not have".into());
        }
        let undefined = self.planes.iter().any(|plane| !plane.weights().iter().all(|w| w.is_finite()))
            || self.patches.iter().any(|patch| !patch.largest.get().is_finite());
        if undefined || !self.records.iter().all(Record::is_sound) {
            return Err("a sample that makes no sense".into());
        }
        if self.chunks.is_empty() != self.records.is_empty()
            || self.chunks.first().is_some_and(|chunk| chunk.starts != Starts::default())
        {
            return Err("samples of no block".into());
        }
        (0..self.chunks.len()).try_for_each(|chunk| self.check_chunk(chunk))
    }

    fn check_chunk(&self, chunk: usize) -> Result<(), String> {
        let wrong = || format!("block {chunk} of the light field");
        let (start, end, all) = (self.starts(chunk), self.starts(chunk + 1), self.ends());
        let parts = [
            (start.records, end.records, all.records),
            (start.planes, end.planes, all.planes),
            (start.sub_cells, end.sub_cells, all.sub_cells),
            (start.patches, end.patches, all.patches),
            (start.codes, end.codes, all.codes),
        ];
        if parts.iter().any(|(start, end, all)| start > end || end > all) {
            return Err(wrong());
        }
        let corner = self.chunks[chunk].corner;
        let is_far =
            corner.cmplt(IVec2::splat(-FARTHEST)).any() || corner.cmpgt(IVec2::splat(FARTHEST)).any();
        let mut patches = 0;
        let mut sub_cells = &self.sub_cells[start.sub_cells as usize..end.sub_cells as usize];
        for record in &self.records[start.records as usize..end.records as usize] {
            let of_plane = u32::from(record.plane) < end.planes - start.planes;
            let is_background = record.plane == Record::BACKGROUND;
            let shape = record.kind().shape;
            let is_patch = shape == Shape::Patch;
            patches += u32::from(is_patch);
            let (words, others) = sub_cells.split_at_checked(shape.words()).ok_or_else(wrong)?;
            sub_cells = others;
            let is_empty = shape.words() > 0 && words.iter().all(|&word| word == 0);
            if !(of_plane || is_background && !is_patch) || is_empty {
                return Err(wrong());
            }
        }
        let is_whole = sub_cells.is_empty() && patches == end.patches - start.patches;
        if is_far || !is_whole { Err(wrong()) } else { Ok(()) }
    }

    /// Where the parts of a chunk start, or behind the last one end.
    fn starts(&self, chunk: usize) -> Starts {
        self.chunks.get(chunk).map_or_else(|| self.ends(), |chunk| chunk.starts)
    }

    fn ends(&self) -> Starts {
        let place = |length: usize| u32::try_from(length).expect("fewer than 2³² samples");
        Starts {
            records: place(self.records.len()),
            planes: place(self.planes.len()),
            sub_cells: place(self.sub_cells.len()),
            patches: place(self.patches.len()),
            codes: place(self.codes.len()),
        }
    }

    fn run_of(&self, index: u32) -> usize {
        match (index as usize).checked_sub(self.records.len()) {
            Some(loose) => self.chunks.len() + loose / LOOSE_RUN,
            None => self.chunks.partition_point(|chunk| chunk.starts.records <= index) - 1,
        }
    }

    fn plane_of(&self, chunk: usize, record: &Record) -> Option<&Plane> {
        let first = self.chunks[chunk].starts.planes as usize;
        (record.plane != Record::BACKGROUND).then(|| &self.planes[first + record.plane as usize])
    }

    fn surface_of(&self, chunk: usize, record: &Record) -> Option<SurfacePoint> {
        let plane = self.plane_of(chunk, record)?;
        Some(SurfacePoint { triangle: plane.triangle, barycentric: record.barycentric() })
    }
}

impl FromIterator<Sample> for Samples {
    /// Samples as they are, not packed.
    fn from_iter<I: IntoIterator<Item = Sample>>(samples: I) -> Self {
        Self::from(samples.into_iter().collect::<Vec<_>>())
    }
}

impl From<Vec<Sample>> for Samples {
    /// Samples as they are, not packed.
    fn from(loose: Vec<Sample>) -> Self {
        Self { loose, ..Self::default() }
    }
}

impl Chunk {
    fn after(&self, before: Starts) -> Self {
        let Starts { records, planes, sub_cells, patches, codes } = self.starts;
        let starts = Starts {
            records: before.records + records,
            planes: before.planes + planes,
            sub_cells: before.sub_cells + sub_cells,
            patches: before.patches + patches,
            codes: before.codes + codes,
        };
        Self { starts, ..*self }
    }
}

#[cfg(test)]
mod tests;
