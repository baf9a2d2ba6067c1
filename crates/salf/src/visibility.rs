//! What of the aperture a patch of surface sees: a ray a cell of the aperture.

use crate::jitter::jitter;
use crate::layers::Member;
use crate::sample::Visibility;
use crate::view::View;
use glam::DVec2;
use trace::{Ray, Tracer};

/// Cells a side for a point of inverse depth `inverse_depth`.
pub fn cells_a_side(view: &View, inverse_depth: f64) -> usize {
    let kappa = view.optics.standard_kappa(inverse_depth);
    if view.optics.circle_of_confusion_px(kappa) <= 8.0 * view.tolerance_px { 8 } else { 16 }
}

/// The cells of the aperture that a patch sees: one jittered ray each, from a random member. `None` if it sees none.
///
/// A scattered thirty-two of an 8 × 8 grid are asked first; a patch that none of them sees is taken as hidden. One of which
/// a tenth is visible is so missed in three cases of a hundred. Then the rest of the grid is asked; of a field of 16 × 16
/// cells each place of the grid stands for four, and those are asked one by one only where the grid's neighbours
/// disagree: along the outlines of what occludes the patch.
///
/// `is_on_side` tells which aperture points lie on the side of the surface that the patch stands for.
pub fn visibility(
    tracer: &Tracer,
    view: &View,
    members: &[Member],
    side: usize,
    seed: [u32; 2],
    is_on_side: impl Fn(DVec2) -> bool,
) -> Option<Visibility> {
    let is_seen = |side: usize, row: usize, column: usize, [jx, jy, pick]: [f64; 3]| {
        let u = DVec2::new(column as f64 + jx, row as f64 + jy) * (2.0 / side as f64) - 1.0;
        is_on_side(u) && sees(tracer, view, pick_member(members, pick), u)
    };
    let jitter_of = |index: usize| jitter(seed[0], seed[1], index as u32);
    let is_scattered = |row: usize, column: usize| (column + row).is_multiple_of(2);
    let mut grid = 0u64;
    for first_pass in [true, false] {
        for (row, column) in (0..64).map(|k| (k / GRID, k % GRID)) {
            if is_scattered(row, column) == first_pass
                && is_seen(GRID, row, column, jitter_of(row * GRID + column))
            {
                grid |= 1 << (row * GRID + column);
            }
        }
        if grid == 0 {
            return None;
        }
    }
    if side == GRID {
        let all = grid == u64::MAX;
        return Some(if all { Visibility::Open } else { Visibility::Cells([grid].into()) });
    }
    let mut words = vec![0u64; 4];
    for (row, column) in (0..64).map(|k| (k / GRID, k % GRID)) {
        let bit = grid >> (row * GRID + column) & 1 == 1;
        let agree = neighbours_agree(grid, row, column);
        let [jx, jy, _] = jitter_of(row * GRID + column);
        // The cell that the grid's ray went through needs no other.
        let asked = 2 * usize::from(jy >= 0.5) + usize::from(jx >= 0.5);
        for quarter in 0..4 {
            let (row, column) = (2 * row + quarter / 2, 2 * column + quarter % 2);
            let index = row * side + column;
            let is_open = if agree || quarter == asked {
                bit
            } else {
                is_seen(side, row, column, jitter_of(64 + index))
            };
            words[index / 64] |= u64::from(is_open) << (index % 64);
        }
    }
    let all = words.iter().all(|&word| word == u64::MAX);
    Some(if all { Visibility::Open } else { Visibility::Cells(words.into()) })
}

/// Cells a side of the first look.
const GRID: usize = 8;

/// Whether a place of a grid and those around it are all open or all closed.
fn neighbours_agree(grid: u64, row: usize, column: usize) -> bool {
    let bit = grid >> (row * GRID + column) & 1;
    let around = |k: usize| k.saturating_sub(1)..(k + 2).min(GRID);
    around(row).all(|row| around(column).all(|column| grid >> (row * GRID + column) & 1 == bit))
}

fn pick_member(members: &[Member], pick: f64) -> &Member {
    &members[(pick * members.len() as f64) as usize]
}

/// Whether nothing stands between a member and the aperture point R·u.
fn sees(tracer: &Tracer, view: &View, member: &Member, u: DVec2) -> bool {
    let aperture_point = view.aperture_point(u);
    match member.point {
        Some(point) => !tracer.occluded(point, aperture_point),
        None => !tracer.any_hit(&Ray { origin: aperture_point, ..view.chief_ray(member.pixel) }),
    }
}
