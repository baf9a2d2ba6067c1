//! Whether samples that were read make sense.

use crate::samples::arrays::{Samples, Starts};
use crate::samples::plane::Plane;
use crate::samples::record::{Record, Shape};
use glam::IVec2;

/// No block lies farther from the frame's corner, px.
const FARTHEST: i32 = 1 << 20;

impl Samples {
    /// Whether all that refers to something finds it, with surfaces among `triangles`; else what does not.
    pub(crate) fn check(&self, triangles: u32) -> Result<(), String> {
        let lies_elsewhere = |triangle: u32| triangle >= triangles;
        let is_of_scene =
            |plane: &Plane| plane.triangle == Plane::NO_TRIANGLE || !lies_elsewhere(plane.triangle);
        if !self.planes.iter().all(is_of_scene)
            || self.records.iter().filter_map(Record::splat).any(|(triangle, _)| lies_elsewhere(triangle))
            || self.loose.iter().any(|s| s.surface.is_some_and(|point| lies_elsewhere(point.triangle)))
        {
            return Err("a sample lies on a triangle that the scene does not have".into());
        }
        let is_weighed = |(_, weight): (u32, f32)| weight.is_finite() && weight >= 0.0;
        let undefined = self.planes.iter().any(|plane| !plane.weights().iter().all(|w| w.is_finite()))
            || self.patches.iter().any(|patch| !patch.largest.get().is_finite());
        let is_sound = |record: &Record| record.is_sound() && record.splat().is_none_or(is_weighed);
        if undefined || !self.records.iter().all(is_sound) {
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
            if !(of_plane || record.is_splat() || is_background && !is_patch) || is_empty {
                return Err(wrong());
            }
        }
        let is_whole = sub_cells.is_empty() && patches == end.patches - start.patches;
        if is_far || !is_whole { Err(wrong()) } else { Ok(()) }
    }
}
