//! A layer's triangles: as few as keep the surface within a tolerance.
//!
//! Right triangles are halved where the middle of their longest side is off (Evans, Kirkpatrick and Townsend 2001, right-triangulated
//! irregular networks; Lindstrom and Pascucci 2002). A corner counts as far off as what is halved beneath it, so that neighbours are halved
//! alike and nothing gapes. Corners at jumps are always there: all cells beneath a triangle hang together, and with those along its sides.
//!
//! A texture is laid on a triangle evenly in space, not as the picture shows it. Between ends a and b of inverse depths q the middle in
//! space is seen beside that in the picture, and that counts as off, too:
//!
//! ```text
//! |a − b|/2 · |q_a − q_b|/(q_a + q_b)
//! ```

use crate::cells::{Cells, Grid};
use crate::corners::Joint;
use rayon::prelude::*;

/// Corners of the picture's cells, in a square whose side is a power of two, and how far off each would be if it were not there.
pub(crate) struct Triangulation {
    grid: Grid,
    /// Cells of the square along a side.
    side: usize,
    errors: Vec<f32>,
}

/// A triangle: corners of the grid, the right angle last.
pub(crate) struct LayerTriangle {
    pub corners: [[usize; 2]; 3],
}

impl Triangulation {
    /// How far off the corners of a layer's cells are. Cells that are not whole have triangles of their own.
    pub fn new(
        cells: &Cells,
        layer: usize,
        metric: Metric,
        is_whole: &(dyn Fn(usize) -> bool + Sync),
    ) -> Self {
        let grid = cells.grid;
        let side = grid.width.max(grid.height).next_power_of_two().max(2);
        let row = grid.width + 1;
        let joints: Vec<f32> = (0..row * (grid.height + 1))
            .into_par_iter()
            .map(|corner| match cells.joint(layer, [corner % row, corner / row]) {
                Joint::Whole(disparity) => disparity,
                Joint::Cut => f32::NAN,
                Joint::Absent => 0.0,
            })
            .collect();
        let at = |x: usize, y: usize| match x <= grid.width && y <= grid.height {
            true => joints[y * row + x],
            false => 0.0,
        };
        // What a middle, and all up to it, hangs together with there.
        let end = |x: usize, y: usize, middle: [usize; 2]| {
            let joint = at(x, y);
            let of_cell = || cells.corner_at(layer, [x, y], [x > middle[0], y > middle[1]]);
            if joint.is_nan() { of_cell().map_or(joint, |corner| corner.disparity) } else { joint }
        };
        // Whether the cells around a corner are.
        let are_whole = |x: usize, y: usize| {
            let columns = x.saturating_sub(1)..(x + 1).min(grid.width);
            let mut rows = y.saturating_sub(1)..(y + 1).min(grid.height);
            rows.all(|y| columns.clone().all(|x| is_whole(grid.at(x, y))))
        };
        let mut errors = vec![0.0; (side + 1) * (side + 1)];
        errors.par_chunks_mut(side + 1).enumerate().for_each(|(y, errors)| {
            for (x, error) in errors.iter_mut().enumerate() {
                let is_needed = at(x, y).is_nan() || !are_whole(x, y);
                *error = if is_needed { f32::INFINITY } else { 0.0 };
            }
        });
        let mut step = 2;
        while step <= side {
            let half = step / 2;
            // Middles of sides of squares: what is beneath are the four squares of half the side around.
            let beneath = |errors: &[f32], x: usize, y: usize| {
                let quarter = half / 2;
                if quarter == 0 {
                    return 0.0;
                }
                let mut max_error = 0.0f32;
                for (dx, dy) in [(-1, -1), (1, -1), (-1, 1), (1, 1)] {
                    let (x, y) = (x as isize + dx * quarter as isize, y as isize + dy * quarter as isize);
                    if (0..=side as isize).contains(&x) && (0..=side as isize).contains(&y) {
                        max_error = max_error.max(errors[y as usize * (side + 1) + x as usize]);
                    }
                }
                max_error
            };
            let before = &errors;
            let sides: Vec<Vec<(usize, f32)>> = (0..=side / half)
                .into_par_iter()
                .map(|line| {
                    let y = line * half;
                    let first = if line % 2 == 0 { half } else { 0 };
                    let mut line_errors = Vec::new();
                    for x in (first..=side).step_by(step) {
                        let ends = if line % 2 == 0 {
                            [end(x - half, y, [x, y]), end(x + half, y, [x, y])]
                        } else {
                            [end(x, y - half, [x, y]), end(x, y + half, [x, y])]
                        };
                        let error = metric.deviation(at(x, y), ends, step as f32);
                        line_errors.push((y * (side + 1) + x, error.max(beneath(before, x, y))));
                    }
                    line_errors
                })
                .collect();
            raise(&mut errors, sides);
            // Middles of squares: what is beneath are the middles of their four sides.
            let before = &errors;
            let middles: Vec<Vec<(usize, f32)>> = (0..side / step)
                .into_par_iter()
                .map(|line| {
                    let y = line * step + half;
                    let mut line_errors = Vec::new();
                    for column in 0..side / step {
                        let x = column * step + half;
                        let end = |x: usize, y: usize| end(x, y, [column * step + half, line * step + half]);
                        let ends = match (column + line) % 2 {
                            0 => [end(x - half, y - half), end(x + half, y + half)],
                            _ => [end(x + half, y - half), end(x - half, y + half)],
                        };
                        let sides = [(x - half, y), (x + half, y), (x, y - half), (x, y + half)];
                        let max_error =
                            sides.iter().fold(0.0f32, |max, &(x, y)| max.max(before[y * (side + 1) + x]));
                        let error = metric.deviation(at(x, y), ends, step as f32 * std::f32::consts::SQRT_2);
                        line_errors.push((y * (side + 1) + x, error.max(max_error)));
                    }
                    line_errors
                })
                .collect();
            raise(&mut errors, middles);
            step *= 2;
        }
        Self { grid, side, errors }
    }

    /// The triangles that stay within a tolerance, in the picture. All cells beneath one are there, or none.
    pub fn triangles(&self, tolerance: f32) -> Vec<LayerTriangle> {
        let side = self.side;
        let mut triangles = Vec::new();
        let mut open = vec![([0, 0], [side, side], [side, 0]), ([side, side], [0, 0], [0, side])];
        while let Some((a, b, apex)) = open.pop() {
            let least =
                [a, b, apex].into_iter().fold([usize::MAX; 2], |low, p| [low[0].min(p[0]), low[1].min(p[1])]);
            if least[0] >= self.grid.width || least[1] >= self.grid.height {
                continue;
            }
            let is_smallest = a[0].abs_diff(b[0]).max(a[1].abs_diff(b[1])) == 1;
            let middle = [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
            let error = || self.errors[middle[1] * (side + 1) + middle[0]];
            if !is_smallest && error() > tolerance {
                open.push((apex, a, middle));
                open.push((b, apex, middle));
            } else {
                triangles.push(LayerTriangle { corners: [a, b, apex] });
            }
        }
        triangles
    }
}

/// What counts as off, in pixels.
#[derive(Clone, Copy)]
pub(crate) struct Metric {
    /// Parallax of a disparity of 1, px.
    pub reach: f32,
    /// What makes disparities proportional to inverse depth when it is added.
    pub offset: f32,
}

impl Metric {
    /// How far a middle is from what its ends lead to expect, which are so many pixels apart; nothing where one of them is cut, which is
    /// seen to elsewhere.
    fn deviation(self, middle: f32, [a, b]: [f32; 2], length: f32) -> f32 {
        let depth = (0.5 * (a + b) - middle).abs() * self.reach;
        let nearness = a + b + 2.0 * self.offset;
        let texture_shift = if nearness > 0.0 { 0.5 * length * (a - b).abs() / nearness } else { 0.0 };
        let deviation = depth.max(texture_shift);
        if deviation.is_nan() { 0.0 } else { deviation }
    }
}

fn raise(errors: &mut [f32], raised: Vec<Vec<(usize, f32)>>) {
    for (number, error) in raised.into_iter().flatten() {
        errors[number] = errors[number].max(error);
    }
}
