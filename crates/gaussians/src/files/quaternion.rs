//! Rotations that are packed into few bits: the component that is left out follows from the unit length.

use glam::Quat;

/// √½, the greatest value of a component that is not the largest.
const SQRT_HALF: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// The rotation of its three smaller components, each in [−1, 1] of √½, in the order w x y z without component `largest` (0 to 3: w x y z).
pub(super) fn from_smallest_three(largest: usize, rest: [f64; 3]) -> Quat {
    let rest = rest.map(|x| x * SQRT_HALF);
    let mut wxyz = [0.0; 4];
    let mut next = rest.into_iter();
    for (component, value) in wxyz.iter_mut().enumerate() {
        *value = if component == largest {
            (1.0 - rest.iter().map(|x| x * x).sum::<f64>()).max(0.0).sqrt()
        } else {
            next.next().unwrap_or_default()
        };
    }
    from_wxyz(wxyz)
}

/// The rotation of x, y and z, w being 0 or more.
pub(super) fn from_xyz(xyz: [f64; 3]) -> Quat {
    let w = (1.0 - xyz.iter().map(|x| x * x).sum::<f64>()).max(0.0).sqrt();
    from_wxyz([w, xyz[0], xyz[1], xyz[2]])
}

/// The rotation of four components, scalar first.
pub(super) fn from_wxyz([w, x, y, z]: [f64; 4]) -> Quat {
    Quat::from_xyzw(x as f32, y as f32, z as f32, w as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_components_give_the_fourth() {
        let wxyz = [0.1, -0.7, 0.5, -0.2f64];
        let length = wxyz.iter().map(|x| x * x).sum::<f64>().sqrt();
        let unit = wxyz.map(|x| x / length);
        // x is the largest and negative: all signs change.
        let rest = [unit[0], unit[2], unit[3]].map(|x| -x / SQRT_HALF);
        let expected = from_wxyz(unit.map(|x| -x));
        assert!((from_smallest_three(1, rest) - expected).length() < 1e-6);
        assert!((from_xyz([unit[1], unit[2], unit[3]]) - from_wxyz(unit)).length() < 1e-6);
    }
}
