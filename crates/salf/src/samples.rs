//! The samples of a light field, packed to what tells them apart.
//!
//! A [`Sample`] takes a hundred bytes and more. Packed, a group of rays of a cell of the picture takes 16 bytes: which cell
//! of which block, the plane it lies on (a number among those of its block), its surface address, depth and radiance. Where
//! its footprint is and what it weighs follows from the cell and the rays ([`crate::Cell::part`]), how its weight changes over the
//! aperture from the plane. A patch of surface takes 10 bytes more, a partly visible aperture about 4 ([`masks`]). What does
//! not fit such a form, like a radiance of 2⁶⁴, is kept as it is.
//!
//! What is lost: depths are exact to 2⁻¹⁷ of themselves, radiances to 2⁻¹⁰ of their largest channel, addresses to 1/65535 of
//! their triangle, weights over the aperture to 2⁻¹¹ beside its centre; places of patches to 1/4096 px. Footprints and
//! weights of groups of rays, and visibility, are exact.

mod masks;
mod numbers;
mod pack;
mod record;

use crate::sample::{Sample, Visibility};
use glam::{DVec2, IVec2, Vec2};
use half::f16;
use masks::MaskReader;
pub(crate) use pack::{Found, Packer, block_corner};
use rayon::prelude::*;
use record::{Kind, Shape};
pub(crate) use record::{Patch, Record};
use scene::SurfacePoint;
use std::ops::Range;

/// The samples of a light field, numbered from 0.
///
/// Those of a block of the picture follow each other, in one run or several.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Samples {
    pub(crate) chunks: Vec<Chunk>,
    pub(crate) records: Vec<Record>,
    pub(crate) planes: Vec<Plane>,
    /// Which rays of a cell a group of some is.
    pub(crate) rays: Vec<u16>,
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
    pub rays: u32,
    pub patches: u32,
    pub codes: u32,
}

/// A triangle, and how the weight of what lies on it changes over the aperture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(C, packed(2))]
pub(crate) struct Plane {
    pub triangle: u32,
    /// Toward the aperture's centre, and its change with u and v, as half floats: for groups of rays as a share of their
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

/// Where a sample is: in the picture, in depth and on the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// See [`Sample::center`].
    pub center: Vec2,
    /// See [`Sample::inverse_depth`].
    pub inverse_depth: f32,
    /// See [`Sample::surface`].
    pub surface: Option<SurfacePoint>,
}

/// Samples that follow each other: of one block of the picture, or those that are not packed.
#[derive(Clone, Debug)]
pub struct Run<'a> {
    samples: &'a Samples,
    chunk: Option<usize>,
    /// The numbers of its samples.
    pub indices: Range<u32>,
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
        self.runs().flat_map(|run| run.samples())
    }

    /// Every sample, not packed.
    pub fn to_vec(&self) -> Vec<Sample> {
        (0..self.run_count()).into_par_iter().flat_map_iter(|run| self.run(run).samples()).collect()
    }

    /// The samples with `change` made to each of them; they are not packed then.
    pub fn changed(&self, mut change: impl FnMut(&mut Sample)) -> Self {
        let mut samples = self.to_vec();
        samples.iter_mut().for_each(&mut change);
        Self::from(samples)
    }

    /// A sample. What others its visibility was coded with are decoded, too: for many samples ask for their runs.
    pub fn get(&self, index: u32) -> Sample {
        let run = self.run(self.run_of(index));
        if run.chunk.is_none() {
            return self.loose[index as usize - self.records.len()].clone();
        }
        let place = (index - run.indices.start) as usize;
        run.iter().nth(place).expect("the run that holds it")
    }

    /// Where a sample is.
    pub fn spot(&self, index: u32) -> Spot {
        let run = self.run(self.run_of(index));
        let Some(chunk) = run.chunk else {
            return Spot::of(&self.loose[index as usize - self.records.len()]);
        };
        let mut decoder = Decoder::new(self, chunk);
        self.records[run.indices.start as usize..index as usize]
            .iter()
            .for_each(|record| decoder.pass(record));
        decoder.spot(&self.records[index as usize])
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
            + size_of_val(&*self.rays)
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
        all.rays.reserve_exact(sum(|part| part.rays.len()));
        all.patches.reserve_exact(sum(|part| part.patches.len()));
        all.codes.reserve_exact(sum(|part| part.codes.len()));
        all.loose.reserve_exact(sum(|part| part.loose.len()));
        for part in parts {
            let before = all.ends();
            all.chunks.extend(part.chunks.iter().map(|chunk| chunk.after(before)));
            all.records.extend(part.records);
            all.planes.extend(part.planes);
            all.rays.extend(part.rays);
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
            (start.rays, end.rays, all.rays),
            (start.patches, end.patches, all.patches),
            (start.codes, end.codes, all.codes),
        ];
        if parts.iter().any(|(start, end, all)| start > end || end > all) {
            return Err(wrong());
        }
        let corner = self.chunks[chunk].corner;
        let is_far =
            corner.cmplt(IVec2::splat(-FARTHEST)).any() || corner.cmpgt(IVec2::splat(FARTHEST)).any();
        let (mut rays, mut patches) = (0, 0);
        for record in &self.records[start.records as usize..end.records as usize] {
            let of_plane = u32::from(record.plane) < end.planes - start.planes;
            let is_background = record.plane == Record::BACKGROUND;
            match record.kind().shape {
                Shape::Patch if is_background => return Err(wrong()),
                Shape::Patch => patches += 1,
                Shape::PartOfCell => rays += 1,
                Shape::WholeCell => {}
            }
            if !(of_plane || is_background) {
                return Err(wrong());
            }
        }
        let is_whole = rays == end.rays - start.rays && patches == end.patches - start.patches;
        let has_empty = self.rays[start.rays as usize..end.rays as usize].contains(&0);
        if is_far || !is_whole || has_empty { Err(wrong()) } else { Ok(()) }
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
            rays: place(self.rays.len()),
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
        let Starts { records, planes, rays, patches, codes } = self.starts;
        let starts = Starts {
            records: before.records + records,
            planes: before.planes + planes,
            rays: before.rays + rays,
            patches: before.patches + patches,
            codes: before.codes + codes,
        };
        Self { starts, ..*self }
    }
}

impl Spot {
    fn of(sample: &Sample) -> Self {
        Self { center: sample.center, inverse_depth: sample.inverse_depth, surface: sample.surface }
    }
}

/// Looks up surface addresses, quickly where one sample is of the same block as the one before.
pub struct Addresses<'a> {
    samples: &'a Samples,
    run: Option<Run<'a>>,
}

impl Addresses<'_> {
    /// The surface address of a sample; `None` for the background.
    #[inline]
    pub fn of(&mut self, index: u32) -> Option<SurfacePoint> {
        let samples = self.samples;
        let Some(record) = samples.records.get(index as usize) else {
            return samples.loose[index as usize - samples.records.len()].surface;
        };
        let run = match &self.run {
            Some(run) if run.indices.contains(&index) => run,
            _ => self.run.insert(samples.run(samples.run_of(index))),
        };
        samples.surface_of(run.chunk?, record)
    }
}

impl<'a> Run<'a> {
    /// A pixel of its block; `None` if its samples lie anywhere.
    pub(crate) fn block(&self) -> Option<IVec2> {
        self.chunk.map(|chunk| self.samples.chunks[chunk].corner)
    }

    /// Its samples, in order.
    pub fn samples(&self) -> Vec<Sample> {
        self.iter().collect()
    }

    /// Where its samples are, in order; what they see is not decoded.
    pub fn spots(&self) -> impl Iterator<Item = Spot> + use<'a> {
        let mut decoder = self.chunk.map(|chunk| Decoder::new(self.samples, chunk));
        let loose = if decoder.is_some() { &[] } else { self.loose() };
        let records = if decoder.is_some() { self.records() } else { &[] };
        let packed = records.iter().filter_map(move |record| {
            let decoder = decoder.as_mut()?;
            let spot = decoder.spot(record);
            decoder.pass(record);
            Some(spot)
        });
        packed.chain(loose.iter().map(Spot::of))
    }

    fn iter(&self) -> impl Iterator<Item = Sample> + use<'a> {
        let mut decoder =
            self.chunk.map(|chunk| (Decoder::new(self.samples, chunk), self.samples.masks(chunk)));
        let loose = if decoder.is_some() { &[] } else { self.loose() };
        let records = if decoder.is_some() { self.records() } else { &[] };
        let packed = records.iter().filter_map(move |record| {
            let (decoder, masks) = decoder.as_mut()?;
            let visibility = match record.kind().cells {
                None => Visibility::Open,
                Some(side) => Visibility::Cells { words: masks.read(side.into()) },
            };
            let sample = decoder.sample(record, visibility);
            decoder.pass(record);
            Some(sample)
        });
        packed.chain(loose.iter().cloned())
    }

    fn records(&self) -> &'a [Record] {
        &self.samples.records[self.indices.start as usize..self.indices.end as usize]
    }

    fn loose(&self) -> &'a [Sample] {
        let first = self.samples.records.len();
        &self.samples.loose[self.indices.start as usize - first..self.indices.end as usize - first]
    }
}

impl Samples {
    fn masks(&self, chunk: usize) -> MaskReader<'_> {
        let [start, end] = [chunk, chunk + 1].map(|chunk| self.starts(chunk).codes as usize);
        MaskReader::new(&self.codes[start..end])
    }
}

/// Unpacks the records of a chunk, one after the other.
struct Decoder<'a> {
    samples: &'a Samples,
    chunk: usize,
    /// Where the next record finds what is told beside it.
    rays: usize,
    patches: usize,
}

impl<'a> Decoder<'a> {
    fn new(samples: &'a Samples, chunk: usize) -> Self {
        let Starts { rays, patches, .. } = samples.chunks[chunk].starts;
        Self { samples, chunk, rays: rays as usize, patches: patches as usize }
    }

    /// Goes on behind a record.
    fn pass(&mut self, record: &Record) {
        match record.kind().shape {
            Shape::WholeCell => {}
            Shape::PartOfCell => self.rays += 1,
            Shape::Patch => self.patches += 1,
        }
    }

    fn corner(&self) -> IVec2 {
        self.samples.chunks[self.chunk].corner
    }

    /// Centre and half the sides of the footprint, and the scale of the weights.
    fn footprint(&self, kind: Kind) -> [Vec2; 3] {
        let of_cell = |rays: u16| {
            let part = kind.cell(self.corner()).part(rays);
            [part.center, part.half_size, DVec2::splat(part.weight)].map(|value| value.as_vec2())
        };
        match kind.shape {
            Shape::WholeCell => of_cell(u16::MAX),
            Shape::PartOfCell => of_cell(self.samples.rays[self.rays]),
            Shape::Patch => {
                let patch = &self.samples.patches[self.patches];
                let center = (self.corner() + kind.pixel).as_vec2() + patch.fraction();
                [center, patch.half_size(), Vec2::splat(patch.largest.get())]
            }
        }
    }

    fn spot(&self, record: &Record) -> Spot {
        Spot {
            center: self.footprint(record.kind())[0],
            inverse_depth: record.inverse_depth.get(),
            surface: self.samples.surface_of(self.chunk, record),
        }
    }

    fn sample(&self, record: &Record, visibility: Visibility) -> Sample {
        let [center, half_size, Vec2 { x: scale, .. }] = self.footprint(record.kind());
        let weights = self.samples.plane_of(self.chunk, record).map_or([1.0, 0.0, 0.0], Plane::weights);
        let [weight, tilt_x, tilt_y] = weights.map(|weight| scale * weight);
        Sample {
            center,
            half_size,
            inverse_depth: record.inverse_depth.get(),
            weight,
            tilt: Vec2::new(tilt_x, tilt_y),
            radiance: record.radiance.get(),
            surface: self.samples.surface_of(self.chunk, record),
            visibility,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::Cell;
    use crate::jitter::jitter;
    use glam::{DVec2, Vec3};

    /// Groups of rays of cells of all sizes, patches of surface and the background, in one block.
    fn found(count: u32) -> Vec<Found> {
        (0..count)
            .map(|k| {
                let [a, b, c] = jitter(k, 1, 2).map(|x| x as f32);
                let side = 1 << (k % 5);
                let corner = IVec2::new(32, -16) + IVec2::new(k as i32, k as i32 / 3) % (16 / side) * side;
                let cell = Cell { corner, side };
                let rays = if k % 3 == 0 { u16::MAX } else { 1 | (k * 0x9E37) as u16 };
                let (is_patch, is_background) = (k % 7 == 6, k % 11 == 5);
                let part = cell.part(rays);
                let point =
                    SurfacePoint { triangle: k / 4, barycentric: DVec2::new(a.into(), (1.0 - a).into()) };
                let word = u64::from(k).wrapping_mul(0x9E37_79B9_7F4A_7C15);
                let visibility = match k % 4 {
                    0 => Visibility::Open,
                    1 => Visibility::Cells { words: [word].into() },
                    _ => Visibility::Cells { words: [word, 0, u64::MAX, word >> 9].into() },
                };
                let weight = part.weight as f32;
                let mut sample = Sample {
                    center: part.center.as_vec2(),
                    half_size: part.half_size.as_vec2(),
                    inverse_depth: b,
                    weight,
                    tilt: Vec2::new(b - 0.5, c) * weight,
                    radiance: Vec3::new(a, b, c) * 3.0,
                    surface: Some(point),
                    visibility,
                };
                if is_patch {
                    sample.center = corner.as_vec2() + Vec2::new(a, b);
                    (sample.weight, sample.half_size) = (-0.1, Vec2::new(b + 0.1, 0.5));
                } else if is_background {
                    (sample.surface, sample.tilt, sample.inverse_depth) = (None, Vec2::ZERO, 0.0);
                }
                Found { sample, rays: (!is_patch).then_some((cell, rays)) }
            })
            .collect()
    }

    fn packed(found: &[Found]) -> Samples {
        let mut packer = Packer::new(IVec2::new(32, -16));
        found.iter().for_each(|found| packer.push(found.clone()));
        packer.finish()
    }

    fn assert_alike(found: &Sample, wanted: &Sample) {
        let scale = wanted.weight.abs().max(wanted.tilt.abs().max_element());
        let weights =
            Vec3::new(found.weight - wanted.weight, 0.0, 0.0) + (found.tilt - wanted.tilt).extend(0.0);
        assert!(weights.abs().max_element() <= 1e-3 * scale, "{found:?} for {wanted:?}");
        assert!((found.inverse_depth - wanted.inverse_depth).abs() <= 8e-6 * wanted.inverse_depth);
        assert!((found.radiance - wanted.radiance).abs().max_element() < 2e-3);
        assert!((found.center - wanted.center).abs().max_element() <= 2.5e-4);
        assert!((found.half_size - wanted.half_size).abs().max_element() <= 1.3e-4);
        assert_eq!(found.visibility, wanted.visibility);
        match (found.surface, wanted.surface) {
            (Some(a), Some(b)) => {
                assert_eq!(a.triangle, b.triangle);
                assert!((a.barycentric - b.barycentric).abs().max_element() < 1e-5);
            }
            (a, b) => assert_eq!(a, b),
        }
    }

    #[test]
    fn packed_samples_are_what_they_were() {
        let found = found(3000);
        let samples = packed(&found);
        assert_eq!((samples.len(), samples.loose.len()), (3000, 0));
        assert_eq!(samples.check(3000), Ok(()));
        let mut addresses = samples.addresses();
        for (index, (sample, wanted)) in samples.iter().zip(&found).enumerate() {
            assert_alike(&sample, &wanted.sample);
            if wanted.rays.is_some() {
                let exact = |s: &Sample| (s.center, s.half_size, s.weight);
                assert_eq!(exact(&sample), exact(&wanted.sample));
            }
            if index % 97 == 0 {
                assert_eq!(samples.get(index as u32), sample);
                assert_eq!(samples.spot(index as u32), Spot::of(&sample));
            }
            assert_eq!(addresses.of(index as u32), sample.surface);
        }
        let spots: Vec<_> = samples.runs().flat_map(|run| run.spots()).collect();
        assert!(spots.into_iter().eq(samples.iter().map(|sample| Spot::of(&sample))));
    }

    #[test]
    fn what_cannot_be_packed_stays_as_it_is() {
        let mut odd: Vec<Found> = found(6);
        odd[0].sample.radiance.y = 1e30;
        odd[1].sample.inverse_depth = -1.0;
        odd[2].sample.tilt.x = 1e9;
        odd[3].rays = None;
        odd[3].sample.half_size.x = 40.0;
        odd[4].rays = Some((Cell { corner: IVec2::ZERO, side: 1 }, 1));
        let samples = packed(&odd);
        assert_eq!((samples.records.len(), samples.loose.len()), (1, 5));
        let kept: Vec<Sample> = samples.iter().skip(1).collect();
        assert!(kept.iter().eq(odd[..5].iter().map(|found| &found.sample)));
        assert_eq!(samples.get(3), kept[2]);
    }

    #[test]
    fn more_planes_than_a_number_has_go_on_in_another_run() {
        let all: Vec<_> = found(70_000)
            .into_iter()
            .enumerate()
            .map(|(k, mut found)| {
                found.sample.surface = Some(SurfacePoint { triangle: k as u32, barycentric: DVec2::ZERO });
                found
            })
            .collect();
        let samples = packed(&all);
        assert_eq!((samples.run_count(), samples.len(), samples.loose.len()), (2, 70_000, 0));
        assert_eq!(samples.check(70_000), Ok(()));
        for index in [0, 65_534, 65_535, 65_536, 69_999] {
            assert_alike(&samples.get(index), &all[index as usize].sample);
        }
    }

    #[test]
    fn what_refers_to_nothing_is_told() {
        let good = packed(&found(500));
        assert!(good.check(125).is_ok() && good.check(124).is_err());
        let spoilt = |spoil: fn(&mut Samples)| {
            let mut bad = good.clone();
            spoil(&mut bad);
            bad.check(125)
        };
        assert!(spoilt(|s| s.chunks.clear()).is_err());
        assert!(spoilt(|s| s.chunks[0].starts.planes = 1).is_err());
        assert!(spoilt(|s| s.chunks[0].corner.x = i32::MIN).is_err());
        assert!(spoilt(|s| s.chunks.push(Chunk { corner: IVec2::ZERO, starts: s.ends() })).is_ok());
        assert!(spoilt(|s| s.chunks.insert(0, Chunk { starts: s.ends(), ..s.chunks[0] })).is_err());
        assert!(spoilt(|s| s.records[3].plane = 40_000).is_err());
        assert!(spoilt(|s| s.rays[0] = 0).is_err());
        assert!(spoilt(|s| s.rays.truncate(3)).is_err());
        assert!(spoilt(|s| s.patches.truncate(3)).is_err());
        assert!(spoilt(|s| s.planes[5].weights[1] = f16::NAN.to_bits()).is_err());
        assert!(spoilt(|s| s.codes.truncate(3)).is_ok(), "it is read as other visibility");
    }
}
