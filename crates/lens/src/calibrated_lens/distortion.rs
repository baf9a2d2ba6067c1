//! Deviation of a real lens from its ideal projection: radial, tangential and thin-prism terms.

use glam::{DMat2, DVec2};

/// Polynomial distortion of the picture plane: an ideal point q becomes
///
/// ```text
/// R(s) = (1 + k₁s + k₂s² + … + k₆s⁶) / (1 + d₁s + d₂s² + d₃s³)        s = |q|²
/// T(a) = (2p₁xy + p₂(3x² + y²), 2p₂xy + p₁(x² + 3y²)) · (1 + t₁r² + t₂r⁴) + (s₁r² + s₂r⁴, s₃r² + s₄r⁴)        a = (x, y), r = |a|
///
/// q·R(s) + T(q)             `radial_first` false: Brown and Conrady, OpenCV, Agisoft
/// q·R(s) + T(q·R(s))        `radial_first` true: Project Aria's Fisheye624
/// ```
///
/// | symbol | field | meaning |
/// | --- | --- | --- |
/// | k | `radial` | radial terms |
/// | d | `radial_denominator` | OpenCV's rational terms k₄ to k₆ |
/// | p | `tangential` | decentring, in OpenCV's order (Agisoft's and Aria's is the other) |
/// | t | `tangential_growth` | Agisoft's p₃ and p₄ |
/// | s | `prism` | thin prism: two terms across, two down |
///
/// The plane has x to the right and y *down*, as those who publish such numbers have it; lengths are in focal lengths. All zero: no
/// distortion. Sources: Brown 1966; Weng et al. 1992; OpenCV's `calib3d`; COLMAP's `sensor/models.h`; the Metashape manual, appendix D.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Distortion {
    /// k₁ to k₆.
    pub radial: [f64; 6],
    /// d₁ to d₃.
    pub radial_denominator: [f64; 3],
    /// p₁, p₂.
    pub tangential: [f64; 2],
    /// t₁, t₂.
    pub tangential_growth: [f64; 2],
    /// s₁ to s₄.
    pub prism: [f64; 4],
    /// Whether the other terms are applied to the result of the radial ones.
    pub radial_first: bool,
}

impl Distortion {
    /// A distortion of only radial terms k₁, k₂ …, at most six; further ones are ignored.
    pub fn radial(terms: &[f64]) -> Self {
        let mut radial = [0.0; 6];
        radial.iter_mut().zip(terms).for_each(|(to, from)| *to = *from);
        Self { radial, ..Self::default() }
    }

    /// Whether every number is finite.
    pub fn is_finite(&self) -> bool {
        let Self { radial, radial_denominator, tangential, tangential_growth, prism, .. } = self;
        let all = [&radial[..], radial_denominator, tangential, tangential_growth, prism];
        all.into_iter().flatten().all(|number| number.is_finite())
    }

    /// Whether it leaves every position as it is.
    pub fn is_none(&self) -> bool {
        self.is_radial() && self.radial == [0.0; 6] && self.radial_denominator == [0.0; 3]
    }

    /// Whether it is rotationally symmetric.
    pub fn is_radial(&self) -> bool {
        self.tangential == [0.0; 2] && self.prism == [0.0; 4]
    }

    /// The distorted position of an ideal point. Both are in units of the focal length, from the axis.
    pub fn distorted(&self, q: DVec2) -> DVec2 {
        let radial = q * self.radial_factor(q.length_squared())[0];
        if self.is_radial() {
            return radial;
        }
        radial + self.offset(if self.radial_first { radial } else { q })
    }

    /// The derivative of [`Self::distorted`]: its columns are those by x and by y.
    pub fn jacobian(&self, q: DVec2) -> DMat2 {
        let [factor, slope] = self.radial_factor(q.length_squared());
        let of_radial =
            DMat2::from_cols(q * q.x, q * q.y) * (2.0 * slope) + DMat2::from_diagonal(DVec2::splat(factor));
        match (self.is_radial(), self.radial_first) {
            (true, _) => of_radial,
            (false, false) => of_radial + self.offset_jacobian(q),
            (false, true) => of_radial + self.offset_jacobian(q * factor) * of_radial,
        }
    }

    /// R and dR/ds at s.
    pub(super) fn radial_factor(&self, s: f64) -> [f64; 2] {
        let polynomial = |terms: &[f64]| {
            let (value, slope) = terms
                .iter()
                .rev()
                .fold((0.0, 0.0), |(value, slope), term| (value * s + term, slope * s + value));
            // 1 + s·(value), and its derivative.
            [1.0 + s * value, value + s * slope]
        };
        let [top, top_slope] = polynomial(&self.radial);
        if self.radial_denominator == [0.0; 3] {
            return [top, top_slope];
        }
        let [bottom, bottom_slope] = polynomial(&self.radial_denominator);
        [top / bottom, (top_slope * bottom - top * bottom_slope) / (bottom * bottom)]
    }

    /// T.
    fn offset(&self, a: DVec2) -> DVec2 {
        let ([p1, p2], [t1, t2], [s1, s2, s3, s4]) = (self.tangential, self.tangential_growth, self.prism);
        let (x, y, r2) = (a.x, a.y, a.length_squared());
        let tangential = DVec2::new(
            2.0 * p1 * x * y + p2 * (3.0 * x * x + y * y),
            2.0 * p2 * x * y + p1 * (x * x + 3.0 * y * y),
        );
        let prism = DVec2::new(r2 * (s1 + s2 * r2), r2 * (s3 + s4 * r2));
        tangential * (1.0 + r2 * (t1 + t2 * r2)) + prism
    }

    /// The derivative of T.
    fn offset_jacobian(&self, a: DVec2) -> DMat2 {
        let ([p1, p2], [t1, t2], [s1, s2, s3, s4]) = (self.tangential, self.tangential_growth, self.prism);
        let (x, y, r2) = (a.x, a.y, a.length_squared());
        let tangential = DVec2::new(
            2.0 * p1 * x * y + p2 * (3.0 * x * x + y * y),
            2.0 * p2 * x * y + p1 * (x * x + 3.0 * y * y),
        );
        let [by_x, by_y] = [
            DVec2::new(2.0 * p1 * y + 6.0 * p2 * x, 2.0 * p2 * y + 2.0 * p1 * x),
            DVec2::new(2.0 * p1 * x + 2.0 * p2 * y, 2.0 * p2 * x + 6.0 * p1 * y),
        ];
        let (growth, growth_by_r2) = (1.0 + r2 * (t1 + t2 * r2), t1 + 2.0 * t2 * r2);
        let by_r2 = tangential * growth_by_r2 + DVec2::new(s1 + 2.0 * s2 * r2, s3 + 2.0 * s4 * r2);
        DMat2::from_cols(by_x * growth + by_r2 * (2.0 * x), by_y * growth + by_r2 * (2.0 * y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One that has every term.
    fn everything(radial_first: bool) -> Distortion {
        Distortion {
            radial: [-0.1, 0.05, 0.02, -0.01, 0.003, -0.001],
            radial_denominator: [0.03, -0.02, 0.01],
            tangential: [0.01, -0.02],
            tangential_growth: [0.3, -0.1],
            prism: [0.004, -0.003, 0.002, 0.001],
            radial_first,
        }
    }

    #[test]
    fn the_jacobian_is_the_derivative() {
        const STEP: f64 = 1e-6;
        for distortion in [Distortion::radial(&[-0.2, 0.1]), everything(false), everything(true)] {
            for q in [DVec2::ZERO, DVec2::new(0.4, -0.3), DVec2::new(-0.8, 0.6)] {
                let slope = |step: DVec2| {
                    (distortion.distorted(q + step) - distortion.distorted(q - step)) / (2.0 * STEP)
                };
                let differences = DMat2::from_cols(slope(DVec2::X * STEP), slope(DVec2::Y * STEP));
                assert!(distortion.jacobian(q).abs_diff_eq(differences, 1e-8), "{distortion:?} at {q}");
            }
        }
    }

    #[test]
    fn nothing_is_nothing() {
        let none = Distortion::default();
        assert!(none.is_none() && none.is_radial() && none.is_finite());
        assert_eq!(none.distorted(DVec2::new(0.3, -2.0)), DVec2::new(0.3, -2.0));
        assert!(!everything(true).is_none() && !everything(true).is_radial());
        assert!(!Distortion::radial(&[f64::NAN]).is_finite());
    }
}
