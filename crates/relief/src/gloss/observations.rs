//! Differences between other views and the picture, by blocks of pixels.

use crate::color_stats::squared_distance;
use crate::edges::covers::project_cell;
use crate::error::ReliefError;
use crate::mesh::cells::Grid;
use crate::other_view::OtherView;
use crate::resampling::{FrontLayer, interpolate, nearest_disparity};
use numerics::upper_median;
use progress::Progress;
use rayon::prelude::*;

/// The observation of a block in one view.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Observation {
    /// View minus picture, linear RGB; the mean over the pixels that the view shows.
    pub difference: [f32; 3],
    /// The share of the block's pixels that the view shows, in [0, 1].
    pub weight: f32,
}

/// An observation as it is stored.
#[derive(Clone, Copy, Debug, Default)]
struct QuantizedObservation {
    /// In steps of [`STEP`].
    difference: [i16; 3],
    /// In steps of 1/65,535.
    weight: u16,
}

impl QuantizedObservation {
    fn quantize(observation: &Observation) -> Self {
        Self {
            difference: observation.difference.map(|more| (more / STEP + 0.5f32.copysign(more)) as i16),
            weight: (observation.weight * f32::from(u16::MAX) + 0.5) as u16,
        }
    }

    fn dequantize(&self) -> Observation {
        Observation {
            difference: self.difference.map(|steps| f32::from(steps) * STEP),
            weight: f32::from(self.weight) / f32::from(u16::MAX),
        }
    }
}

/// The observations of all views.
pub(super) struct Observations {
    /// Width and height of a block, pixels.
    pub side: usize,
    pub blocks: Grid,
    /// By block, the mean colour of the picture.
    pub picture: Vec<[f32; 3]>,
    /// By block, the largest squared difference of adjacent pixels in it and next to it, all channels together.
    pub steepest: Vec<f32>,
    views: usize,
    /// By block, then by view.
    all: Vec<QuantizedObservation>,
}

/// Quantisation of light: 8 bits distinguish several steps in the dark, and an i16 holds eight times white.
const STEP: f32 = 1.0 / 4096.0;
/// The most bytes for observations: blocks are of several pixels where they would not fit.
const MAX_BYTES: usize = 192 << 20;
/// Pixels of views within this distance of something nearer are left out, px: those of edges are mixed.
const BESIDE: usize = 1;
/// Blocks darker than this do not count for the brightness of a view.
const DARK: f32 = 0.02;
/// The brightness of a view is measured on about so many blocks.
const RATIOS: usize = 20_000;

impl Observations {
    /// Collects what `views` show of the pixels that are `whole`: those of a single surface. `shown` is the
    /// reference, linear RGB, row by row.
    ///
    /// # Errors
    /// A view cannot be read, or `progress` asks to stop.
    pub fn collect<E: Send>(
        layer: &FrontLayer<'_>,
        shown: &[[f32; 3]],
        whole: &[bool],
        views: &[OtherView<'_, E>],
        progress: &dyn Progress,
    ) -> Result<Self, ReliefError<E>> {
        let [width, height] = layer.frame.picture();
        let picture = Grid { width, height };
        let bytes = |side: usize| {
            let blocks = width.div_ceil(side) * height.div_ceil(side);
            blocks.saturating_mul(views.len()).saturating_mul(size_of::<QuantizedObservation>())
        };
        let side = (1..).find(|&side| bytes(side) <= MAX_BYTES).unwrap_or(width.max(height));
        let blocks = Grid { width: width.div_ceil(side), height: height.div_ceil(side) };
        let (frame, grid) = (layer.frame, layer.frame.grid);
        let margin = frame.margin;
        // The observed pixels of a block, in the grid of cells.
        let pixels = |block: usize| {
            let (x, y) = (block % blocks.width * side, block / blocks.width * side);
            let rows = y..(y + side).min(height);
            let columns = x..(x + side).min(width);
            let cells = rows.flat_map(move |y| columns.clone().map(move |x| grid.at(x + margin, y + margin)));
            cells.filter(|&cell| whole[cell])
        };
        let mean = |block: usize| {
            let (mut sum, mut count) = ([0.0; 3], 0.0f32);
            for cell in pixels(block) {
                (0..3).for_each(|c| sum[c] += shown[cell][c]);
                count += 1.0;
            }
            // A block that lies on an edge is not observed.
            if 2.0 * count >= (side * side) as f32 { sum.map(|sum| sum / count) } else { [f32::NAN; 3] }
        };
        let step = |cell: usize| -> f32 {
            grid.around(cell)
                .map(|(_, other)| squared_distance(shown[cell], shown[other]))
                .fold(0.0, f32::max)
        };
        let steepest = |block: usize| pixels(block).map(step).fold(0.0, f32::max);
        let steepest = (0..blocks.count()).into_par_iter().map(steepest).collect();
        let means: Vec<[f32; 3]> = (0..blocks.count()).into_par_iter().map(mean).collect();
        let mut all = vec![QuantizedObservation::default(); blocks.count() * views.len()];
        for (number, view) in views.iter().enumerate() {
            progress.check().map_err(ReliefError::Cancelled)?;
            progress.report(number as f32 / views.len() as f32);
            let view_pixels = (view.read)().map_err(ReliefError::View)?;
            // A picture of another size cannot be compared.
            if view_pixels.len() != picture.count() {
                continue;
            }
            let nearest = largest_around(grid, &nearest_disparity(grid, layer.front, view.offset), BESIDE);
            let observation = |block: usize| {
                let (mut total, mut count) = ([0.0; 3], 0.0f32);
                for cell in pixels(block) {
                    let disparity = layer.front[cell];
                    let at = project_cell(grid, cell, disparity, view.offset);
                    let is_open = open_at(grid, &nearest, at, disparity + layer.jump);
                    let at = at.map(|at| at - margin as f32);
                    if is_open && let Some(color) = interpolate(picture, &view_pixels, at) {
                        (0..3).for_each(|c| total[c] += color[c] - shown[cell][c]);
                        count += 1.0;
                    }
                }
                match count > 0.0 {
                    true => Observation {
                        difference: total.map(|sum| sum / count),
                        weight: count / (side * side) as f32,
                    },
                    false => Observation::default(),
                }
            };
            let of_block = |block: usize| match means[block][0].is_nan() {
                true => Observation::default(),
                false => observation(block),
            };
            let mut of_view: Vec<Observation> = (0..blocks.count()).into_par_iter().map(of_block).collect();
            even_out(&means, &mut of_view);
            let of_blocks = all.par_chunks_mut(views.len()).zip(&of_view);
            of_blocks
                .for_each(|(row, observation)| row[number] = QuantizedObservation::quantize(observation));
        }
        Ok(Self { side, blocks, picture: means, steepest, views: views.len(), all })
    }

    /// The observations of the block with this number, in the order of the views.
    pub fn of_block(&self, block: usize) -> Vec<Observation> {
        self.all[block * self.views..(block + 1) * self.views]
            .iter()
            .map(QuantizedObservation::dequantize)
            .collect()
    }
}

/// Brightens a view that is darker as a whole, like the outer ones of a plenoptic camera.
fn even_out(picture: &[[f32; 3]], observations: &mut [Observation]) {
    for channel in 0..3 {
        // The median of evenly spread blocks is accurate enough.
        let stride = picture.len().div_ceil(RATIOS);
        let ratio = |(picture, observation): (&[f32; 3], &Observation)| {
            let is_usable = picture[channel] > DARK && observation.weight > 0.0;
            is_usable.then(|| 1.0 + observation.difference[channel] / picture[channel])
        };
        let mut ratios: Vec<f32> =
            picture.iter().zip(&*observations).filter_map(ratio).step_by(stride).collect();
        let Some(ratio) = upper_median(&mut ratios) else { continue };
        if ratio <= 0.0 {
            continue;
        }
        let gain = 1.0 / ratio;
        for (picture, observation) in picture.iter().zip(&mut *observations).filter(|(_, s)| s.weight > 0.0) {
            let all = picture[channel] + observation.difference[channel];
            observation.difference[channel] = all * gain - picture[channel];
        }
    }
}

/// Whether nothing of more disparity than `max_disparity` is at a position, where `nearest` has the largest disparity
/// around.
fn open_at(grid: Grid, nearest: &[f32], at: [f32; 2], max_disparity: f32) -> bool {
    let [x, y] = at.map(|at| at.floor() as isize);
    let is_in = (0..grid.width as isize).contains(&x) && (0..grid.height as isize).contains(&y);
    is_in && nearest[grid.at(x as usize, y as usize)] <= max_disparity
}

/// The largest value within so many cells of each, along rows and columns.
fn largest_around(grid: Grid, values: &[f32], around: usize) -> Vec<f32> {
    let along = |values: &[f32], step: usize, at: &(dyn Fn(usize) -> [usize; 2] + Sync)| -> Vec<f32> {
        let largest = |cell: usize| {
            let [at, count] = at(cell);
            let (first, last) = (at.saturating_sub(around), (at + around).min(count - 1));
            let start = cell - at * step;
            (first..=last).map(|k| values[start + k * step]).fold(f32::NEG_INFINITY, f32::max)
        };
        (0..values.len()).into_par_iter().map(largest).collect()
    };
    let across = along(values, 1, &|cell| [cell % grid.width, grid.width]);
    along(&across, grid.width, &|cell| [cell / grid.width, grid.height])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_around_reaches_the_border() {
        let grid = Grid { width: 7, height: 5 };
        let mut values = vec![0.0; grid.count()];
        values[grid.at(1, 1)] = 2.0;
        values[grid.at(6, 4)] = 1.0;
        let largest = largest_around(grid, &values, 2);
        let expected = |x: usize, y: usize| match () {
            () if x <= 3 && y <= 3 => 2.0,
            () if x >= 4 && y >= 2 => 1.0,
            () => 0.0,
        };
        for (cell, value) in largest.iter().enumerate() {
            assert_eq!(*value, expected(cell % 7, cell / 7), "{cell}");
        }
    }
}
