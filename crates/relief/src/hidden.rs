//! Continuation of surfaces behind their occluders.
//!
//! Where depth jumps, the farther side is continued behind the nearer one, as far as the rim of the aperture can see behind it: behind a
//! cell of disparity d, a surface of disparity d′ by a parallax of d − d′.

use crate::mesh::cells::{Grid, Links, side_index};
use std::collections::VecDeque;

/// Cells beyond those that are visible through the aperture, so that resampling there has neighbours.
const MARGIN: f32 = 2.0;
/// Rounds of smoothing of the continuation.
const ROUNDS: usize = 24;

/// The second layer.
pub(crate) struct HiddenLayer {
    /// Disparity of each cell; NaN where nothing hidden is needed.
    pub disparity: Vec<f32>,
    pub links: Links,
    /// For each cell, on which sides (left, right, above, below) it continues a cell of the first layer.
    pub onward: Vec<[bool; 4]>,
    /// The cells, from the jumps inward.
    pub order: Vec<usize>,
}

/// Continues what lies behind jumps. `reach` is the aperture's radius (disparity times it is a parallax, px), `jump` the least step of
/// disparity that is a jump, `further` the number of additional cells.
pub(crate) fn continue_hidden(
    grid: Grid,
    front: &[f32],
    links: &Links,
    reach: f32,
    further: f32,
    jump: f32,
) -> HiddenLayer {
    let mut disparity = vec![f32::NAN; grid.count()];
    let mut distance = vec![u32::MAX; grid.count()];
    let mut onward = vec![[false; 4]; grid.count()];
    let mut queue = VecDeque::new();
    // A cell behind continues beneath its neighbour in front.
    for cell in 0..grid.count() {
        for (side, other) in grid.around(cell) {
            let is_before = front[cell] - front[other] > jump;
            if links.has(cell, side) || !is_before {
                continue;
            }
            onward[cell][side_index(side)] = true;
            if distance[cell] != 1 {
                distance[cell] = 1;
                queue.push_back(cell);
                disparity[cell] = front[other];
            } else {
                // Several surfaces continue here: the farthest is behind all.
                disparity[cell] = disparity[cell].min(front[other]);
            }
        }
    }
    let mut order = Vec::new();
    while let Some(cell) = queue.pop_front() {
        order.push(cell);
        let behind = disparity[cell];
        for (side, other) in grid.around(cell) {
            let parallax = (front[other] - behind) * reach;
            let is_behind = front[other] - behind > jump && links.has(cell, side);
            if is_behind
                && distance[other] == u32::MAX
                && distance[cell] as f32 <= parallax + MARGIN + further
            {
                distance[other] = distance[cell] + 1;
                disparity[other] = behind;
                queue.push_back(other);
            }
        }
    }
    even_out(grid, front, &onward, &order, &mut disparity, jump);
    let mut own_links = Links::none(grid);
    for &cell in &order {
        for (side, other) in grid.around(cell) {
            if !disparity[other].is_nan() && (disparity[other] - disparity[cell]).abs() <= jump {
                own_links.set(cell, side, true);
            }
        }
        // It continues only from what it still lies next to.
        for (side, other) in grid.around(cell) {
            let is_beside = onward[cell][side_index(side)] && (front[other] - disparity[cell]).abs() <= jump;
            onward[cell][side_index(side)] = is_beside;
        }
    }
    HiddenLayer { disparity, links: own_links, onward, order }
}

/// A membrane between the jumps from which it continues.
fn even_out(
    grid: Grid,
    front: &[f32],
    onward: &[[bool; 4]],
    order: &[usize],
    disparity: &mut [f32],
    jump: f32,
) {
    for _ in 0..ROUNDS {
        let next: Vec<f32> = order
            .iter()
            .map(|&cell| {
                let own = disparity[cell];
                let (mut sum, mut count) = (0.0, 0.0);
                for (side, other) in grid.around(cell) {
                    let neighbour =
                        if onward[cell][side_index(side)] { front[other] } else { disparity[other] };
                    if (neighbour - own).abs() <= jump {
                        sum += neighbour;
                        count += 1.0;
                    }
                }
                if count > 0.0 { sum / count } else { own }
            })
            .collect();
        for (&cell, next) in order.iter().zip(next) {
            // It stays behind its occluder.
            disparity[cell] = next.min(front[cell] - jump);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::edges::jumps;

    #[test]
    fn a_wall_continues_behind_a_card_as_far_as_the_aperture_sees() {
        let grid = Grid { width: 40, height: 9 };
        let front: Vec<f32> =
            (0..grid.count()).map(|cell| if (15..30).contains(&(cell % 40)) { 2.0 } else { 0.5 }).collect();
        let links = jumps::links(grid, &front, 0.25);
        let hidden = continue_hidden(grid, &front, &links, 2.0, 0.0, 0.25);
        // 1.5 of disparity by a radius of 2 and the margin: six cells from either side of the card.
        let row: Vec<usize> = (0..40).filter(|&x| !hidden.disparity[grid.at(x, 4)].is_nan()).collect();
        assert_eq!(row, [15, 16, 17, 18, 19, 20, 24, 25, 26, 27, 28, 29]);
        assert!(row.iter().all(|&x| (hidden.disparity[grid.at(x, 4)] - 0.5).abs() < 1e-6));
        assert!(hidden.onward[grid.at(15, 4)][0] && hidden.onward[grid.at(29, 4)][1]);
        assert!(!hidden.onward[grid.at(16, 4)][0]);
    }
}
