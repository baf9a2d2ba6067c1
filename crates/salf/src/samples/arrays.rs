//! The arrays that samples lie in.

use crate::jitter::jitter;
use crate::light_change::LightChange;
use crate::sample::{Sample, Visibility};
use crate::samples::numbers::Rgb40;
use crate::samples::plane::Plane;
use crate::samples::record::{Patch, Record};
use glam::{DVec2, IVec2};
use surface::SurfacePoint;

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

impl Samples {
    /// The number of samples.
    pub fn len(&self) -> usize {
        self.records.len() + self.loose.len()
    }

    /// Whether there are no samples.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Whether some of its records are of splats.
    pub(crate) fn has_splats(&self) -> bool {
        self.records.iter().any(Record::is_splat)
    }

    /// Bytes of memory of all samples, and of these what partly occluded samples take.
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

    /// The numbers of samples that see the whole aperture, that see part of it, that are background, and that are carried.
    pub(crate) fn counts(&self) -> [usize; 4] {
        let partial = self.records.iter().filter(|record| record.is_partial()).count()
            + self.loose.iter().filter(|sample| sample.visibility != Visibility::Open).count();
        let of_chunks = (0..self.chunks.len()).map(|chunk| {
            let [start, end] = [chunk, chunk + 1].map(|chunk| self.starts(chunk).records as usize);
            self.records[start..end].iter().filter(|record| self.surface_of(chunk, record).is_none()).count()
        });
        let background =
            of_chunks.sum::<usize>() + self.loose.iter().filter(|sample| sample.surface.is_none()).count();
        let carried = self.records.iter().filter(|record| record.is_carried()).count()
            + self.loose.iter().filter(|sample| sample.is_carried).count();
        [self.len() - partial, partial, background, carried]
    }

    /// The same samples in `light`; `None` if a radiance is too large to be stored.
    pub(crate) fn in_light(&self, light: &LightChange) -> Option<Self> {
        let mut samples = self.clone();
        for chunk in 0..self.chunks.len() {
            let [start, end] = [chunk, chunk + 1].map(|chunk| self.starts(chunk).records as usize);
            for (index, record) in (start..end).zip(&mut samples.records[start..end]) {
                let is_background = self.surface_of(chunk, record).is_none();
                if light.changes(is_background) {
                    let radiance = light.changed(record.radiance.get(), is_background);
                    record.radiance = Rgb40::new(radiance, jitter(chunk as u32, index as u32, 0))?;
                }
            }
        }
        for sample in &mut samples.loose {
            sample.radiance = light.changed(sample.radiance, sample.surface.is_none());
        }
        Some(samples)
    }

    /// The same samples, trimmed for viewing where the focus of each is known: they take less room once they are compressed.
    ///
    /// Surface addresses are gone: each that lies on a surface is in a corner of triangle 0. Depths are exact to 2⁻¹³ of themselves, which
    /// moves the rim of a blur of 100 px by 0.02 px at most; radiances to 2⁻⁸ of their largest channel, most to half of that. What is
    /// not packed keeps its numbers.
    pub fn trimmed(mut self) -> Self {
        for record in &mut self.records {
            *record = record.trimmed();
        }
        for plane in self.planes.iter_mut().filter(|plane| plane.triangle != Plane::NO_TRIANGLE) {
            plane.triangle = 0;
        }
        for surface in self.loose.iter_mut().filter_map(|sample| sample.surface.as_mut()) {
            *surface = SurfacePoint { triangle: 0, barycentric: DVec2::ZERO };
        }
        self
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

    /// Where the parts of a chunk start, or behind the last one end.
    pub(super) fn starts(&self, chunk: usize) -> Starts {
        self.chunks.get(chunk).map_or_else(|| self.ends(), |chunk| chunk.starts)
    }

    pub(super) fn ends(&self) -> Starts {
        let place = |length: usize| u32::try_from(length).expect("fewer than 2³² samples");
        Starts {
            records: place(self.records.len()),
            planes: place(self.planes.len()),
            sub_cells: place(self.sub_cells.len()),
            patches: place(self.patches.len()),
            codes: place(self.codes.len()),
        }
    }

    pub(super) fn plane_of(&self, chunk: usize, record: &Record) -> Option<&Plane> {
        let first = self.chunks[chunk].starts.planes as usize;
        (record.plane != Record::BACKGROUND && !record.is_splat())
            .then(|| &self.planes[first + record.plane as usize])
    }

    pub(super) fn surface_of(&self, chunk: usize, record: &Record) -> Option<SurfacePoint> {
        if let Some((triangle, _)) = record.splat() {
            return Some(SurfacePoint { triangle, barycentric: DVec2::ZERO });
        }
        let plane = self.plane_of(chunk, record).filter(|plane| plane.triangle != Plane::NO_TRIANGLE)?;
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
