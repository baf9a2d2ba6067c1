//! Samples to packed samples, a block of the picture at a time.

use crate::domain::{Cell, Domain};
use crate::jitter::jitter;
use crate::sample::{Sample, Visibility};
use crate::samples::arrays::{Chunk, Samples, Starts};
use crate::samples::masks::MaskWriter;
use crate::samples::numbers::{Float24, Rgb40};
use crate::samples::plane::Plane;
use crate::samples::record::{Kind, Patch, Record, Shape};
use glam::{DVec2, IVec2, Vec2, Vec3};
use half::f16;
use std::collections::HashMap;
use std::ops::Range;

/// A sample and its origin.
#[derive(Clone, Debug)]
pub struct BakedSample {
    /// The sample.
    pub sample: Sample,
    /// The cell that it is a part of, and which sub-cells (a bit each); none for a patch of surface.
    pub part_of: Option<(Cell, u64)>,
    /// The noisy part of its radiance ([`trace::OutgoingRadiance::noisy`]).
    pub noisy: Vec3,
}

/// Packs the samples of one block.
pub struct Packer {
    corner: IVec2,
    /// The triangles of splats.
    splats: Range<u32>,
    part: Samples,
    plane_of: HashMap<Plane, u16>,
    masks: MaskWriter,
    finished: Vec<Samples>,
}

/// The block that a place in the picture lies in, px of its upper left corner.
pub fn block_corner(pixel: IVec2) -> IVec2 {
    pixel.div_euclid(IVec2::splat(Domain::BLOCK)) * Domain::BLOCK
}

impl Packer {
    /// An empty packer for a chunk whose upper left corner is at `corner`, px, in a scene whose splats have the triangles `splats`.
    pub fn new(corner: IVec2, splats: Range<u32>) -> Self {
        Self {
            corner,
            splats,
            part: Samples::default(),
            plane_of: HashMap::new(),
            masks: MaskWriter::new(),
            finished: Vec::new(),
        }
    }

    /// Adds a sample: packed, or as it is if it cannot be packed.
    pub fn push(&mut self, baked: BakedSample) {
        if self.plane_of.len() >= Record::BACKGROUND as usize {
            self.close();
        }
        if self.pack(&baked).is_none() {
            self.part.loose.push(baked.sample);
        }
    }

    /// The samples that were taken up.
    pub fn finish(mut self) -> Samples {
        self.close();
        Samples::join(self.finished)
    }

    fn close(&mut self) {
        let mut part = std::mem::take(&mut self.part);
        part.codes = std::mem::replace(&mut self.masks, MaskWriter::new()).finish();
        self.plane_of.clear();
        if !part.records.is_empty() {
            part.chunks.push(Chunk { corner: self.corner, starts: Starts::default() });
        }
        self.finished.push(part);
    }

    /// `None` if a value is out of the range of packed samples.
    fn pack(&mut self, baked: &BakedSample) -> Option<()> {
        let BakedSample { sample, part_of, .. } = baked;
        let (pixel, level) = match part_of {
            Some((cell, _)) => (cell.corner, cell.side.ilog2() as u8),
            None => (sample.center.floor().as_ivec2(), 0),
        };
        let pixel = pixel - self.corner;
        let is_inside = pixel.cmpge(IVec2::ZERO).all() && pixel.cmplt(IVec2::splat(Domain::BLOCK)).all();
        let triangle = sample.surface.map_or(Plane::NO_TRIANGLE, |point| point.triangle);
        let shape = match part_of {
            Some((Cell { side: 1, .. }, u64::MAX)) if self.splats.contains(&triangle) => Shape::Splat,
            Some((_, u64::MAX)) => Shape::WholeCell,
            Some((Cell { side: 1, .. }, sub_cells)) => match Cell::only_quadrant(*sub_cells) {
                Some(quadrant) => Shape::PartOfQuadrant(quadrant as u8),
                None => Shape::PartOfCell,
            },
            Some(_) => Shape::PartOfCell,
            None => Shape::Patch,
        };
        let cells = match &sample.visibility {
            Visibility::Open => None,
            Visibility::Cells { words } => Some(Visibility::side_of(words) as u8),
        };
        let kind = is_inside.then_some(Kind { pixel, level, shape, cells, is_carried: sample.is_carried })?;
        let inverse_depth = Float24::new(sample.inverse_depth)?;
        let place = (self.corner + pixel).as_uvec2();
        let chance = jitter(place.x, place.y, self.part.records.len() as u32);
        let radiance = Rgb40::new(sample.radiance, chance)?;
        let largest = sample.tilt.abs().max_element().max(sample.weight.abs());
        let (patch, scale) = match part_of {
            Some((cell, sub_cells)) => (None, cell.part(*sub_cells).weight as f32),
            None => {
                let fraction = sample.center - sample.center.floor();
                (Some(Patch::new(fraction, sample.half_size, Float24::new(largest)?)?), largest)
            }
        };
        let (weight, tilt) = (sample.weight / scale, sample.tilt / scale);
        if shape == Shape::Splat {
            let weight = f16::from_f32(weight);
            let is_weight = weight.is_finite() && weight >= f16::ZERO && tilt == Vec2::ZERO;
            let record =
                is_weight.then(|| Record::of_splat(kind, weight, triangle, inverse_depth, radiance))?;
            self.push_record(record, &sample.visibility);
            return Some(());
        }
        let plane = match sample.surface {
            None if patch.is_some() => return None,
            None if weight == 1.0 && tilt == Vec2::ZERO => Record::BACKGROUND,
            _ => self.plane(triangle, weight, tilt)?,
        };
        let barycentric = sample.surface.map_or(DVec2::ZERO, |point| point.barycentric);
        // Nothing fails from here on.
        let record = Record::new(kind, plane, barycentric, inverse_depth, radiance);
        self.part.patches.extend(patch);
        if let Some((_, sub_cells)) = part_of {
            let words = std::array::from_fn::<_, 4, _>(|quadrant| (sub_cells >> (16 * quadrant)) as u16);
            self.part.sub_cells.extend(match shape {
                Shape::WholeCell | Shape::Patch | Shape::Splat => &[],
                Shape::PartOfCell => &words[..],
                Shape::PartOfQuadrant(quadrant) => &words[quadrant as usize..][..1],
            });
        }
        self.push_record(record, &sample.visibility);
        Some(())
    }

    fn push_record(&mut self, record: Record, visibility: &Visibility) {
        self.part.records.push(record);
        if let Visibility::Cells { words } = visibility {
            self.masks.write(words);
        }
    }

    fn plane(&mut self, triangle: u32, weight: f32, tilt: Vec2) -> Option<u16> {
        let weights = [weight, tilt.x, tilt.y].map(f16::from_f32);
        let is_finite = weights.iter().all(|weight| weight.is_finite());
        let plane = is_finite.then(|| Plane { triangle, weights: weights.map(f16::to_bits) })?;
        let next = self.plane_of.len() as u16;
        Some(*self.plane_of.entry(plane).or_insert_with(|| {
            self.part.planes.push(plane);
            next
        }))
    }
}
