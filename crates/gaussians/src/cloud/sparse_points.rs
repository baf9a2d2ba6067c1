//! Points with few others near them: what floats beside a scan.

use glam::{DVec3, I64Vec3};
use rayon::prelude::*;
use std::collections::HashMap;

/// Whether each point has at least `count` others within `distance` (> 0). Points that are not finite have none.
///
/// The points are sorted into cubes as wide as `distance`, of which 27 are searched, and no longer than until enough are found.
pub fn have_neighbors(points: &[DVec3], distance: f64, count: usize) -> Vec<bool> {
    let cube = |point: DVec3| (point / distance).floor().as_i64vec3();
    let mut order: Vec<(I64Vec3, u32)> = (0..)
        .zip(points)
        .filter(|(_, point)| point.is_finite())
        .map(|(k, point)| (cube(*point), k))
        .collect();
    order.par_sort_unstable_by_key(|(cube, k)| (cube.to_array(), *k));
    let mut cubes: HashMap<I64Vec3, &[(I64Vec3, u32)]> = HashMap::new();
    for of_cube in order.chunk_by(|a, b| a.0 == b.0) {
        cubes.insert(of_cube[0].0, of_cube);
    }
    let is_near = |a: DVec3, b: DVec3| a.distance_squared(b) <= distance * distance;
    let has_enough = |index: usize| {
        let point = points[index];
        if !point.is_finite() {
            return false;
        }
        let offsets = (0..27).map(|k| I64Vec3::new(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1));
        let corner = cube(point);
        let near = offsets
            .filter_map(|offset| {
                // Beyond the range of integers there is nothing to tell apart.
                let [x, y, z] = [0, 1, 2].map(|axis| corner[axis].saturating_add(offset[axis]));
                cubes.get(&I64Vec3::new(x, y, z)).copied()
            })
            .flatten()
            .filter(|(_, other)| *other as usize != index && is_near(points[*other as usize], point));
        near.take(count).count() == count
    };
    (0..points.len()).into_par_iter().map(has_enough).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_counted_as_by_trying_every_pair() {
        let mut state = 7u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1 << 24)
        };
        let points: Vec<DVec3> =
            (0..400).map(|_| DVec3::new(random(), random(), random()) * 4.0 - 2.0).collect();
        for (distance, count) in [(0.3, 1), (0.5, 4), (9.0, 8)] {
            let expected: Vec<bool> = points
                .iter()
                .map(|a| points.iter().filter(|b| a.distance(**b) <= distance).count() > count)
                .collect();
            assert_eq!(have_neighbors(&points, distance, count), expected, "{distance}");
        }
        let some = have_neighbors(&points, 0.3, 1).iter().filter(|has| **has).count();
        assert!((50..350).contains(&some), "{some}");
    }

    #[test]
    fn places_that_cannot_be_numbered_are_no_trouble() {
        let far = DVec3::splat(1e300);
        let points = [far, far, DVec3::NAN, DVec3::INFINITY, DVec3::ZERO];
        assert_eq!(have_neighbors(&points, 1e-3, 1), [true, true, false, false, false]);
        assert_eq!(have_neighbors(&[], 1.0, 1), [false; 0]);
    }
}
