//! Disparities of another view: those of the reference, warped there, and the background that is visible only from it.
//!
//! A pixel of the reference with disparity d is at x − d b in the view at b, with the same d. Between neighbours of one surface the map is
//! continuous, so the parallelogram that each pixel covers is drawn, and the nearest wins. Pixels that stay uncovered were hidden from
//! the reference or are beyond its frame: there all views are matched anew, with the warped pixels fixed, so that both views have one
//! surface.

use crate::matching::choice::choose;
use crate::matching::labels::Labels;
use crate::matching::semi_global::{Penalties, aggregate};
use crate::matching::sweep::{CostVolume, FULL_COST, ShiftedView, plane_sweep};
use crate::planes::Planes;
use crate::refinement::Refinement;
use crate::refinement::evidence::Evidence;
use progress::{Cancelled, Progress, Stage};

/// Neighbours whose disparities differ so much that they separate by more than this in the other view are two
/// surfaces, pixels.
const PARTING_PX: f32 = 0.7;

/// The warped map: disparity and confidence; NaN where nothing was warped to.
pub struct WarpedMap {
    /// Disparities.
    pub disparity: Vec<f32>,
    /// Confidences.
    pub confidence: Vec<f32>,
}

/// Warps a disparity map with rows of `width`, and its confidence, to the view at `offset` from its own.
pub fn warp(disparity: &[f32], confidence: &[f32], width: usize, offset: [f32; 2]) -> WarpedMap {
    let height = disparity.len() / width;
    let mut warped =
        WarpedMap { disparity: vec![f32::NAN; disparity.len()], confidence: vec![0.0; disparity.len()] };
    let reach = offset[0].abs().max(offset[1].abs());
    for y in 0..height {
        for x in 0..width {
            // The quad to the right and below; a corner of another surface is replaced by the pixel's own plane.
            let own = disparity[y * width + x];
            let corner = |x: usize, y: usize| {
                let d = disparity[y.min(height - 1) * width + x.min(width - 1)];
                if (d - own).abs() * reach > PARTING_PX { own } else { d }
            };
            let slopes = [corner(x + 1, y) - own, corner(x, y + 1) - own];
            draw_pixel(
                &mut warped,
                width,
                [x as f32, y as f32],
                own,
                slopes,
                offset,
                confidence[y * width + x],
            );
        }
    }
    warped
}

/// Draws what one pixel covers in the other view: half a pixel to every side, as a plane of disparities.
fn draw_pixel(
    warped: &mut WarpedMap,
    width: usize,
    [x, y]: [f32; 2],
    own: f32,
    slopes: [f32; 2],
    [u, v]: [f32; 2],
    confidence: f32,
) {
    let height = warped.disparity.len() / width;
    // x′ = x − d u with d = own + slopes · (x − x₀): the pixel's square becomes a parallelogram.
    let place = [x - own * u, y - own * v];
    let across = [1.0 - slopes[0] * u, -slopes[0] * v];
    let down = [-slopes[1] * u, 1.0 - slopes[1] * v];
    let area = across[0] * down[1] - across[1] * down[0];
    if area <= 0.05 {
        return;
    }
    let half = [0.5 * (across[0].abs() + down[0].abs()), 0.5 * (across[1].abs() + down[1].abs())];
    // A little more than half a pixel, so that neighbours leave no seam.
    let edge = 0.5 + 1e-3;
    let columns = pixels(place[0], half[0], width);
    let rows = pixels(place[1], half[1], height);
    for (row, column) in rows.flat_map(|row| columns.clone().map(move |column| (row, column))) {
        let (dx, dy) = (column as f32 - place[0], row as f32 - place[1]);
        let a = (dx * down[1] - dy * down[0]) / area;
        let b = (dy * across[0] - dx * across[1]) / area;
        if a.abs() <= edge && b.abs() <= edge {
            let d = own + slopes[0] * a + slopes[1] * b;
            let at = row * width + column;
            let covered = warped.disparity[at];
            if covered.is_nan() || d > covered {
                warped.disparity[at] = d;
                warped.confidence[at] = confidence;
            }
        }
    }
}

/// The pixels of a line of `length` within `half` of a place.
fn pixels(place: f32, half: f32, length: usize) -> std::ops::Range<usize> {
    let first = (place - half).ceil().max(0.0) as usize;
    let end = (place + half).floor() + 1.0;
    first..(end.max(0.0) as usize).min(length)
}

/// Fills the uncovered pixels of the view by matching it with `chosen` views; returns the disparities and the
/// evidence.
///
/// # Errors
/// [`Cancelled`] if `progress` asks to stop.
pub fn fill_holes(
    refinement: &Refinement<'_>,
    warped: &[f32],
    chosen: &[ShiftedView<'_>],
    progress: &dyn Progress,
) -> Result<(Vec<f32>, Vec<Evidence>), Cancelled> {
    let (picture, labels) = (refinement.reference, refinement.labels);
    let width = picture.width();
    let mut disparity = warped.to_vec();
    let step = strip_rows(picture, &labels);
    for top in (0..picture.height()).step_by(step) {
        let end = (top + step).min(picture.height());
        let has_holes = warped[top * width..end * width].iter().any(|d| d.is_nan());
        if !has_holes {
            continue;
        }
        let mut volume = plane_sweep(picture, chosen, &labels, top..end, progress)?;
        pin_costs(&mut volume, &labels, &warped[top * width..end * width]);
        let sums = aggregate(&volume, picture, &Penalties::default(), progress)?;
        for (index, costs) in sums.chunks(labels.count).enumerate() {
            let d = &mut disparity[top * width + index];
            if d.is_nan() {
                *d = choose(costs, &labels).disparity;
            }
        }
    }
    let stage = Stage::new(progress, 0.5, 1.0);
    let evidence = refinement.run(&mut disparity, &|index| !warped[index].is_nan(), &stage)?;
    Ok((disparity, evidence))
}

/// The number of rows whose costs are in memory at once.
fn strip_rows(picture: &Planes, labels: &Labels) -> usize {
    (40_000_000 / (picture.width() * labels.count)).clamp(96.min(picture.height()), picture.height())
}

/// Sets the cost of pixels whose disparity is fixed to nothing at their label and to the maximum elsewhere.
fn pin_costs(volume: &mut CostVolume, labels: &Labels, warped: &[f32]) {
    for (costs, d) in volume.costs.chunks_mut(labels.count).zip(warped) {
        if !d.is_nan() {
            let label = ((d - labels.low) / labels.step).round().clamp(0.0, (labels.count - 1) as f32);
            costs.fill(FULL_COST as i16);
            costs[label as usize] = 0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_near_square_moves_over_a_wall_and_leaves_a_hole_of_its_parallax() {
        let (width, height) = (40, 30);
        let disparity: Vec<f32> = (0..width * height)
            .map(
                |i| if (10..20).contains(&(i % width)) && (8..18).contains(&(i / width)) { 3.0 } else { 0.0 },
            )
            .collect();
        let warped = warp(&disparity, &vec![1.0; width * height], width, [1.0, 0.0]);
        for (i, d) in warped.disparity.iter().enumerate() {
            let (x, y) = (i % width, i / width);
            let rows = (8..18).contains(&y);
            if rows && (7..17).contains(&x) {
                assert_eq!(*d, 3.0, "({x}, {y})");
            } else if rows && (17..20).contains(&x) {
                assert!(d.is_nan(), "({x}, {y}): {d}");
            } else {
                assert_eq!(*d, 0.0, "({x}, {y})");
            }
        }
    }

    #[test]
    fn a_slanted_plane_stays_whole() {
        let (width, height) = (50, 20);
        let disparity: Vec<f32> = (0..width * height).map(|i| 0.15 * (i % width) as f32).collect();
        // x′ = x − 0.15 x u: with u = −1 stretched by 1.15, with u = 1 squeezed by 0.85.
        for (u, scale) in [(-1.0, 1.15), (1.0, 0.85)] {
            let warped = warp(&disparity, &vec![1.0; width * height], width, [u, 0.0]);
            for (i, d) in warped.disparity.iter().enumerate().filter(|(i, _)| i % width < 40) {
                let true_d = 0.15 * (i % width) as f32 / scale;
                assert!((d - true_d).abs() < 1e-3, "{u}: {i}: {d} instead of {true_d}");
            }
        }
    }
}
