//! Interpolation between keyframes (glTF 2.0, appendix C).

use glam::DQuat;

/// How values are interpolated from key to key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Interpolation {
    /// Constant until the next.
    Step,
    /// Linear; rotations along the shorter arc.
    Linear,
    /// A cubic Hermite spline with stored tangents.
    Cubic,
}

impl Interpolation {
    /// The interpolation with this name in glTF, LINEAR without a name; `None` if there is no such one.
    pub fn from_name(name: Option<&str>) -> Option<Self> {
        Some(match name {
            None | Some("LINEAR") => Self::Linear,
            Some("STEP") => Self::Step,
            Some("CUBICSPLINE") => Self::Cubic,
            Some(_) => return None,
        })
    }

    /// Stored values per key: a spline's has an incoming tangent, a value and an outgoing tangent.
    pub fn values_per_key(self) -> usize {
        if self == Self::Cubic { 3 } else { 1 }
    }
}

/// Linear from a to b, u from 0 to 1.
pub(super) fn linear(a: &[f64], b: &[f64], u: f64) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + (b - a) * u).collect()
}

/// Spherical interpolation along the shorter arc. Returns a if either is not a rotation.
pub(super) fn slerp(a: [f64; 4], b: [f64; 4], u: f64) -> [f64; 4] {
    let unit = |rotation: [f64; 4]| {
        let rotation = DQuat::from_array(rotation);
        let length = rotation.length();
        (length > 0.0 && length.is_finite()).then(|| rotation / length)
    };
    match (unit(a), unit(b)) {
        (Some(a), Some(b)) => a.slerp(b, u).to_array(),
        _ => a,
    }
}

/// A cubic Hermite spline over a span of time:
///
/// ```text
/// p(u) = (2u³ − 3u² + 1) v₀ + (u³ − 2u² + u) T b₀ + (3u² − 2u³) v₁ + (u³ − u²) T a₁
/// ```
///
/// | symbol | argument | meaning |
/// | --- | --- | --- |
/// | v₀, b₀ | `from`: value, tangent | the key before, and its outgoing tangent, 1/s |
/// | v₁, a₁ | `to`: value, tangent | the key after, and its incoming tangent, 1/s |
/// | T | `span` | time between them, s |
/// | u | `u` | where between them, 0 to 1 |
pub(super) fn hermite(from: [&[f64]; 2], to: [&[f64]; 2], span: f64, u: f64) -> Vec<f64> {
    let (u2, u3) = (u * u, u * u * u);
    let weights =
        [2.0 * u3 - 3.0 * u2 + 1.0, (u3 - 2.0 * u2 + u) * span, 3.0 * u2 - 2.0 * u3, (u3 - u2) * span];
    let interpolate = |k: usize| {
        weights[0] * from[0][k] + weights[1] * from[1][k] + weights[2] * to[0][k] + weights[3] * to[1][k]
    };
    (0..from[0].len()).map(interpolate).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spline_meets_its_keys_with_their_tangents() {
        let (from, to, span) = ([&[1.0][..], &[3.0][..]], [&[-2.0][..], &[0.5][..]], 2.0);
        let at = |u: f64| hermite(from, to, span, u)[0];
        assert_eq!((at(0.0), at(1.0)), (1.0, -2.0));
        let step = 1e-6;
        assert!(((at(step) - at(0.0)) / (step * span) - 3.0).abs() < 1e-4);
        assert!(((at(1.0) - at(1.0 - step)) / (step * span) - 0.5).abs() < 1e-4);
    }

    #[test]
    fn rotations_take_the_shorter_arc() {
        let quarter = std::f64::consts::FRAC_PI_4;
        let b = [0.0, quarter.sin(), 0.0, quarter.cos()];
        let half = slerp([0.0, 0.0, 0.0, 1.0], b, 0.5);
        let far = slerp([0.0, 0.0, 0.0, 1.0], b.map(|x: f64| -x), 0.5);
        for rotation in [half, far] {
            let expected = [0.0, (quarter / 2.0).sin(), 0.0, (quarter / 2.0).cos()];
            assert!(rotation.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{rotation:?}");
        }
        assert_eq!(slerp([0.0; 4], b, 0.5), [0.0; 4]);
    }
}
