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

/// Beyond this t any lens blurs more than any picture's size, and the terms of κ could overflow.
const LARGEST_OFFSET: f64 = 1e100;

impl Optics {
    /// The defocus κ of a point of depth z = 1/`inverse_depth`, painted `focus`:
    ///
    /// ```text
    /// κ = (t − 1)/d + t·(1 − a)·(1/s − 1/z)
    /// ```
    ///
    /// κ < 0 is near defocus (the aperture's shape appears turned by 180°), κ > 0 far defocus (upright).
    /// It is that of the light that the point sends of its own; what it carries has that of [`FocusOffset::of_carried`].
    /// Infinite s or z are the value 0 of their reciprocals, and z = f, where the focal conjugate z' is at
    /// infinity, is an ordinary value: z' and the travelled distance T = t·lerp(d, z', a) are never formed.
    /// Finite for every finite depth: an offset that is not valid counts as the standard one, and one beyond
    /// ±1e100 as that.
    #[inline]
    pub fn kappa(&self, inverse_depth: f64, focus: FocusOffset) -> f64 {
        let FocusOffset { t, anchor: a, .. } = focus.or_standard();
        let t = t.clamp(-LARGEST_OFFSET, LARGEST_OFFSET);
        (t - 1.0) / self.image_distance + t * (1.0 - a) * (self.inverse_focus_distance - inverse_depth)
    }

    /// The defocus κ of a single ray of its own focal length f and transmission distance T: the general model
    /// F = T(t)∘R(f)∘T(z), of which [`Self::kappa`] is the case f = const, T = t·lerp(d, z', a).
    ///
    /// The ray from (x, z) through U leaves the lens with the slope (U − x)/z − U/f, is at
    /// −x·T/z + U·(1 + T/z − T/f) after T, and is projected along its chief ray onto the sensor at d:
    ///
    /// ```text
    /// κ = (T/d)·(1/f − 1/z) − 1/d
    /// ```
    ///
    /// `inverse_focal_length` 1/f in 1/length, `transmission_distance` T in length; both may be any finite
    /// number.
    pub fn kappa_of_ray(
        &self,
        inverse_depth: f64,
        inverse_focal_length: f64,
        transmission_distance: f64,
    ) -> f64 {
        let (inverse_d, t) = (1.0 / self.image_distance, transmission_distance / self.image_distance);
        t * (inverse_focal_length - inverse_depth) - inverse_d
    }

    /// How much of the picture a unit of surface area takes for the aperture point `u`, in px²:
    ///
    /// ```text
    /// w(P, U) = |n·(P − U)| / z³ · (H/2)²/tan²θ
    /// ```
    ///
    /// `normal` n is the surface's unit normal and `point` P a point of it with z > 0, both in camera space.
    /// The same for every focus: rays are as dense in the picture as an unpainted camera's.
    pub fn pixels_by_area(&self, normal: DVec3, point: DVec3, u: DVec2) -> f64 {
        let half_heights = normal.dot(point - u.extend(0.0)).abs() / point.z.powi(3);
        half_heights * (self.half_height_px / self.tan_half_yfov).powi(2)
    }

    /// The defocus κ, in 1/length, of an unpainted point with the inverse depth 1/z: the ordinary thin lens, 1/s −
    /// 1/z.
    #[inline]
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

    /// The diameter of the circle of confusion of a defocus κ (in 1/length), px; never negative.
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

    /// The 1/s, in 1/length, of the focus distance that makes a point of depth 1/`inverse_depth`, painted `focus`, sharp:
    ///
    /// ```text
    /// 1/s = 1/z − (t − 1)/(d·t·(1 − a))
    /// ```
    ///
    /// The zero of [`Self::kappa`] as a function of 1/s; 1/z for an unpainted point. Below 0 the point is sharp for no real focus distance.
    /// `None` where κ does not depend on the focus distance (a = 1 or t = 0).
    pub fn sharp_inverse_focus_distance(&self, inverse_depth: f64, focus: FocusOffset) -> Option<f64> {
        let FocusOffset { t, anchor: a, .. } = focus.or_standard();
        let inverse_distance = inverse_depth - (t - 1.0) / (self.image_distance * t * (1.0 - a));
        inverse_distance.is_finite().then_some(inverse_distance)
    }

    /// The focal length f of the thin lens, in scene units: 1/f = 1/s + 1/d.
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
    fn a_ray_of_the_common_lens_has_the_common_kappa() {
        let o = optics();
        let inverse_f = 1.0 / o.focal_length();
        for z in [0.5, 2.0, 3.0, 40.0] {
            let conjugate = 1.0 / (inverse_f - 1.0 / z);
            for t in [0.0, 0.5, 0.9, 1.0, 1.5] {
                for (anchor, distance) in [(0.0, t * o.image_distance), (1.0, t * conjugate)] {
                    let expected = o.kappa(1.0 / z, FocusOffset::new(t, anchor));
                    let found = o.kappa_of_ray(1.0 / z, inverse_f, distance);
                    assert!((found - expected).abs() < 1e-11, "{z} {t} {anchor}: {found}, {expected}");
                }
            }
        }
    }

    #[test]
    fn a_wall_across_the_axis_takes_its_projected_area() {
        let o = optics();
        // One unit of a wall at z = 2, square on: (1/2)² half-heights·tanθ.
        let px = o.half_height_px / o.tan_half_yfov / 2.0;
        for u in [DVec2::ZERO, DVec2::new(0.3, -0.2)] {
            let found = o.pixels_by_area(DVec3::Z, DVec3::new(0.7, -0.4, 2.0), u);
            assert!((found / (px * px) - 1.0).abs() < 1e-12);
        }
        // Edge-on to the middle of the aperture it still sends light to the rest of it.
        assert_eq!(o.pixels_by_area(DVec3::X, DVec3::new(0.0, 0.1, 2.0), DVec2::ZERO), 0.0);
        assert!(o.pixels_by_area(DVec3::X, DVec3::new(0.0, 0.1, 2.0), DVec2::X) > 0.0);
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
    fn the_sharp_focus_distance_leaves_no_defocus() {
        let o = optics();
        for z in [0.5, 3.0, 40.0, f64::INFINITY] {
            assert_eq!(o.sharp_inverse_focus_distance(1.0 / z, FocusOffset::STANDARD), Some(1.0 / z));
            for focus in [FocusOffset::new(0.9, 0.0), FocusOffset::new(1.1, 0.7), FocusOffset::new(-2.0, 0.2)]
            {
                let inverse_focus_distance = o.sharp_inverse_focus_distance(1.0 / z, focus).unwrap();
                let focused = Optics { inverse_focus_distance, ..o };
                assert!(focused.kappa(1.0 / z, focus).abs() < 1e-11, "{z} {focus:?}");
                assert!(o.kappa(1.0 / z, focus).abs() > 1e-3, "{z} {focus:?}: another distance blurs");
            }
            for focus in [FocusOffset::SHARP, FocusOffset::new(1.2, 1.0), FocusOffset::new(0.0, 0.3)] {
                assert_eq!(o.sharp_inverse_focus_distance(1.0 / z, focus), None, "{z} {focus:?}");
            }
        }
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
