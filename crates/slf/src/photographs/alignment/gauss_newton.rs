//! One Gauss–Newton step of the displacement that makes a photograph show what the others predict.
//!
//! ```text
//! Σᵢ wᵢ·(e(xᵢ) − I(xᵢ + u) − ∇I·(d(xᵢ) − u) − o(tile))² / σ²  +  Σ |dⱼ − dₖ|²/s²  +  Σ |dⱼ|²/h²        → min
//! ```
//!
//! | symbol | meaning | unit |
//! | --- | --- | --- |
//! | I, ∇I | the photograph and its gradient | root of radiance, per px |
//! | e | prediction by the other photographs | root of radiance |
//! | u, d | displacement before and after, linear between nodes j, k | px |
//! | o | local brightness offset: gloss and exposure are not displacement | root of radiance |
//! | σ | robust scale of the residuals | root of radiance |
//! | s, h | prior on differences between neighbours, and on the displacement itself | px |
//!
//! Zhou and Koltun 2014 ("Color map optimization for 3D reconstruction with consumer depth cameras"), without separate
//! pose variables: the lattice absorbs small pose errors. o is eliminated: in every tile only differences from the
//! weighted mean count.

use super::lattice::{CellPosition, Displacement, Lattice};
use glam::{DVec2, Vec2};
use numerics::{scaled_mad, solve_positive};
use scene::View;

/// A point where a photograph is compared with the prediction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Comparison {
    /// Projection of the point by the photograph's camera, px.
    pub pixel: DVec2,
    /// e − I.
    pub residual: f64,
    /// ∇I.
    pub slope: DVec2,
    /// Weight, > 0.
    pub weight: f64,
}

/// Tiles along a side of a cell.
const TILES: usize = 2;
/// Neighbouring points share their errors: each carries this share of an independent observation's information.
const POINT_WEIGHT: f64 = 0.05;
/// Lower bound of σ: 8-bit quantisation and JPEG.
const MIN_SCALE: f64 = 0.006;
/// Residuals beyond this many scales are outliers (squared Cauchy weights).
const OUTLIER_SCALES: f64 = 2.0;
/// s and h, px as stored.
const SMOOTHNESS_PX: f64 = 0.5;
const PRIOR_PX: f64 = 4.0;
/// Upper bound of the displacement of a node, px as stored: pose errors are smaller, and gradients do not recover
/// larger ones.
const MAX_DISPLACEMENT_PX: f64 = 6.0;

/// Unknowns of a cell: two per corner.
const UNKNOWNS_PER_CELL: usize = 8;

/// Normal-equation sums over a tile.
#[derive(Clone, Copy, Default)]
struct TileSums {
    matrix: [[f64; UNKNOWNS_PER_CELL]; UNKNOWNS_PER_CELL],
    right: [f64; UNKNOWNS_PER_CELL],
    row: [f64; UNKNOWNS_PER_CELL],
    residual: f64,
    weight: f64,
}

impl TileSums {
    fn add(&mut self, row: [f64; UNKNOWNS_PER_CELL], residual: f64, weight: f64) {
        for i in 0..UNKNOWNS_PER_CELL {
            for j in 0..=i {
                self.matrix[i][j] += weight * row[i] * row[j];
            }
            self.right[i] += weight * row[i] * residual;
            self.row[i] += weight * row[i];
        }
        self.residual += weight * residual;
        self.weight += weight;
    }

    /// Entry of the reduced matrix, i ≥ j.
    fn matrix(&self, i: usize, j: usize) -> f64 {
        self.matrix[i][j] - self.row[i] * self.row[j] / self.weight
    }

    fn right(&self, i: usize) -> f64 {
        self.right[i] - self.row[i] * self.residual / self.weight
    }
}

/// The displacement after one step from `previous`. `reduction` is the photograph's reduction: pixels of the file per
/// stored pixel, each way.
pub(crate) fn refine_displacement(
    view: &View,
    previous: &Displacement,
    comparisons: &[Comparison],
    reduction: u32,
) -> Option<Displacement> {
    let lattice = Lattice::new(view);
    let places: Vec<(usize, CellPosition)> =
        comparisons.iter().map(|place| lattice.cell(place.pixel)).collect();
    let tile = |(cell, at): &(usize, CellPosition)| {
        let [column, row] =
            [at.share.x, at.share.y].map(|share| ((share * TILES as f64) as usize).min(TILES - 1));
        (cell * TILES + row) * TILES + column
    };
    let mut means = vec![(0.0, 0.0); lattice.cells() * TILES * TILES];
    for (comparison, place) in comparisons.iter().zip(&places) {
        let mean = &mut means[tile(place)];
        *mean = (mean.0 + comparison.weight * comparison.residual, mean.1 + comparison.weight);
    }
    let deviations: Vec<f64> = comparisons
        .iter()
        .zip(&places)
        .map(|(comparison, place)| {
            let (sum, weight) = means[tile(place)];
            (comparison.residual - sum / weight).abs()
        })
        .collect();
    // Factor for a normal distribution.
    let scale = scaled_mad(&mut deviations.clone())?.max(MIN_SCALE);
    let mut sums = vec![TileSums::default(); means.len()];
    for ((comparison, place), deviation) in comparisons.iter().zip(&places).zip(deviations) {
        let inlier_weight = 1.0 / (1.0 + (deviation / (OUTLIER_SCALES * scale)).powi(2)).powi(2);
        let shares = place.1.shares();
        let row = std::array::from_fn(|i| shares[i / 2] * comparison.slope[i % 2]);
        let residual = comparison.residual + comparison.slope.dot(previous.at(comparison.pixel));
        sums[tile(place)].add(row, residual, comparison.weight * inlier_weight);
    }
    let n = 2 * lattice.nodes();
    let (mut matrix, mut right) = (vec![0.0; n * n], vec![0.0; n]);
    let information = POINT_WEIGHT / (scale * scale);
    let mut is_done = vec![false; means.len()];
    for place in &places {
        let number = tile(place);
        if std::mem::replace(&mut is_done[number], true) {
            continue;
        }
        let unknown = |i: usize| 2 * place.1.nodes[i / 2] + i % 2;
        for i in 0..UNKNOWNS_PER_CELL {
            right[unknown(i)] += information * sums[number].right(i);
            for j in 0..=i {
                let value = information * sums[number].matrix(i, j);
                matrix[unknown(i) * n + unknown(j)] += value;
                if i != j {
                    matrix[unknown(j) * n + unknown(i)] += value;
                }
            }
        }
    }
    let unit = f64::from(reduction);
    let [smoothness_weight, prior_weight] = [SMOOTHNESS_PX, PRIOR_PX].map(|px| 1.0 / (px * unit).powi(2));
    for unknown in 0..n {
        matrix[unknown * n + unknown] += prior_weight;
    }
    for [a, b] in lattice.neighbours() {
        for (a, b) in [(2 * a, 2 * b), (2 * a + 1, 2 * b + 1)] {
            matrix[a * n + a] += smoothness_weight;
            matrix[b * n + b] += smoothness_weight;
            matrix[a * n + b] -= smoothness_weight;
            matrix[b * n + a] -= smoothness_weight;
        }
    }
    solve_positive(&mut matrix, &mut right);
    let max_px = (MAX_DISPLACEMENT_PX * unit) as f32;
    let node = |node: &[f64; 2]| Vec2::new(node[0] as f32, node[1] as f32).clamp_length_max(max_px);
    Displacement::from_nodes(view, right.as_chunks::<2>().0.iter().map(node).collect())
}

#[cfg(test)]
mod tests {
    use super::super::lattice::tests::view;
    use super::*;

    #[test]
    fn a_shift_is_recovered_despite_brightness_changes_and_occluders() {
        let view = view([320, 240]);
        let pattern = |p: DVec2| 0.4 + 0.1 * (0.31 * p.x + 0.05 * p.y).sin() + 0.1 * (0.27 * p.y).cos();
        let slope = |p: DVec2| {
            let along = 0.1 * (0.31 * p.x + 0.05 * p.y).cos();
            DVec2::new(0.31 * along, 0.05 * along - 0.027 * (0.27 * p.y).sin())
        };
        let shift = |p: DVec2| DVec2::new(0.8 - 0.002 * p.x, -0.5 + 0.001 * p.y);
        let max_error_px = |has_card: bool| {
            let mut displacement = Displacement::none(&view);
            for _ in 0..4 {
                let comparisons: Vec<Comparison> = (0..80 * 60)
                    .map(|k| {
                        let pixel = DVec2::new(4.0 * f64::from(k % 80) + 2.0, 4.0 * f64::from(k / 80) + 2.0);
                        let at = pixel + displacement.at(pixel);
                        let is_card = has_card && (100.0..180.0).contains(&at.x) && at.y > 150.0;
                        // The expectation at p is met at p + shift(p), brighter toward the right.
                        let shown = if is_card { 0.9 } else { pattern(at) + 0.0002 * at.x };
                        let expected = pattern(pixel + shift(pixel));
                        Comparison { pixel, residual: expected - shown, slope: slope(at), weight: 1.0 }
                    })
                    .collect();
                displacement = refine_displacement(&view, &displacement, &comparisons, 1).unwrap();
            }
            let places = [[30.0, 40.0], [160.0, 120.0], [300.0, 60.0], [250.0, 200.0]].map(DVec2::from);
            places.map(|p| (displacement.at(p) - shift(p)).length()).into_iter().fold(0.0, f64::max)
        };
        assert!(max_error_px(false) < 0.08, "{}", max_error_px(false));
        assert!(max_error_px(true) < 0.15, "{}", max_error_px(true));
        assert!(
            refine_displacement(&view, &Displacement::none(&view), &[], 1).is_none(),
            "there is no evidence"
        );
    }
}
