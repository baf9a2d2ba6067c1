//! Aggregation of costs: semi-global matching.
//!
//! Along eight directions through the picture the cost of a label is that of the best path that ends there, where a step to the
//! next label costs `small` and a larger one `large`, less at edges of the picture (Hirschmüller, *Stereo Processing by Semiglobal
//! Matching and Mutual Information*, PAMI 2008, equations 13 and 14):
//!
//! ```text
//! L(p, l) = C(p, l) + min(L(q, l), L(q, l ± 1) + small, min L(q) + large) − min L(q)
//! ```
//!
//! Four of the directions come from above or the left, four from below or the right: two passes that run in parallel.

use crate::matching::sweep::{CostVolume, FULL_COST};
use crate::planes::Planes;
use progress::{Cancelled, Progress};

/// The costs of steps between labels.
#[derive(Clone, Copy, Debug)]
pub struct Penalties {
    /// To the next label, as a share of [`FULL_COST`].
    pub small: f32,
    /// To one farther away, as a share of [`FULL_COST`], where the picture has no edge.
    pub large: f32,
    /// The difference of colours (sum of three channels) that halves `large`.
    pub edge: f32,
}

impl Default for Penalties {
    fn default() -> Self {
        Self { small: 0.01, large: 0.4, edge: 0.06 }
    }
}

/// The aggregated costs of a volume: the sum of eight directions, laid out as `volume.costs`.
///
/// # Errors
/// [`Cancelled`] if `progress` asks to stop.
pub fn aggregate(
    volume: &CostVolume,
    guide: &Planes,
    penalties: &Penalties,
    progress: &dyn Progress,
) -> Result<Vec<i16>, Cancelled> {
    let (down, up) = rayon::join(
        || pass(volume, guide, penalties, PassDirection::Down, progress),
        || pass(volume, guide, penalties, PassDirection::Up, progress),
    );
    let (mut down, up) = (down?, up?);
    down.iter_mut().zip(&up).for_each(|(sum, other)| *sum += other);
    Ok(down)
}

#[derive(Clone, Copy, PartialEq)]
enum PassDirection {
    Down,
    Up,
}

/// More than any path costs, and far from the largest i16.
const WALL: i16 = 12_000;

/// The sum of four directions: along the row, and from the previous row straight and diagonally from both sides.
fn pass(
    volume: &CostVolume,
    guide: &Planes,
    penalties: &Penalties,
    direction: PassDirection,
    progress: &dyn Progress,
) -> Result<Vec<i16>, Cancelled> {
    let (width, height, labels) = (volume.width, volume.rows.len(), volume.labels);
    let stride = labels + 2;
    let mut sums = vec![0i16; volume.costs.len()];
    let path = || vec![WALL; stride * width];
    let mut before = [path(), path(), path()];
    let mut now = [path(), path(), path()];
    let mut along = [vec![WALL; stride], vec![WALL; stride]];
    // The least cost of each path.
    let mut least_before = [vec![0i16; width], vec![0i16; width], vec![0i16; width]];
    let mut least_now = least_before.clone();
    let step: isize = if direction == PassDirection::Down { 1 } else { -1 };
    let small = (penalties.small * FULL_COST) as i16;
    let large = |a: [f32; 3], b: [f32; 3]| {
        let difference: f32 = (0..3).map(|c| (a[c] - b[c]).abs()).sum();
        (penalties.large * FULL_COST / (1.0 + difference / penalties.edge)).max(1.5 * small as f32) as i16
    };
    for row in 0..height {
        progress.check()?;
        let y = if direction == PassDirection::Down { row } else { height - 1 - row };
        let mut least_along = 0;
        for column in 0..width {
            let x = if direction == PassDirection::Down { column } else { width - 1 - column };
            let at = (y * width + x) * labels;
            let costs = &volume.costs[at..at + labels];
            let sums = &mut sums[at..at + labels];
            let here = guide.pixel(x, volume.rows.start + y);
            let [old, new] = &mut along;
            if column == 0 {
                least_along = begin(costs, sums, new);
            } else {
                let neighbour = guide.pixel((x as isize - step) as usize, volume.rows.start + y);
                least_along = extend(costs, sums, old, least_along, new, small, large(here, neighbour));
            }
            std::mem::swap(old, new);
            for (k, side) in [-1isize, 0, 1].into_iter().enumerate() {
                let from = x as isize + side;
                let own = &mut now[k][x * stride..(x + 1) * stride];
                if row == 0 || from < 0 || from >= width as isize {
                    least_now[k][x] = begin(costs, sums, own);
                    continue;
                }
                let from = from as usize;
                let there = guide.pixel(from, (volume.rows.start as isize + y as isize - step) as usize);
                let old = &before[k][from * stride..(from + 1) * stride];
                least_now[k][x] =
                    extend(costs, sums, old, least_before[k][from], own, small, large(here, there));
            }
        }
        std::mem::swap(&mut before, &mut now);
        std::mem::swap(&mut least_before, &mut least_now);
    }
    Ok(sums)
}

/// Begins a path: it costs what its first pixel does.
fn begin(costs: &[i16], sums: &mut [i16], path: &mut [i16]) -> i16 {
    let path = &mut path[1..=costs.len()];
    path.copy_from_slice(costs);
    sums.iter_mut().zip(costs).for_each(|(sum, cost)| *sum += cost);
    costs.iter().copied().fold(WALL, i16::min)
}

/// Extends a path by a pixel; returns its least cost.
fn extend(
    costs: &[i16],
    sums: &mut [i16],
    old: &[i16],
    least: i16,
    new: &mut [i16],
    small: i16,
    large: i16,
) -> i16 {
    let n = costs.len();
    let (lower, same, upper) = (&old[..n], &old[1..=n], &old[2..n + 2]);
    let new = &mut new[1..=n];
    let (sums, jump) = (&mut sums[..n], least + large);
    let mut smallest = WALL;
    for i in 0..n {
        let neighbour = lower[i].min(upper[i]) + small;
        let value = costs[i] + same[i].min(neighbour).min(jump) - least;
        new[i] = value;
        sums[i] += value;
        smallest = smallest.min(value);
    }
    smallest
}
