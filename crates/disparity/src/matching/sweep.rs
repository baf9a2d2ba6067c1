//! The cost of every disparity at every pixel: how far the views differ from the reference when they are shifted by it.
//!
//! A plane sweep (Collins, *A Space-Sweep Approach to True Multi-Image Matching*, CVPR 1996): with the views on a plane, testing one
//! disparity d for the whole picture is a shift of the whole view by −d · offset. Differences are sums of the three channels'
//! absolute ones, truncated at [`TRUNCATION`], so that a few views that see something else do not dominate; of the halves of the views
//! (`halves`) the one that agrees best counts. A view does not count beyond its shifted border.

use crate::matching::halves::Halves;
use crate::matching::labels::Labels;
use crate::planes::Planes;
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use std::ops::Range;

/// Where a difference (sum of three channels, of white) is truncated.
pub const TRUNCATION: f32 = 0.25;

/// A cost of [`TRUNCATION`] in units of the volume.
pub const FULL_COST: f32 = 2000.0;

/// The share of the best half in the cost; the rest is that of all views. Next to an edge of a plain surface half of the views agree with
/// *any* disparity, for in them the edge moves away: all views together decide which is right. Where something is hidden, all views
/// together still prefer the right one, if less clearly.
const BEST_HALF: f32 = 0.65;

/// Rows that are matched at once: few, so that the sums stay in the cache.
const BAND: usize = 8;

/// A shifted view.
#[derive(Clone, Copy)]
pub struct ShiftedView<'a> {
    /// Its pixels, after vignetting compensation.
    pub planes: &'a Planes,
    /// Its position relative to the reference, steps of the grid.
    pub offset: [f32; 2],
    /// Its weight; 1 for a view that was not brightened.
    pub weight: f32,
}

/// Costs of some rows of the reference: for each pixel, all labels.
pub struct CostVolume {
    /// Pixels per row.
    pub width: usize,
    /// The rows of the picture.
    pub rows: Range<usize>,
    /// Costs per pixel.
    pub labels: usize,
    /// Row by row, pixel by pixel, label by label; up to [`FULL_COST`].
    pub costs: Vec<i16>,
}

/// The costs of all `labels` for the pixels in `rows` of the reference (Collins's plane sweep, 1996).
///
/// # Errors
/// [`Cancelled`] if `progress` asks to stop.
pub fn plane_sweep(
    reference: &Planes,
    others: &[ShiftedView<'_>],
    labels: &Labels,
    rows: Range<usize>,
    progress: &dyn Progress,
) -> Result<CostVolume, Cancelled> {
    let width = reference.width();
    let offsets: Vec<_> = others.iter().map(|view| view.offset).collect();
    let halves = Halves::from_offsets(&offsets);
    let mut costs = vec![0i16; rows.len() * width * labels.count];
    costs.par_chunks_mut(BAND * width * labels.count).enumerate().try_for_each(|(band, costs)| {
        let top = rows.start + band * BAND;
        let mut sums = Sums::new(&halves, width, costs.len() / (width * labels.count));
        for label in 0..labels.count {
            progress.check()?;
            let disparity = labels.disparity(label as f32);
            sums.add_up(reference, others, &halves, disparity, top);
            sums.write(&halves, costs, label, labels.count);
        }
        Ok(())
    })?;
    Ok(CostVolume { width, rows, labels: labels.count, costs })
}

/// Sums of differences of one label over a band of rows, for each group of views.
struct Sums {
    width: usize,
    rows: usize,
    /// Group by group, row by row: weighted differences.
    differences: Vec<f32>,
    /// The same for weights; first as changes from pixel to pixel.
    weights: Vec<f32>,
    /// The weight of all views of a group.
    whole: Vec<f32>,
}

impl Sums {
    fn new(halves: &Halves, width: usize, rows: usize) -> Self {
        let size = halves.groups * rows * width;
        Self { width, rows, differences: vec![0.0; size], weights: vec![0.0; size], whole: Vec::new() }
    }

    fn add_up(
        &mut self,
        reference: &Planes,
        others: &[ShiftedView<'_>],
        halves: &Halves,
        disparity: f32,
        top: usize,
    ) {
        let (width, height) = (self.width as isize, reference.height() as isize);
        self.differences.fill(0.0);
        self.weights.fill(0.0);
        self.whole = vec![0.0; halves.groups];
        for (view, &group) in others.iter().zip(&halves.group_of) {
            self.whole[group] += view.weight;
            let shift = view.offset.map(|offset| -disparity * offset);
            let (column, row) = (shift[0].floor(), shift[1].floor());
            let part = [shift[0] - column, shift[1] - row];
            let (column, row) = (column as isize, row as isize);
            let first = (-column).clamp(0, width) as usize;
            let end = (width - column).clamp(0, width) as usize;
            if first >= end {
                continue;
            }
            for y in 0..self.rows {
                let there = (top + y) as isize + row;
                if there < 0 || there >= height {
                    continue;
                }
                let at = (group * self.rows + y) * self.width;
                self.weights[at + first] += view.weight;
                if end < self.width {
                    self.weights[at + end] -= view.weight;
                }
                let start = (first as isize + column) as usize;
                add_differences(
                    &mut self.differences[at + first..at + end],
                    reference,
                    (first, top + y),
                    view,
                    (start, there as usize),
                    part,
                );
            }
        }
        for row in self.weights.chunks_mut(self.width) {
            let mut sum = 0.0;
            for weight in row {
                sum += *weight;
                *weight = sum;
            }
        }
    }

    /// Writes the cost of the best half of every pixel.
    fn write(&self, halves: &Halves, costs: &mut [i16], label: usize, labels: usize) {
        let scale = FULL_COST / TRUNCATION;
        let size = self.rows * self.width;
        let mut best = vec![TRUNCATION; size];
        // The first of the halves is the whole.
        let mut whole = Vec::new();
        let (mut differences, mut weights) = (vec![0.0f32; size], vec![0.0f32; size]);
        for half in &halves.halves {
            differences.fill(0.0);
            weights.fill(0.0);
            for &group in half {
                let own = group * size..(group + 1) * size;
                differences.iter_mut().zip(&self.differences[own.clone()]).for_each(|(sum, d)| *sum += d);
                weights.iter_mut().zip(&self.weights[own]).for_each(|(sum, w)| *sum += w);
            }
            // Less than half of a half determines little; it only counts where nothing else is left.
            let min_weight = 0.45 * half.iter().map(|&g| self.whole[g]).sum::<f32>();
            for ((best, d), w) in best.iter_mut().zip(&differences).zip(&weights) {
                let mean = if *w >= min_weight { d / w } else { TRUNCATION };
                *best = best.min(mean);
            }
            if whole.is_empty() {
                whole = best.clone();
            }
        }
        for (pixel, (best, whole)) in best.iter().zip(&whole).enumerate() {
            let cost = BEST_HALF * best + (1.0 - BEST_HALF) * whole;
            costs[pixel * labels + label] = (cost * scale) as i16;
        }
    }
}

/// Adds the difference of a shifted row of a view to a row of the reference.
fn add_differences(
    sums: &mut [f32],
    reference: &Planes,
    (x, y): (usize, usize),
    view: &ShiftedView<'_>,
    (column, row): (usize, usize),
    [fx, fy]: [f32; 2],
) {
    let n = sums.len();
    let own: [&[f32]; 3] = std::array::from_fn(|c| &reference.row(c, y)[x..x + n]);
    let upper: [&[f32]; 3] = std::array::from_fn(|c| &view.planes.row(c, row)[column..column + n + 1]);
    let lower: [&[f32]; 3] = std::array::from_fn(|c| &view.planes.row(c, row + 1)[column..column + n + 1]);
    let [w00, w10, w01, w11] = [(1.0 - fx) * (1.0 - fy), fx * (1.0 - fy), (1.0 - fx) * fy, fx * fy];
    for i in 0..n {
        let mut difference = 0.0;
        for c in 0..3 {
            let there = w00 * upper[c][i] + w10 * upper[c][i + 1] + w01 * lower[c][i] + w11 * lower[c][i + 1];
            difference += (there - own[c][i]).abs();
        }
        sums[i] += difference.min(TRUNCATION) * view.weight;
    }
}
