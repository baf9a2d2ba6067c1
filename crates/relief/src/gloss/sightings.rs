//! What views show of blocks of pixels, beside what the picture does.

use crate::cells::Grid;
use crate::covers::project_cell;
use crate::error::ReliefError;
use crate::look::squared_distance;
use crate::other_view::OtherView;
use crate::other_views::{FrontLayer, interpolate, nearest_disparity};
use progress::Progress;
use rayon::prelude::*;

/// What one view shows of a block.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Observation {
    /// How much more than the picture, linear RGB; the mean of the pixels that the view shows.
    pub difference: [f32; 3],
    /// The share of the block's pixels that it shows, in [0, 1].
    pub weight: f32,
}

/// The same as it is kept.
#[derive(Clone, Copy, Debug, Default)]
struct QuantizedObservation {
    /// In steps of [`STEP`].
    difference: [i16; 3],
    /// In steps of 1/65,535.
    weight: u16,
}

impl QuantizedObservation {
    fn quantize(sighting: &Observation) -> Self {
        Self {
            difference: sighting.difference.map(|more| (more / STEP + 0.5f32.copysign(more)) as i16),
            weight: (sighting.weight * f32::from(u16::MAX) + 0.5) as u16,
        }
    }

    fn dequantize(&self) -> Observation {
        Observation {
            difference: self.difference.map(|steps| f32::from(steps) * STEP),
            weight: f32::from(self.weight) / f32::from(u16::MAX),
        }
    }
}

/// What all views show.
pub(super) struct Observations {
    /// Pixels that a block is wide and high.
    pub side: usize,
    pub blocks: Grid,
    /// By block, what the picture shows in the mean.
    pub picture: Vec<[f32; 3]>,
    /// By block, the largest step between pixels in it and beside it, squared, all channels together.
    pub steepest: Vec<f32>,
    views: usize,
    /// By block, then by view.
    all: Vec<QuantizedObservation>,
}

/// Steps of light: 8 bits tell several of them apart in the dark, and an i16 holds eight times white.
const STEP: f32 = 1.0 / 4096.0;
/// Bytes that sightings take at most: blocks are of several pixels where they would not fit.
const MAX_BYTES: usize = 192 << 20;
/// Views in which something nearer is as near as this are left out, px: their edges are mixed.
const BESIDE: usize = 1;
/// Blocks darker than this tell nothing of how bright a view is as a whole.
const DARK: f32 = 0.02;
/// How bright a view is as a whole is told by about so many blocks.
const RATIOS: usize = 20_000;

impl Observations {
    /// Looks at the whole pixels in each view.
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
        // The pixels of a block that are told of, in the grid of cells.
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
            // Of a block that lies on an edge nothing is told.
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
            // A picture of another size shows nothing that could be found in it.
            if view_pixels.len() != picture.count() {
                continue;
            }
            let nearest = largest_around(grid, &nearest_disparity(grid, layer.front, view.offset), BESIDE);
            let sighting = |block: usize| {
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
                false => sighting(block),
            };
            let mut of_view: Vec<Observation> = (0..blocks.count()).into_par_iter().map(of_block).collect();
            even_out(&means, &mut of_view);
            let of_blocks = all.par_chunks_mut(views.len()).zip(&of_view);
            of_blocks.for_each(|(row, sighting)| row[number] = QuantizedObservation::quantize(sighting));
        }
        Ok(Self { side, blocks, picture: means, steepest, views: views.len(), all })
    }

    /// What views show of a block, in their order.
    pub fn of_block(&self, block: usize) -> Vec<Observation> {
        self.all[block * self.views..(block + 1) * self.views]
            .iter()
            .map(QuantizedObservation::dequantize)
            .collect()
    }
}

/// A view that is darker as a whole, as outer ones of a plenoptic camera are, is made as bright as the picture.
fn even_out(picture: &[[f32; 3]], observations: &mut [Observation]) {
    for channel in 0..3 {
        // The median of some that are spread evenly tells enough.
        let stride = picture.len().div_ceil(RATIOS);
        let ratio = |(picture, sighting): (&[f32; 3], &Observation)| {
            let is_usable = picture[channel] > DARK && sighting.weight > 0.0;
            is_usable.then(|| 1.0 + sighting.difference[channel] / picture[channel])
        };
        let mut ratios: Vec<f32> =
            picture.iter().zip(&*observations).filter_map(ratio).step_by(stride).collect();
        if ratios.is_empty() {
            continue;
        }
        let middle = ratios.len() / 2;
        let (_, ratio, _) = ratios.select_nth_unstable_by(middle, f32::total_cmp);
        if *ratio <= 0.0 {
            continue;
        }
        let gain = 1.0 / *ratio;
        for (picture, sighting) in picture.iter().zip(&mut *observations).filter(|(_, s)| s.weight > 0.0) {
            let all = picture[channel] + sighting.difference[channel];
            sighting.difference[channel] = all * gain - picture[channel];
        }
    }
}

/// Whether nothing of more disparity than `most` is where `nearest` has the largest around.
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
