//! Reading packed samples: a run of them in order, or the surface addresses of any.

use crate::sample::{Address, Sample, Visibility};
use crate::samples::arrays::{Samples, Starts};
use crate::samples::masks::MaskReader;
use crate::samples::plane::Plane;
use crate::samples::record::{Kind, Record, Shape};
use glam::{DVec2, IVec2, Vec2};
use rayon::prelude::*;
use std::ops::Range;

/// Samples that are not packed go in runs of this many.
const LOOSE_RUN: usize = 1024;

/// Where a sample is: in the picture, in depth and on the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleLocation {
    /// See [`Sample::center`].
    pub center: Vec2,
    /// See [`Sample::inverse_depth`].
    pub inverse_depth: f32,
    /// See [`Sample::surface`] and [`Sample::is_carried`].
    pub address: Address,
}

/// Samples that follow each other: of one block of the picture, or those that are not packed.
#[derive(Clone, Debug)]
pub struct Run<'a> {
    samples: &'a Samples,
    /// None for those that are not packed.
    chunk: Option<usize>,
    /// The numbers of its samples.
    pub indices: Range<u32>,
}

impl SampleLocation {
    pub(super) fn from_sample(sample: &Sample) -> Self {
        let address = sample.address();
        Self { center: sample.center, inverse_depth: sample.inverse_depth, address }
    }
}

/// Looks up surface addresses, quickly where one sample is of the same block as the one before.
pub struct Addresses<'a> {
    samples: &'a Samples,
    run: Option<Run<'a>>,
}

impl Addresses<'_> {
    /// The address of the sample with this number: the surface point and the kind of light.
    #[inline]
    pub fn get(&mut self, index: u32) -> Address {
        let samples = self.samples;
        let Some(record) = samples.records.get(index as usize) else {
            return SampleLocation::from_sample(&samples.loose[index as usize - samples.records.len()])
                .address;
        };
        let run = match &self.run {
            Some(run) if run.indices.contains(&index) => run,
            _ => self.run.insert(samples.run(samples.run_of(index))),
        };
        let surface = run.chunk.and_then(|chunk| samples.surface_of(chunk, record));
        Address { surface, is_carried: record.is_carried() }
    }
}

impl<'a> Run<'a> {
    /// A pixel of its block; `None` if its samples lie anywhere.
    pub(crate) fn block(&self) -> Option<IVec2> {
        self.chunk.map(|chunk| self.samples.chunks[chunk].corner)
    }

    /// The locations of its samples, in order; visibility is not decoded.
    pub fn locations(&self) -> impl Iterator<Item = SampleLocation> + use<'a> {
        let mut decoder = self.chunk.map(|chunk| Decoder::new(self.samples, chunk));
        let packed = self.records().iter().filter_map(move |record| {
            let decoder = decoder.as_mut()?;
            let spot = decoder.location(record);
            decoder.pass(record);
            Some(spot)
        });
        packed.chain(self.loose().iter().map(SampleLocation::from_sample))
    }

    /// The sample of this number. What others its visibility was coded with are decoded, too.
    fn sample(&self, index: u32) -> Option<Sample> {
        let place = (index - self.indices.start) as usize;
        if let Some(loose) = self.loose().get(place) {
            return Some(loose.clone());
        }
        self.iter().nth(place)
    }

    /// Where the sample of this number is.
    fn location(&self, index: u32) -> Option<SampleLocation> {
        let place = (index - self.indices.start) as usize;
        let Some(chunk) = self.chunk else { return self.loose().get(place).map(SampleLocation::from_sample) };
        let mut decoder = Decoder::new(self.samples, chunk);
        let (before, from_here) = self.records().split_at(place);
        before.iter().for_each(|record| decoder.pass(record));
        Some(decoder.location(from_here.first()?))
    }

    /// Its samples, in order, decoded one by one.
    pub fn iter(&self) -> impl Iterator<Item = Sample> + use<'a> {
        let mut decoder =
            self.chunk.map(|chunk| (Decoder::new(self.samples, chunk), self.samples.masks(chunk)));
        let packed = self.records().iter().filter_map(move |record| {
            let (decoder, masks) = decoder.as_mut()?;
            let visibility = match record.kind().cells {
                None => Visibility::Open,
                Some(side) => Visibility::Cells { words: masks.read(side.into()) },
            };
            let sample = decoder.sample(record, visibility);
            decoder.pass(record);
            Some(sample)
        });
        packed.chain(self.loose().iter().cloned())
    }

    /// Those that are packed: all or none.
    fn records(&self) -> &'a [Record] {
        let [start, end] = [self.indices.start, self.indices.end].map(|index| index as usize);
        if self.chunk.is_some() { &self.samples.records[start..end] } else { &[] }
    }

    /// Those that are not.
    fn loose(&self) -> &'a [Sample] {
        let first = self.samples.records.len();
        if self.chunk.is_some() {
            return &[];
        }
        &self.samples.loose[self.indices.start as usize - first..self.indices.end as usize - first]
    }
}

impl Samples {
    /// The number of runs that all samples make up.
    pub fn run_count(&self) -> usize {
        self.chunks.len() + self.loose.len().div_ceil(LOOSE_RUN)
    }

    /// The run with this number; together, in order, the runs have all samples in order.
    pub fn run(&self, run: usize) -> Run<'_> {
        if run < self.chunks.len() {
            let [start, end] = [run, run + 1].map(|chunk| self.starts(chunk).records);
            return Run { samples: self, chunk: Some(run), indices: start..end };
        }
        let [start, end] = [0, 1].map(|k| (run - self.chunks.len() + k) * LOOSE_RUN);
        let [start, end] = [start, end.min(self.loose.len())].map(|k| (self.records.len() + k) as u32);
        Run { samples: self, chunk: None, indices: start..end }
    }

    /// All runs, in order.
    pub fn runs(&self) -> impl Iterator<Item = Run<'_>> {
        (0..self.run_count()).map(|run| self.run(run))
    }

    /// All samples, unpacked, in order.
    pub fn iter(&self) -> impl Iterator<Item = Sample> {
        self.runs().flat_map(|run| run.iter())
    }

    /// All samples, unpacked, in order.
    pub fn to_vec(&self) -> Vec<Sample> {
        (0..self.run_count()).into_par_iter().flat_map_iter(|run| self.run(run).iter()).collect()
    }

    /// The samples with `change` made to each of them; the result is not packed.
    pub fn changed(&self, mut change: impl FnMut(&mut Sample)) -> Self {
        let mut samples = self.to_vec();
        samples.iter_mut().for_each(&mut change);
        Self::from(samples)
    }

    /// A sample. Decodes the visibility of samples before it, too: to read many, use runs.
    pub fn get(&self, index: u32) -> Sample {
        self.run(self.run_of(index)).sample(index).expect("the run that holds it")
    }

    /// Where the sample with this number lies in the picture and on the surface.
    pub fn location(&self, index: u32) -> SampleLocation {
        self.run(self.run_of(index)).location(index).expect("the run that holds it")
    }

    /// The surface addresses of samples.
    pub fn addresses(&self) -> Addresses<'_> {
        Addresses { samples: self, run: None }
    }

    fn run_of(&self, index: u32) -> usize {
        match (index as usize).checked_sub(self.records.len()) {
            Some(loose) => self.chunks.len() + loose / LOOSE_RUN,
            None => self.chunks.partition_point(|chunk| chunk.starts.records <= index) - 1,
        }
    }

    fn masks(&self, chunk: usize) -> MaskReader<'_> {
        let [start, end] = [chunk, chunk + 1].map(|chunk| self.starts(chunk).codes as usize);
        MaskReader::new(&self.codes[start..end])
    }
}

/// Unpacks the records of a chunk, one after the other.
struct Decoder<'a> {
    samples: &'a Samples,
    chunk: usize,
    /// The position of the next record's data beside it.
    sub_cells: usize,
    patches: usize,
}

impl<'a> Decoder<'a> {
    fn new(samples: &'a Samples, chunk: usize) -> Self {
        let Starts { sub_cells, patches, .. } = samples.chunks[chunk].starts;
        Self { samples, chunk, sub_cells: sub_cells as usize, patches: patches as usize }
    }

    /// Goes on behind a record.
    fn pass(&mut self, record: &Record) {
        let shape = record.kind().shape;
        self.sub_cells += shape.words();
        self.patches += usize::from(shape == Shape::Patch);
    }

    fn corner(&self) -> IVec2 {
        self.samples.chunks[self.chunk].corner
    }

    /// Centre and half the sides of the footprint, and the scale of the weights.
    fn footprint(&self, kind: Kind) -> [Vec2; 3] {
        let of_cell = |sub_cells: u64| {
            let part = kind.cell(self.corner()).part(sub_cells);
            [part.center, part.half_size, DVec2::splat(part.weight)].map(|value| value.as_vec2())
        };
        let word = |k: usize| u64::from(self.samples.sub_cells[self.sub_cells + k]);
        match kind.shape {
            Shape::WholeCell | Shape::Splat => of_cell(u64::MAX),
            Shape::PartOfCell => of_cell((0..4).fold(0, |all, k| all | word(k) << (16 * k))),
            Shape::PartOfQuadrant(quadrant) => of_cell(word(0) << (16 * quadrant)),
            Shape::Patch => {
                let patch = &self.samples.patches[self.patches];
                let center = (self.corner() + kind.pixel).as_vec2() + patch.fraction();
                [center, patch.half_size(), Vec2::splat(patch.largest.get())]
            }
        }
    }

    fn location(&self, record: &Record) -> SampleLocation {
        SampleLocation {
            center: self.footprint(record.kind())[0],
            inverse_depth: record.inverse_depth.get(),
            address: Address {
                surface: self.samples.surface_of(self.chunk, record),
                is_carried: record.is_carried(),
            },
        }
    }

    fn sample(&self, record: &Record, visibility: Visibility) -> Sample {
        let [center, half_size, Vec2 { x: scale, .. }] = self.footprint(record.kind());
        let weights = match record.splat() {
            Some((_, weight)) => [weight, 0.0, 0.0],
            None => self.samples.plane_of(self.chunk, record).map_or([1.0, 0.0, 0.0], Plane::weights),
        };
        let [weight, tilt_x, tilt_y] = weights.map(|weight| scale * weight);
        Sample {
            center,
            half_size,
            inverse_depth: record.inverse_depth.get(),
            weight,
            tilt: Vec2::new(tilt_x, tilt_y),
            radiance: record.radiance.get(),
            surface: self.samples.surface_of(self.chunk, record),
            is_carried: record.is_carried(),
            visibility,
        }
    }
}
