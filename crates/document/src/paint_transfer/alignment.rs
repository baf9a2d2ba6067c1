//! Alignment: the rigid motion from a node's new surface to its old one.
//!
//! An object may have been moved by its node's transform or by its vertices, or not at all. All candidates are tried, and the one that brings
//! the surfaces closest is used; a simpler motion is preferred unless another is clearly closer.

use crate::paint_transfer::old_surface::OldSurface;
use glam::{DMat3, DMat4, DQuat, DVec3};

/// Number of points at which the distance of the surfaces is measured.
pub(crate) const SAMPLE_COUNT: usize = 256;

/// A motion is preferred to a simpler one only if the distance of the surfaces is less than this share of that of the simpler one.
const MAX_DISTANCE_RATIO: f64 = 0.5;

/// Surfaces closer than this share of their extent coincide.
const COINCIDENT_SHARE: f64 = 1e-5;

/// Surfaces within this share of their extent are the same surface in another mesh.
const ALIGNED_SHARE: f64 = 0.01;

/// Maximum number of iterations of ICP.
const MAX_ICP_ITERATIONS: usize = 60;

/// Points of a surface: positions and unit normals.
pub(crate) type OrientedPoints = [(DVec3, DVec3)];

/// The motion from the new to the old world space. Tried are, in this order, the identity, the `candidates`, the shift between the `centers` of
/// the old and the new surface, and rotations about them, refined by ICP. `extent` is the length of the old surface's diagonal.
pub(crate) fn align(
    old: &OldSurface,
    new: &OrientedPoints,
    candidates: &[DMat4],
    centers: [DVec3; 2],
    extent: f64,
) -> DMat4 {
    let center_shift = DMat4::from_translation(centers[0] - centers[1]);
    let mut best = (DMat4::IDENTITY, mean_distance(old, new, &DMat4::IDENTITY, extent));
    let keep_closer = |best: (DMat4, f64), motion: DMat4| {
        let distance = mean_distance(old, new, &motion, extent);
        let is_closer = best.1 > COINCIDENT_SHARE * extent && distance < MAX_DISTANCE_RATIO * best.1;
        if is_closer { (motion, distance) } else { best }
    };
    best = candidates.iter().copied().chain([center_shift]).fold(best, keep_closer);
    if best.1 <= ALIGNED_SHARE * extent {
        return best.0;
    }
    // Rotations about the centre by multiples of 90°, as when axes were exchanged, each refined.
    let rotations = axis_rotations().map(|rotation| {
        DMat4::from_translation(centers[0])
            * DMat4::from_mat3(rotation)
            * DMat4::from_translation(-centers[1])
    });
    rotations.map(|rotation| refine_icp(old, new, rotation, extent)).fold(best, keep_closer).0
}

/// The mean distance of the moved points from the old surface; a point without a corresponding one counts with the extent.
fn mean_distance(old: &OldSurface, new: &OrientedPoints, motion: &DMat4, extent: f64) -> f64 {
    let distance = |(position, normal): &(DVec3, DVec3)| {
        let normal = motion.transform_vector3(*normal).normalize_or_zero();
        old.nearest(motion.transform_point3(*position), normal, extent)
            .map_or(extent, |nearest| nearest.distance)
    };
    new.iter().map(distance).sum::<f64>() / new.len().max(1) as f64
}

/// The 24 rotations that map coordinate axes to coordinate axes.
fn axis_rotations() -> impl Iterator<Item = DMat3> {
    let axes = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
    let pairs = axes.into_iter().flat_map(move |x| axes.into_iter().map(move |y| (x, y)));
    pairs.filter(|(x, y)| x.dot(*y) == 0.0).map(|(x, y)| DMat3::from_cols(x, y, x.cross(y)))
}

/// Refines a motion by the iterative closest point algorithm (Besl and McKay 1992), with the best rotation of each iteration from quaternions
/// (Horn 1987).
fn refine_icp(old: &OldSurface, new: &OrientedPoints, mut motion: DMat4, extent: f64) -> DMat4 {
    for _ in 0..MAX_ICP_ITERATIONS {
        let pair = |(position, normal): &(DVec3, DVec3)| {
            let (moved_point, normal) =
                (motion.transform_point3(*position), motion.transform_vector3(*normal));
            old.nearest(moved_point, normal.normalize_or_zero(), extent)
                .map(|nearest| [moved_point, nearest.position])
        };
        let pairs: Vec<[DVec3; 2]> = new.iter().filter_map(pair).collect();
        let Some(step) = best_rigid_motion(&pairs) else { return motion };
        motion = step * motion;
        let moved = step.w_axis.truncate().length() + (step.x_axis.truncate() - DVec3::X).length() * extent;
        if moved < 1e-9 * extent {
            break;
        }
    }
    motion
}

/// The rigid motion that minimises the squared distances of pairs of points (Horn 1987); `None` for fewer than 3 pairs.
fn best_rigid_motion(pairs: &[[DVec3; 2]]) -> Option<DMat4> {
    let count = pairs.len() as f64;
    let centroid = |k: usize| pairs.iter().map(|pair| pair[k]).sum::<DVec3>() / count;
    let (from, to) = (centroid(0), centroid(1));
    let mut s = DMat3::ZERO;
    for [a, b] in pairs {
        let (a, b) = (*a - from, *b - to);
        // s.col(j)[i] = Σ aᵢ bⱼ
        s += DMat3::from_cols(a * b.x, a * b.y, a * b.z);
    }
    let entry = |i: usize, j: usize| s.col(j)[i];
    let delta = [entry(1, 2) - entry(2, 1), entry(2, 0) - entry(0, 2), entry(0, 1) - entry(1, 0)];
    let trace = entry(0, 0) + entry(1, 1) + entry(2, 2);
    let mut n = [[0.0; 4]; 4];
    n[0][0] = trace;
    for i in 0..3 {
        (n[0][i + 1], n[i + 1][0]) = (delta[i], delta[i]);
        for j in 0..3 {
            n[i + 1][j + 1] = entry(i, j) + entry(j, i) - if i == j { trace } else { 0.0 };
        }
    }
    // The eigenvector of the largest eigenvalue, by power iteration of the matrix shifted to be positive.
    let norm: f64 = n.iter().flatten().map(|x| x * x).sum::<f64>().sqrt();
    if pairs.len() < 3 || norm == 0.0 || !norm.is_finite() {
        return None;
    }
    (0..4).for_each(|i| n[i][i] += norm);
    let mut q = [1.0, 0.0, 0.0, 0.0];
    for _ in 0..512 {
        let next: [f64; 4] = std::array::from_fn(|i| (0..4).map(|j| n[i][j] * q[j]).sum());
        let length = next.iter().map(|x| x * x).sum::<f64>().sqrt();
        q = next.map(|x| x / length);
    }
    let [w, x, y, z] = q;
    let rotation = DQuat::from_xyzw(x, y, z, w).normalize();
    Some(DMat4::from_rotation_translation(rotation, to - rotation * from))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rigid_motion_of_moved_points_is_recovered() {
        let motion = DMat4::from_rotation_translation(
            DQuat::from_euler(glam::EulerRot::XYZ, 0.3, -0.4, 0.2),
            DVec3::new(3.0, -1.0, 0.5),
        );
        let points = (0..12).map(|k| DVec3::new(f64::from(k % 3), f64::from(k % 4), f64::from(k % 5) * 0.7));
        let pairs: Vec<_> = points.map(|p| [p, motion.transform_point3(p)]).collect();
        assert!(best_rigid_motion(&pairs).unwrap().abs_diff_eq(motion, 1e-9));
        assert_eq!(best_rigid_motion(&pairs[..2]), None);
    }

    #[test]
    fn there_are_24_axis_rotations() {
        assert_eq!(axis_rotations().filter(|rotation| rotation.determinant() == 1.0).count(), 24);
    }
}
