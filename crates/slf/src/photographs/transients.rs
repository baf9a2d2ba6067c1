//! Transient objects in photographs: passers-by, a card, a leaf.
//!
//! Photographs are examined by tiles. A tile is an outlier if it agrees neither with the mean of all photographs of its
//! texels (an object stands before the surface) nor with the prediction from nearby photographs (as a highlight would).
//!
//! ```text
//! s = min(|r|/σ, |r − r̂|/σ̂)        b = 1/(1 + (s̄/S)⁸)
//! ```
//!
//! | symbol | meaning | unit |
//! | --- | --- | --- |
//! | r | observation less the texel's constant part | radiance |
//! | r̂ | r predicted by the texel's other photographs ([`Workspace::leave_one_out`]) | radiance |
//! | σ, σ̂ | medians of \|r\| and \|r − r̂\| around the texel | radiance |
//! | s̄ | mean of s over a tile | 1 |
//! | S | [`OUTLIER_SCORE`] | 1 |
//! | b | inlier weight of the tile | 1 |

mod inlier_map;

pub(crate) use inlier_map::InlierMap;

use super::fitting::{
    CalibratedObservations, Kernel, MIN_ERROR, ResidualSample, Workspace, direction_to_eye, robust_mean,
};
use super::texels::TexelBlocks;
use glam::DVec2;
use inlier_map::TileGrid;
use numerics::upper_median;
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use scene::View;

/// Every n-th texel is examined.
const TEXEL_STEP: usize = 8;
/// Minimum number of observations for a tile to be rated.
const MIN_OBSERVATIONS: f32 = 4.0;
/// Texels observed by fewer photographs are skipped: none of them could be called an outlier.
const MIN_VIEWS: usize = 5;
/// Kernel of predictions by the other photographs: short reach, strong noise.
pub(crate) const PREDICTION_KERNEL: Kernel = Kernel { reach: 0.6, noise: 0.5 };
/// S: the score of a tile at which its weight is one half.
const OUTLIER_SCORE: f32 = 2.6;
/// Upper bound of an observation's score.
const MAX_SCORE: f32 = 8.0;
/// Tiles with a lower weight lower their neighbours as well, since the object extends into them.
const REJECTED_WEIGHT: f32 = 0.5;

/// Errors of one observation.
struct ObservationErrors {
    view: u16,
    weight: f32,
    constant_error: f32,
    prediction_error: f32,
}

/// Finds the inlier map of each view.
///
/// # Errors
/// [`Cancelled`] if `progress` asks to stop.
pub(crate) fn detect_transients(
    calibrated: &CalibratedObservations<'_>,
    views: &[View],
    progress: &dyn Progress,
) -> Result<Vec<InlierMap>, Cancelled> {
    let texels = calibrated.texels;
    let blocks = TexelBlocks::new(texels.size());
    let errors_by_texel: Vec<(usize, Vec<ObservationErrors>)> = (0..texels.count())
        .into_par_iter()
        .step_by(TEXEL_STEP)
        .filter(|&texel| calibrated.observations.range(texel).len() >= MIN_VIEWS && !progress.cancelled())
        .map_init(Workspace::new, |workspace, texel| (texel, texel_errors(calibrated, texel, workspace)))
        .collect();
    progress.check()?;
    let block_scales = |component: fn(&ObservationErrors) -> f32| -> Vec<f32> {
        let mut all = vec![Vec::new(); blocks.count()];
        for (texel, errors) in &errors_by_texel {
            all[blocks.block_of(texels, *texel)].extend(errors.iter().map(component));
        }
        all.iter_mut().map(|all| upper_median(all).unwrap_or(0.0).max(MIN_ERROR)).collect()
    };
    let (constant_scales, prediction_scales) =
        (block_scales(|errors| errors.constant_error), block_scales(|errors| errors.prediction_error));
    let mut scores: Vec<TileScores> = views.iter().map(TileScores::new).collect();
    for (texel, errors) in &errors_by_texel {
        let block = blocks.block_of(texels, *texel);
        for error in errors {
            let view_index = usize::from(error.view);
            let score = (error.constant_error / constant_scales[block])
                .min(error.prediction_error / prediction_scales[block])
                .min(MAX_SCORE);
            // Cannot fail: the same lens projected the point before.
            let pixel = views[view_index].project(texels.position(*texel)).unwrap_or_default();
            scores[view_index].add(pixel, score, error.weight);
        }
    }
    Ok(scores.into_par_iter().map(TileScores::into_inlier_map).collect())
}

fn texel_errors(
    calibrated: &CalibratedObservations<'_>,
    texel: usize,
    workspace: &mut Workspace,
) -> Vec<ObservationErrors> {
    calibrated.collect_samples(texel, &mut workspace.samples);
    let constant = robust_mean(&workspace.samples, &mut Vec::new());
    let observations = calibrated.observations.of_texel(texel);
    let from = calibrated.texels.position(texel);
    workspace.residuals.clear();
    for (index, (sample, observation)) in workspace.samples.iter().zip(observations).enumerate() {
        let direction = direction_to_eye(from, calibrated.eye(observation));
        let value = sample.light - constant;
        workspace.residuals.push(ResidualSample {
            index,
            direction,
            value,
            weight: sample.weight_against(constant),
        });
    }
    workspace.retain_best();
    workspace.leave_one_out(&PREDICTION_KERNEL);
    let errors =
        workspace.residuals.iter().zip(workspace.errors()).map(|(residual, error)| ObservationErrors {
            view: observations[residual.index].view,
            weight: residual.weight,
            constant_error: residual.value.length(),
            prediction_error: error.length(),
        });
    errors.collect()
}

/// By tile of a view: sums of scores and weights, and the number of observations.
struct TileScores {
    grid: TileGrid,
    tiles: Vec<[f32; 3]>,
}

impl TileScores {
    fn new(view: &View) -> Self {
        let grid = TileGrid::new(view);
        Self { grid, tiles: vec![[0.0; 3]; grid.columns * grid.rows] }
    }

    fn add(&mut self, pixel: DVec2, score: f32, weight: f32) {
        let TileGrid { columns, rows, side_px } = self.grid;
        let (column, row) = ((pixel.x / side_px) as usize, (pixel.y / side_px) as usize);
        if column < columns && row < rows {
            let tile = &mut self.tiles[row * columns + column];
            *tile = [tile[0] + score * weight, tile[1] + weight, tile[2] + 1.0];
        }
    }

    fn into_inlier_map(self) -> InlierMap {
        let tile_weight = |&[score, weight, count]: &[f32; 3]| {
            let has_evidence = count >= MIN_OBSERVATIONS && weight > 0.0;
            let inlier_weight =
                if has_evidence { 1.0 / (1.0 + (score / weight / OUTLIER_SCORE).powi(8)) } else { 1.0 };
            // Differences of a thousandth are ignored.
            if inlier_weight > 0.999 { 1.0 } else { inlier_weight }
        };
        let own: Vec<f32> = self.tiles.iter().map(tile_weight).collect();
        let TileGrid { columns, rows, .. } = self.grid;
        let tiles = (0..own.len()).map(|tile| {
            let (x, y) = (tile % columns, tile / columns);
            let around = (y.saturating_sub(1)..(y + 2).min(rows)).flat_map(|row| {
                (x.saturating_sub(1)..(x + 2).min(columns)).map(move |column| row * columns + column)
            });
            let min_around = around.map(|tile| own[tile]).fold(1.0, f32::min);
            if min_around < REJECTED_WEIGHT { own[tile].min(min_around) } else { own[tile] }
        });
        InlierMap { grid: self.grid, tiles: tiles.collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outlier_tiles_are_rejected_with_their_neighbours() {
        let inlier_map_with = |outlier: usize| {
            let mut tiles = vec![[8.0, 10.0, 10.0]; 50];
            tiles[outlier] = [50.0, 10.0, 10.0];
            TileScores { grid: TileGrid { columns: 10, rows: 5, side_px: 12.0 }, tiles }.into_inlier_map()
        };
        let inlier_map = inlier_map_with(22);
        let at = |column: f64, row: f64| inlier_map.at(DVec2::new(column, row) * 12.0 + 6.0);
        assert!(at(2.0, 2.0) < 0.01 && at(3.0, 1.0) < 0.01 && at(1.0, 3.0) < 0.01);
        assert_eq!([at(4.0, 2.0), at(0.0, 2.0), at(9.0, 4.0)], [1.0; 3]);
        assert!(!inlier_map.is_all_inliers());
        let grid = TileGrid { columns: 1, rows: 1, side_px: 12.0 };
        let few = TileScores { grid, tiles: vec![[50.0, 1.0, 2.0]] };
        assert!(few.into_inlier_map().is_all_inliers(), "too few observations");
    }
}
