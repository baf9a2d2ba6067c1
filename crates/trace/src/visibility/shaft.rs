//! The space between many viewpoints and a square.

use crate::hierarchy::Halfspaces;
use crate::local_space::LocalSpace;
use crate::visibility::{Eye, Square};
use glam::DVec3;

/// A conservative bound of the space between some viewpoints and a square, which widens away from them. `None` unless all lie on
/// one side of the square's plane.
///
/// A segment from an eye E to the square leaves the square's column by at most (r·(E − c) − |r|²)/(z|r|) for a unit of height over
/// the square, r being the half side toward that side, c the centre and z the height of E: so the steepest of all eyes bounds it.
pub(crate) fn shaft_from_many(eyes: &[Eye], square: &Square, space: &LocalSpace) -> Option<Halfspaces> {
    let center = space.position(square.center);
    let height = |axis: DVec3, eye: &Eye| match eye {
        Eye::At(point) => axis.dot(space.position(*point) - center),
        Eye::Toward(direction) => axis.dot(*direction),
    };
    let axis = square.axis();
    let axis = if height(axis, eyes.first()?) < 0.0 { -axis } else { axis };
    let heights: Vec<f64> = eyes.iter().map(|eye| height(axis, eye)).collect();
    if !heights.iter().all(|&height| height > 0.0) {
        return None;
    }
    let mut shaft = Halfspaces::toward(-axis);
    let [right, up] = [square.right, square.up].map(|side| space.direction(side));
    for side in [right, up, -right, -up] {
        let outward = side.normalize_or_zero();
        let slope = |(eye, height): (&Eye, &f64)| match eye {
            Eye::At(point) => outward.dot(space.position(*point) - center - side) / height,
            Eye::Toward(direction) => outward.dot(*direction) / height,
        };
        let steepest = eyes.iter().zip(&heights).map(slope).fold(f64::NEG_INFINITY, f64::max);
        let normal = axis * steepest - outward;
        shaft.add(normal, center + side, center + side + normal);
    }
    shaft.add(axis, center, center + axis);
    let has_end = eyes.iter().all(|eye| matches!(eye, Eye::At(_)));
    if has_end {
        let farthest: DVec3 = center + axis * heights.iter().copied().fold(0.0, f64::max);
        shaft.add(axis, farthest, farthest - axis);
    }
    Some(shaft)
}
