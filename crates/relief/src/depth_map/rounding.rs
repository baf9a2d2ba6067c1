//! Depth maps of few levels: removes the stairs that rounding made of slopes.
//!
//! Where many neighbours have exactly the same number, numbers were rounded. They are then smoothed within the rounding interval, half a
//! level either way, from far neighbours to near ones, so that wide stairs become slopes, too.

use crate::mesh::cells::Grid;
use numerics::upper_median;
use rayon::prelude::*;

/// The least share of equal neighbours of a rounded map.
const SAME: f64 = 0.4;
/// The distances of the neighbours that are averaged, and the number of rounds with each.
const STRIDES: [usize; 6] = [32, 16, 8, 4, 2, 1];
const ROUNDS: usize = 6;

/// Smooths a rounded map. Steps of more than `jump` are not caused by rounding.
pub(crate) fn smooth_rounding(grid: Grid, disparity: &mut Vec<f32>, jump: f32) {
    let Some(level) = level(grid, disparity, jump) else { return };
    let rounded = disparity.clone();
    for (stride, _) in STRIDES.iter().flat_map(|stride| (0..ROUNDS).map(move |round| (*stride, round))) {
        // Slopes of several levels from neighbour to neighbour are fine enough; larger steps belong to something
        // else.
        let max_step = jump.min(3.0 * level * stride as f32);
        let before = &*disparity;
        let next = (0..grid.count()).into_par_iter().map(|cell| {
            let (x, y) = (cell % grid.width, cell / grid.width);
            let own = before[cell];
            let pair = |fits: bool, offset: usize| {
                let [a, b] = fits.then(|| [before[cell - offset], before[cell + offset]])?;
                ((a - own).abs() <= max_step && (b - own).abs() <= max_step).then_some(0.5 * (a + b))
            };
            let across = pair(x >= stride && x + stride < grid.width, stride);
            let down = pair(y >= stride && y + stride < grid.height, stride * grid.width);
            let evened = match (across, down) {
                (Some(a), Some(b)) => 0.5 * (a + b),
                (Some(value), None) | (None, Some(value)) => value,
                (None, None) => own,
            };
            let half = 0.5 * level;
            if own.is_nan() { own } else { evened.clamp(rounded[cell] - half, rounded[cell] + half) }
        });
        *disparity = next.collect();
    }
}

/// The distance between two levels, if numbers were rounded: the median step between neighbours that differ.
fn level(grid: Grid, disparity: &[f32], jump: f32) -> Option<f32> {
    let (mut same, mut steps) = (0usize, Vec::new());
    for cell in 0..grid.count() {
        if (cell + 1) % grid.width == 0 {
            continue;
        }
        let step = (disparity[cell + 1] - disparity[cell]).abs();
        if step == 0.0 {
            same += 1;
        } else if step <= jump {
            steps.push(step);
        }
    }
    let all = same + steps.len();
    if steps.is_empty() || (same as f64) < SAME * all as f64 {
        return None;
    }
    upper_median(&mut steps)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stairs_become_the_slope_that_was_rounded_and_jumps_stay() {
        let grid = Grid { width: 120, height: 40 };
        let slope = |x: usize, y: usize| if x < 60 { 0.013 * x as f32 + 0.004 * y as f32 } else { 3.0 };
        let exact: Vec<f32> = (0..grid.count()).map(|cell| slope(cell % 120, cell / 120)).collect();
        let mut rounded: Vec<f32> = exact.iter().map(|d| (d / 0.2).round() * 0.2).collect();
        let squared_error =
            |values: &[f32]| values.iter().zip(&exact).map(|(a, b)| (a - b).powi(2)).sum::<f32>();
        let before = squared_error(&rounded);
        smooth_rounding(grid, &mut rounded, 1.0);
        assert!(squared_error(&rounded) < 0.1 * before, "{} of {before}", squared_error(&rounded));
        assert_eq!(rounded[grid.at(90, 20)], 3.0);
        // What was not rounded stays as it is.
        let mut fine = exact.clone();
        let bent: Vec<f32> =
            exact.iter().enumerate().map(|(k, d)| d + 0.01 * (k as f32 * 0.7).sin()).collect();
        fine.copy_from_slice(&bent);
        smooth_rounding(grid, &mut fine, 1.0);
        assert_eq!(fine[..60], bent[..60]);
    }
}
