//! Rims: the cat's eye.

use glam::DVec2;

/// A round opening about the optical axis that light has to pass beside the aperture: the edge of a front or rear element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rim {
    /// ρ, scene units, > 0.
    pub radius: f64,
    /// ℓ, scene units: its distance from the aperture, > 0 in front (toward the scene).
    pub distance: f64,
}

/// What a rim lets through of the aperture for one point: the aperture points U with |a·U + b| ≤ ρ.
///
/// From P = (x, y, z) through U a ray crosses the rim's plane at U + ℓ·((x, y) − U)/z, so that
///
/// ```text
/// a = 1 − ℓ/z        b = ℓ·(x, y)/z
/// ```
///
/// The disc about −b/a of radius ρ/|a| is never formed: at z = ℓ it is the whole plane or nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RimLimit {
    /// a, without unit.
    pub scale: f64,
    /// b, scene units.
    pub offset: DVec2,
    /// ρ, scene units.
    pub radius: f64,
}

impl Rim {
    /// What it lets through for a point at `slope` (x, y)/z and 1/z = `inverse_depth`.
    #[inline]
    pub fn limit(self, slope: DVec2, inverse_depth: f64) -> RimLimit {
        RimLimit {
            scale: 1.0 - self.distance * inverse_depth,
            offset: self.distance * slope,
            radius: self.radius,
        }
    }
}

impl RimLimit {
    /// Whether light passes at the aperture point `u`, scene units.
    #[inline]
    pub fn passes(&self, u: DVec2) -> bool {
        (self.scale * u + self.offset).length_squared() <= self.radius * self.radius
    }

    /// From where to where light passes on the line of height `v` (scene units) of the aperture: the least and the greatest u,
    /// infinite where nothing ends it; `None` where none passes.
    #[inline]
    pub fn chord(&self, v: f64) -> Option<[f64; 2]> {
        let y = self.scale * v + self.offset.y;
        let square = self.radius * self.radius - y * y;
        if square.is_nan() || square < 0.0 {
            return None;
        }
        let half = square.sqrt();
        if self.scale == 0.0 {
            return (self.offset.x.abs() <= half).then_some([f64::NEG_INFINITY, f64::INFINITY]);
        }
        let ends = [-half, half].map(|end| (end - self.offset.x) / self.scale);
        Some(if self.scale < 0.0 { [ends[1], ends[0]] } else { ends })
    }

    /// Whether all aperture points up to `radius` (scene units) from the axis pass.
    #[inline]
    pub fn passes_all(&self, radius: f64) -> bool {
        self.scale.abs() * radius + self.offset.length() <= self.radius
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chords_are_the_points_that_pass() {
        for distance in [0.05, -0.03, 0.5, 2.0] {
            let rim = Rim { radius: 0.012, distance };
            for inverse_depth in [0.0, 0.3, 1.0, 2.0, 20.0] {
                let limit = rim.limit(DVec2::new(0.02, -0.01), inverse_depth);
                for k in -20..=20 {
                    let v = f64::from(k) * 1e-3;
                    let chord = limit.chord(v);
                    for j in -20..=20 {
                        let u = DVec2::new(f64::from(j) * 1.01e-3, v);
                        let inside = chord.is_some_and(|[from, to]| (from..=to).contains(&u.x));
                        assert_eq!(inside, limit.passes(u), "{limit:?} {u}");
                        assert!(limit.passes(u) || !limit.passes_all(u.length()), "{limit:?} {u}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_point_in_the_plane_of_the_rim_sees_all_or_nothing() {
        let rim = Rim { radius: 0.01, distance: 0.05 };
        for (x, passes) in [(0.005, true), (0.02, false)] {
            let limit = rim.limit(DVec2::new(x / 0.05, 0.0), 1.0 / 0.05);
            assert_eq!(limit.chord(0.004).is_some(), passes);
            assert!([-0.3, 0.0, 0.3].into_iter().all(|u| limit.passes(DVec2::new(u, 0.1)) == passes));
        }
    }

    /// The sign: a front rim cuts the side of the aperture that lies toward the point, a rear one the other.
    #[test]
    fn rims_cut_the_side_that_they_should() {
        let slope = DVec2::new(0.3, 0.0);
        for (distance, sign) in [(0.05, 1.0), (-0.05, -1.0)] {
            let limit = Rim { radius: 0.02, distance }.limit(slope, 0.0);
            let far = DVec2::new(sign * 0.01, 0.0);
            assert!(!limit.passes(far) && limit.passes(-far), "{distance}");
        }
    }
}
