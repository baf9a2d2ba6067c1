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
/// A scattered thirty-two of the cells are asked first; a patch that none of them sees is taken as hidden. One of which a
/// tenth is visible is so missed in three cases of a hundred.
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
    let mut words = vec![0u64; side * side / 64];
    let mut open = 0;
    let stride = side * side / 32;
    let is_scattered = |row: usize, column: usize| (column + row * ((stride / 2) | 1)).is_multiple_of(stride);
    for first_pass in [true, false] {
        for (row, column) in (0..side * side).map(|cell| (cell / side, cell % side)) {
            if is_scattered(row, column) != first_pass {
                continue;
            }
            let cell = row * side + column;
            let [jx, jy, pick] = jitter(seed[0], seed[1], cell as u32);
            let u = DVec2::new(column as f64 + jx, row as f64 + jy) * (2.0 / side as f64) - 1.0;
            if is_on_side(u) && sees(tracer, view, pick_member(members, pick), u) {
                words[cell / 64] |= 1 << (cell % 64);
                open += 1;
            }
        }
        if open == 0 {
            return None;
        }
    }
    Some(if open == side * side { Visibility::Open } else { Visibility::Cells(words.into()) })
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
