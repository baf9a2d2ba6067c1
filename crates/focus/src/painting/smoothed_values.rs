//! The local mean under a dab, by world position.
//!
//! The texels around the dab are spread over a coarse grid of cells (each over the eight nearest, trilinearly,
//! weighted by area), and the mean at a point is gathered from the eight cells around it. The grid depends only on
//! positions, so the mean crosses chart seams, and its cost does not grow with the width of the kernel. Values are
//! summed as differences from one texel's value: among equal texels the mean is exactly their value.

use crate::painting::dab::Dab;
use crate::{Brush, Canvas, FocusMap};
use glam::{IVec3, Vec3};

/// Cells along the dab's radius, unless the texels are too large for that.
const CELLS_ALONG_RADIUS: f32 = 4.0;

/// The means around a dab.
pub(crate) struct SmoothedValues {
    /// The value that the sums are relative to.
    reference: [f32; 4],
    /// The minimum and maximum of each number around the dab.
    bounds: [[f32; 4]; 2],
    cell_side: f32,
    /// Cells on each side of the grid.
    side: i32,
    /// Weight and weighted differences of t, anchor, gloss and mask of each cell.
    cells: Vec<[f64; 5]>,
}

impl SmoothedValues {
    /// Gathers mean values of the texels around `dab` that face the same way.
    pub fn new(dab: &Dab, brush: &Brush, canvas: &Canvas, map: &FocusMap) -> Self {
        let mut area = 0.0;
        let mut count = 0.0;
        canvas.visit_within(dab.center, dab.radius, |index, _| {
            area += canvas.texel(index).area;
            count += 1.0;
        });
        // A cell smaller than two texels would contain no neighbours to average with.
        let texel_side = if count > 0.0 { (area / count).sqrt() as f32 } else { 0.0 };
        let cell_side = (dab.radius as f32 / CELLS_ALONG_RADIUS).max(2.0 * texel_side);
        let reach = dab.radius as f32 + 2.0 * cell_side;
        let side = 2 * (reach / cell_side).ceil() as i32 + 2;
        let empty = vec![[0.0; 5]; (side * side * side) as usize];
        let bounds = [[f32::INFINITY; 4], [f32::NEG_INFINITY; 4]];
        let mut smoothed = Self { reference: [0.0; 4], bounds, cell_side, side, cells: empty };
        let mut reference = None;
        canvas.visit_within(dab.center, reach as f64, |index, _| {
            let texel = canvas.texel(index);
            if !dab.accepts_normal(brush, &texel) {
                return;
            }
            let value = canvas.value(map, index);
            let from = *reference.get_or_insert(value);
            let difference = [0, 1, 2, 3].map(|k| value[k] as f64 - from[k] as f64);
            for (k, value) in value.into_iter().enumerate() {
                let [low, high] = &mut smoothed.bounds;
                (low[k], high[k]) = (low[k].min(value), high[k].max(value));
            }
            for (cell, share) in smoothed.cells_around(canvas.offset_from(index, dab.center)) {
                let weight = share * texel.area;
                let sums = &mut smoothed.cells[cell];
                sums[0] += weight;
                (0..4).for_each(|k| sums[k + 1] += weight * difference[k]);
            }
        });
        smoothed.reference = reference.unwrap_or_default();
        smoothed
    }

    /// The mean at a point relative to the dab's centre; `otherwise` if no texel is near.
    pub fn value_at(&self, offset: Vec3, otherwise: [f32; 4]) -> [f32; 4] {
        let mut sums = [0.0; 5];
        for (cell, share) in self.cells_around(offset) {
            for (sum, value) in sums.iter_mut().zip(self.cells[cell]) {
                *sum += share * value;
            }
        }
        if sums[0] > 0.0 {
            [0, 1, 2, 3].map(|k| (self.reference[k] as f64 + sums[k + 1] / sums[0]) as f32)
        } else {
            otherwise
        }
    }

    /// The smallest and the largest t, anchor, gloss and mask around the dab.
    pub fn bounds(&self) -> [[f32; 4]; 2] {
        self.bounds
    }

    /// The eight cells around a point with its trilinear shares; those outside the grid are left out.
    fn cells_around(&self, offset: Vec3) -> impl Iterator<Item = (usize, f64)> + use<> {
        let side = self.side;
        let p = offset / self.cell_side + Vec3::splat(side as f32 / 2.0 - 0.5);
        let low = p.floor();
        let f = p - low;
        (0..8).filter_map(move |corner| {
            let step = IVec3::new(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
            let cell = low.as_ivec3() + step;
            let inside = cell.cmpge(IVec3::ZERO).all() && cell.cmplt(IVec3::splat(side)).all();
            let shares = Vec3::select(step.cmpeq(IVec3::ONE), f, Vec3::ONE - f);
            let index = (cell.z * side + cell.y) * side + cell.x;
            inside.then_some((index as usize, shares.element_product() as f64))
        })
    }
}
