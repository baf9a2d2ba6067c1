//! The triangles of a layer: as few as keep the surface within a tolerance.
//!
//! Right triangles are halved where the middle of their longest side has too large an error (Evans, Kirkpatrick and Townsend 2001,
//! right-triangulated irregular networks; Lindstrom and Pascucci 2002). The error of a corner is at least that of the corners of its
//! halves, so that neighbours are halved alike and there are no cracks. Corners at jumps are always used: all cells beneath a triangle
//! are connected, and to those along its sides.
//!
//! A texture is interpolated on a triangle linearly in space, not in the picture. Between ends a and b of inverse depths q the middle in
//! space is not that in the picture, which is an error, too:
//!
//! ```text
//! |a − b|/2 · |q_a − q_b|/(q_a + q_b)
//! ```

use crate::mesh::cells::{Cells, Grid};
use crate::mesh::corners::Joint;
use rayon::prelude::*;

/// A picture whose sides' powers of two differ by this factor is covered by several squares: one would be many times as large as it is.
const ELONGATED: usize = 4;

/// Corners of the picture's cells, in squares side by side whose side is a power of two, and the error of omitting each.
pub(crate) struct Triangulation {
    grid: Grid,
    /// Number of cells along a side of a square.
    side: usize,
    /// Number of cells along the sides of all squares together.
    extent: [usize; 2],
    errors: Vec<f32>,
}

/// A triangle: corners of the grid, the right angle last.
pub(crate) struct LayerTriangle {
    pub corners: [[usize; 2]; 3],
}

impl Triangulation {
    /// The errors of the corners of a layer's cells. Cells that are not whole have triangles of their own.
    pub fn new(
        cells: &Cells,
        layer: usize,
        metric: Metric,
        is_whole: &(dyn Fn(usize) -> bool + Sync),
    ) -> Self {
        let grid = cells.grid;
        let (side, extent) = squares([grid.width, grid.height]);
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
        // The disparity at the end of a side, of the point that its middle is connected to there.
        let end = |x: usize, y: usize, middle: [usize; 2]| {
            let joint = at(x, y);
            let of_cell = || cells.corner_at(layer, [x, y], [x > middle[0], y > middle[1]]);
            if joint.is_nan() { of_cell().map_or(joint, |corner| corner.disparity) } else { joint }
        };
        // Whether the cells around a corner are whole.
        let are_whole = |x: usize, y: usize| {
            let columns = x.saturating_sub(1)..(x + 1).min(grid.width);
            let mut rows = y.saturating_sub(1)..(y + 1).min(grid.height);
            rows.all(|y| columns.clone().all(|x| is_whole(grid.at(x, y))))
        };
        let corners = extent[0] + 1;
        let mut errors = vec![0.0; corners * (extent[1] + 1)];
        errors.par_chunks_mut(corners).enumerate().for_each(|(y, errors)| {
            for (x, error) in errors.iter_mut().enumerate() {
                let is_needed = at(x, y).is_nan() || !are_whole(x, y);
                *error = if is_needed { f32::INFINITY } else { 0.0 };
            }
        });
        let mut step = 2;
        while step <= side {
            let half = step / 2;
            // Middles of sides of squares: beneath are the four squares of half the side around.
            let beneath = |errors: &[f32], x: usize, y: usize| {
                let quarter = half / 2;
                if quarter == 0 {
                    return 0.0;
                }
                let mut max_error = 0.0f32;
                for (dx, dy) in [(-1, -1), (1, -1), (-1, 1), (1, 1)] {
                    let (x, y) = (x as isize + dx * quarter as isize, y as isize + dy * quarter as isize);
                    if (0..=extent[0] as isize).contains(&x) && (0..=extent[1] as isize).contains(&y) {
                        max_error = max_error.max(errors[y as usize * corners + x as usize]);
                    }
                }
                max_error
            };
            let before = &errors;
            let sides: Vec<Vec<(usize, f32)>> = (0..=extent[1] / half)
                .into_par_iter()
                .map(|line| {
                    let y = line * half;
                    let first = if line % 2 == 0 { half } else { 0 };
                    let mut line_errors = Vec::new();
                    for x in (first..=extent[0]).step_by(step) {
                        let ends = if line % 2 == 0 {
                            [end(x - half, y, [x, y]), end(x + half, y, [x, y])]
                        } else {
                            [end(x, y - half, [x, y]), end(x, y + half, [x, y])]
                        };
                        let error = metric.deviation(at(x, y), ends, step as f32);
                        line_errors.push((y * corners + x, error.max(beneath(before, x, y))));
                    }
                    line_errors
                })
                .collect();
            raise(&mut errors, sides);
            // Middles of squares: beneath are the middles of their four sides.
            let before = &errors;
            let middles: Vec<Vec<(usize, f32)>> = (0..extent[1] / step)
                .into_par_iter()
                .map(|line| {
                    let y = line * step + half;
                    let mut line_errors = Vec::new();
                    for column in 0..extent[0] / step {
                        let x = column * step + half;
                        let end = |x: usize, y: usize| end(x, y, [column * step + half, line * step + half]);
                        let ends = match (column + line) % 2 {
                            0 => [end(x - half, y - half), end(x + half, y + half)],
                            _ => [end(x + half, y - half), end(x - half, y + half)],
                        };
                        let sides = [(x - half, y), (x + half, y), (x, y - half), (x, y + half)];
                        let max_error =
                            sides.iter().fold(0.0f32, |max, &(x, y)| max.max(before[y * corners + x]));
                        let error = metric.deviation(at(x, y), ends, step as f32 * std::f32::consts::SQRT_2);
                        line_errors.push((y * corners + x, error.max(max_error)));
                    }
                    line_errors
                })
                .collect();
            raise(&mut errors, middles);
            step *= 2;
        }
        Self { grid, side, extent, errors }
    }

    /// The triangles within a tolerance, in the picture. All cells beneath one exist, or none.
    pub fn triangles(&self, tolerance: f32) -> Vec<LayerTriangle> {
        let Self { side, extent, .. } = *self;
        let mut triangles = Vec::new();
        // Halves of each square; the longest side leans one way in every second one, as those of the squares in it do.
        let mut open = Vec::new();
        for (row, y) in (0..extent[1]).step_by(side).enumerate() {
            for (column, x) in (0..extent[0]).step_by(side).enumerate() {
                let [least, right, low, most] = [[x, y], [x + side, y], [x, y + side], [x + side, y + side]];
                open.extend(match (row + column) % 2 {
                    0 => [(least, most, right), (most, least, low)],
                    _ => [(low, right, least), (right, low, most)],
                });
            }
        }
        while let Some((a, b, apex)) = open.pop() {
            let least =
                [a, b, apex].into_iter().fold([usize::MAX; 2], |low, p| [low[0].min(p[0]), low[1].min(p[1])]);
            if least[0] >= self.grid.width || least[1] >= self.grid.height {
                continue;
            }
            let is_smallest = a[0].abs_diff(b[0]).max(a[1].abs_diff(b[1])) == 1;
            let middle = [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
            let error = || self.errors[middle[1] * (extent[0] + 1) + middle[0]];
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

/// The side of the squares that cover so many columns and rows of cells, and how many cells they have together along each side.
fn squares(cells: [usize; 2]) -> (usize, [usize; 2]) {
    let [narrow, long] =
        [cells[0].min(cells[1]), cells[0].max(cells[1])].map(|n| n.next_power_of_two().max(2));
    let side = if long < ELONGATED * narrow { long } else { narrow };
    (side, cells.map(|count| count.max(1).next_multiple_of(side)))
}

/// The error measure, in pixels.
#[derive(Clone, Copy)]
pub(crate) struct Metric {
    /// Parallax of a disparity of 1, px.
    pub reach: f32,
    /// The offset that makes disparities proportional to inverse depth.
    pub offset: f32,
}

impl Metric {
    /// The deviation of a middle from the interpolation of its ends, which are `length` pixels apart; 0 where one of them is cut, which is
    /// handled elsewhere.
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
