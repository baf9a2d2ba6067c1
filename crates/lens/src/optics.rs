//! The one formula of focusing, and its inverses.

use crate::FocusOffset;
use glam::{DVec2, DVec3};

/// The numbers of a camera that the optics need.
///
/// | symbol | field | meaning | unit |
/// | --- | --- | --- | --- |
/// | 1/s | `inverse_focus_distance` | reciprocal of the axial distance of the focus plane; 0 at infinity | 1/length |
/// | d | `image_distance` | sensor to aperture, h/(2 tanθ) | length |
/// | R | `aperture_radius` | half the side of the aperture square | length |
/// | tanθ | `tan_half_yfov` | half the picture's height at depth 1 | 1 |
/// | | `half_height_px` | half the picture's height | px |
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Optics {
    /// 1/s.
    pub inverse_focus_distance: f64,
    /// d = h/(2 tanθ).
    pub image_distance: f64,
    /// R.
    pub aperture_radius: f64,
    /// tanθ = tan(yfov/2).
    pub tan_half_yfov: f64,
    /// Pixels in half the picture's height: converts q to pixels.
    pub half_height_px: f64,
}

/// Beyond this t any lens blurs beyond any picture, and the terms of κ could overflow.
const LARGEST_OFFSET: f64 = 1e100;

impl Optics {
    /// The defocus κ of a point of depth z = 1/`inverse_depth`, painted `focus`:
    ///
    /// ```text
    /// κ = (t − 1)/d + t·(1 − a)·(1/s − 1/z)
    /// ```
    ///
    /// κ < 0 is near defocus (the aperture's shape appears turned by 180°), κ > 0 far defocus (upright).
    /// Infinite s or z are the value 0 of their reciprocals, and z = f, where the focal conjugate z' is at
    /// infinity, is an ordinary value: z' and the travelled distance T = t·lerp(d, z', a) are never formed.
    /// Finite for every finite depth: an offset that is not valid counts as the standard one, and one beyond
    /// ±1e100 as that.
    pub fn kappa(&self, inverse_depth: f64, focus: FocusOffset) -> f64 {
        let FocusOffset { t, anchor: a } = focus.or_standard();
        let t = t.clamp(-LARGEST_OFFSET, LARGEST_OFFSET);
        (t - 1.0) / self.image_distance + t * (1.0 - a) * (self.inverse_focus_distance - inverse_depth)
    }

    /// κ of the unpainted point: the ordinary thin lens, 1/s − 1/z.
    pub fn standard_kappa(&self, inverse_depth: f64) -> f64 {
        self.inverse_focus_distance - inverse_depth
    }

    /// Where a point lands when seen from the aperture's centre: (x, y)/(z tanθ), in half-heights, y up.
    ///
    /// `point` is in camera space with z > 0.
    pub fn chief(&self, point: DVec3) -> DVec2 {
        point.truncate() / (point.z * self.tan_half_yfov)
    }

    /// Where the ray from `point` through the aperture point `u` lands, in half-heights, y up:
    ///
    /// ```text
    /// q = ((x, y)/z + κ·U) / tanθ
    /// ```
    pub fn landing(&self, point: DVec3, u: DVec2, kappa: f64) -> DVec2 {
        (point.truncate() / point.z + kappa * u) / self.tan_half_yfov
    }

    /// Pixels on the picture for each unit of κ and of aperture radius: |κ|·R·(H/2)/tanθ is the radius of the
    /// circle of confusion. Signed: negative for near defocus.
    pub fn splat_radius_px(&self, kappa: f64) -> f64 {
        kappa * self.aperture_radius / self.tan_half_yfov * self.half_height_px
    }

    /// The diameter of the circle of confusion on the sensor, in scene units: A·|κ|·d.
    pub fn circle_of_confusion(&self, kappa: f64) -> f64 {
        2.0 * self.aperture_radius * kappa.abs() * self.image_distance
    }

    /// The diameter of the circle of confusion in pixels.
    pub fn circle_of_confusion_px(&self, kappa: f64) -> f64 {
        2.0 * self.splat_radius_px(kappa).abs()
    }

    /// The κ whose circle of confusion is `diameter_px` wide: positive (far) or, for a negative diameter,
    /// negative (near). `None` for a pinhole, which has no circle of confusion. Inverse of
    /// [`Self::circle_of_confusion_px`].
    pub fn kappa_for_circle_px(&self, diameter_px: f64) -> Option<f64> {
        let per_kappa = self.circle_of_confusion_px(1.0);
        (per_kappa > 0.0).then(|| diameter_px / per_kappa)
    }

    /// The t that gives a point of depth 1/`inverse_depth` and anchor a the defocus `kappa`:
    ///
    /// ```text
    /// t = (κ + 1/d) / (1/d + (1 − a)·(1/s − 1/z))
    /// ```
    ///
    /// Inverse of [`Self::kappa`]. `None` where the denominator vanishes (a = 0 and z = f: the ray leaves the
    /// lens parallel to the axis' conjugate and every t blurs alike).
    pub fn offset_for_kappa(&self, kappa: f64, inverse_depth: f64, anchor: f64) -> Option<f64> {
        let inverse_image_distance = 1.0 / self.image_distance;
        let denominator =
            inverse_image_distance + (1.0 - anchor) * (self.inverse_focus_distance - inverse_depth);
        let t = (kappa + inverse_image_distance) / denominator;
        t.is_finite().then_some(t)
    }

    /// The focal length of the thin lens: 1/f = 1/s + 1/d.
    pub fn focal_length(&self) -> f64 {
        1.0 / (self.inverse_focus_distance + 1.0 / self.image_distance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn optics() -> Optics {
        let tan = (0.35f64).tan();
        Optics {
            inverse_focus_distance: 1.0 / 3.0,
            image_distance: 0.024 / (2.0 * tan),
            aperture_radius: 0.0125,
            tan_half_yfov: tan,
            half_height_px: 270.0,
        }
    }

    const DEPTHS: [f64; 9] = [1e-9, 1e-3, 0.03, 0.5, 3.0, 3.0000001, 50.0, 1e9, f64::INFINITY];

    #[test]
    fn standard_is_the_thin_lens() {
        let o = optics();
        for z in DEPTHS {
            assert_eq!(o.kappa(1.0 / z, FocusOffset::STANDARD), 1.0 / 3.0 - 1.0 / z);
        }
    }

    #[test]
    fn circle_of_confusion_is_the_table_of_the_models() {
        let o = optics();
        let (a, d) = (2.0 * o.aperture_radius, o.image_distance);
        let f = o.focal_length();
        for z in [0.5, 2.0, 3.0, 40.0] {
            let conjugate = 1.0 / (1.0 / f - 1.0 / z);
            for t in [0.0, 0.5, 0.9, 1.0, 1.1, 1.5, 1e6] {
                let relative_to_sensor = a * (1.0 - t * d / conjugate).abs();
                let found = o.circle_of_confusion(o.kappa(1.0 / z, FocusOffset::new(t, 0.0)));
                assert!((found - relative_to_sensor).abs() <= 1e-12 * (1.0 + t), "{z} {t}");
                let relative_to_conjugate = a * (1.0 - t).abs();
                let found = o.circle_of_confusion(o.kappa(1.0 / z, FocusOffset::new(t, 1.0)));
                assert!((found - relative_to_conjugate).abs() <= 1e-12 * (1.0 + t), "{z} {t}");
            }
        }
    }

    #[test]
    fn every_offset_has_a_finite_kappa() {
        let o = optics();
        let at_infinity = Optics { inverse_focus_distance: 0.0, ..o };
        let f = o.focal_length();
        for o in [o, at_infinity] {
            for z in DEPTHS.into_iter().chain([f, -1.0, -1e-9]) {
                for t in [0.0, 1.0, -3.0, 1e6, f64::MAX, f64::MIN, f64::NAN, f64::INFINITY] {
                    for a in [0.0, 0.5, 1.0, 2.0, f64::NAN] {
                        assert!(o.kappa(1.0 / z, FocusOffset::new(t, a)).is_finite(), "{z} {t} {a}");
                    }
                }
            }
        }
    }

    #[test]
    fn offset_inverts_kappa() {
        let o = optics();
        for z in DEPTHS {
            for t in [-2.0, 0.0, 0.5, 1.0, 1.3, 1e3] {
                for a in [0.0, 0.25, 1.0] {
                    let kappa = o.kappa(1.0 / z, FocusOffset::new(t, a));
                    let Some(found) = o.offset_for_kappa(kappa, 1.0 / z, a) else { continue };
                    assert!((found - t).abs() <= 1e-6 * (1.0 + t.abs()), "{z} {t} {a}: {found}");
                }
            }
        }
        let at_focal_length = 1.0 / o.focal_length();
        let t = o.offset_for_kappa(0.0, at_focal_length, 0.0);
        assert!(t.is_none_or(|t| t.abs() > 1e12), "no finite t brings z = f into focus: {t:?}");
        assert_eq!(o.offset_for_kappa(0.0, at_focal_length, 1.0), Some(1.0));
    }

    #[test]
    fn circle_in_pixels_inverts() {
        let o = optics();
        for px in [-40.0, -0.5, 0.0, 3.0, 60.0] {
            let kappa = o.kappa_for_circle_px(px).unwrap();
            assert!((o.circle_of_confusion_px(kappa) - f64::abs(px)).abs() < 1e-12);
            assert!(kappa * px >= 0.0);
        }
        assert_eq!(Optics { aperture_radius: 0.0, ..o }.kappa_for_circle_px(1.0), None);
    }
}
