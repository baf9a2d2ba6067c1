//! Jumps of depth, and pixels that lie between two depths.
//!
//! A step of disparity is a jump if it is more than a parallax of [`ReliefOptions::jump_px`](crate::ReliefOptions) and not part of a slope,
//! where the adjacent steps are about as large. Single pixels between two depths (the blurred edge of a depth map) are no surface: each is
//! assigned to the side whose colour it has.

use crate::mesh::cells::{Grid, Links, Side};
use rayon::prelude::*;

/// Adjacent steps of at least this share of a step make it a slope.
const SLOPE: f32 = 0.5;
/// The most pixels over which edges of depth maps are blurred.
const BLURRED: usize = 2;

/// Assigns pixels that lie between two depths to one side. `jump` is the least step of disparity that is a jump.
pub(crate) fn snap(grid: Grid, disparity: &mut Vec<f32>, colors: &[[f32; 3]], jump: f32) {
    for _ in 0..BLURRED {
        let before = disparity.clone();
        disparity.par_iter_mut().enumerate().for_each(|(cell, disparity)| {
            if let Some(other) = side_of(grid, &before, colors, jump, cell) {
                *disparity = before[other];
            }
        });
    }
}

/// The neighbour to whose depth a pixel belongs, if it lies between two depths.
fn side_of(grid: Grid, disparity: &[f32], colors: &[[f32; 3]], jump: f32, cell: usize) -> Option<usize> {
    let (x, y) = (cell % grid.width, cell / grid.width);
    let across = (x > 0 && x + 1 < grid.width).then(|| [cell - 1, cell + 1]);
    let down = (y > 0 && y + 1 < grid.height).then(|| [cell - grid.width, cell + grid.width]);
    let between = |[first, second]: &[usize; 2]| {
        let (a, b) = (disparity[cell] - disparity[*first], disparity[*second] - disparity[cell]);
        // Both of one sign, together a jump, and neither side continues like that.
        let is_alone = |from: usize, to: usize, step: f32| {
            let beyond = to as isize + to as isize - from as isize;
            let is_in = beyond >= 0 && (beyond as usize) < grid.count();
            !is_in || (disparity[beyond as usize] - disparity[to]).abs() < SLOPE * step.abs()
        };
        a * b > 0.0 && (a + b).abs() > jump && is_alone(cell, *first, a) && is_alone(cell, *second, b)
    };
    let ends = across.filter(between).or(down.filter(between))?;
    let far = |other: usize| {
        let [a, b] = [colors[cell], colors[other]];
        (0..3).map(|c| (a[c].max(0.0).sqrt() - b[c].max(0.0).sqrt()).powi(2)).sum::<f32>()
    };
    Some(if far(ends[0]) <= far(ends[1]) { ends[0] } else { ends[1] })
}

/// Connections: between neighbours whose depth does not jump.
pub(crate) fn links(grid: Grid, disparity: &[f32], jump: f32) -> Links {
    let mut links = Links::none(grid);
    for cell in 0..grid.count() {
        for side in [Side::Right, Side::Below] {
            if hangs_together(grid, disparity, jump, cell, side) {
                links.set(cell, side, true);
            }
        }
    }
    links
}

fn hangs_together(grid: Grid, disparity: &[f32], jump: f32, cell: usize, side: Side) -> bool {
    let (x, y) = ((cell % grid.width) as isize, (cell / grid.width) as isize);
    let (dx, dy) = if side == Side::Right { (1, 0) } else { (0, 1) };
    let at = |k: isize| {
        let (x, y) = (x + k * dx, y + k * dy);
        let is_in = x >= 0 && y >= 0 && x < grid.width as isize && y < grid.height as isize;
        is_in.then(|| disparity[grid.at(x as usize, y as usize)]).filter(|d| !d.is_nan())
    };
    let step = |k: isize| Some(at(k + 1)? - at(k)?);
    let Some(here) = step(0) else { return false };
    if here.abs() <= jump {
        return true;
    }
    let continues =
        |k: isize| step(k).is_some_and(|step| step * here > 0.0 && step.abs() >= SLOPE * here.abs());
    (continues(-1) && continues(1)) || (continues(-1) && continues(-2)) || (continues(1) && continues(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(values: &[f32]) -> (Grid, Vec<f32>) {
        (Grid { width: values.len(), height: 1 }, values.to_vec())
    }

    fn linked(values: &[f32]) -> Vec<bool> {
        let (grid, disparity) = row(values);
        let links = links(grid, &disparity, 0.2);
        (0..values.len() - 1).map(|cell| links.has(cell, Side::Right)).collect()
    }

    #[test]
    fn a_jump_is_cut_and_a_slope_is_not() {
        assert_eq!(linked(&[0.0, 0.0, 1.0, 1.0]), [true, false, true]);
        assert_eq!(linked(&[0.0, 0.5, 1.0, 1.5, 2.0]), [true; 4]);
        assert_eq!(linked(&[0.0, 0.0, 0.5, 1.0, 1.5, 1.5]), [true; 5], "a slope between two planes");
        assert_eq!(linked(&[0.0, 0.1, 0.2]), [true; 2], "less than a jump");
        assert_eq!(linked(&[0.0, f32::NAN, 0.0]), [false; 2]);
    }

    #[test]
    fn a_pixel_between_is_assigned_to_the_side_of_its_colour() {
        let (grid, mut disparity) = row(&[0.0, 0.0, 0.6, 1.0, 1.0]);
        let colors = [0.1, 0.1, 0.15, 0.9, 0.9].map(|v| [v; 3]);
        snap(grid, &mut disparity, &colors, 0.2);
        assert_eq!(disparity, [0.0, 0.0, 0.0, 1.0, 1.0]);
        // A slope is left as it is.
        let (grid, mut slope) = row(&[0.0, 0.5, 1.0, 1.5, 2.0]);
        snap(grid, &mut slope, &colors, 0.2);
        assert_eq!(slope, [0.0, 0.5, 1.0, 1.5, 2.0]);
    }
}
