//! One small part of the aperture: the scene as seen from there.

use crate::{Aperture, ApertureMask, ApertureShape};
use glam::DVec2;
use std::f64::consts::SQRT_2;
use std::sync::Arc;

/// Radius of a sub-aperture, as a fraction of the aperture radius R: circles of confusion are drawn at 1/16 of their
/// size.
pub const SUB_APERTURE_RADIUS: f64 = 1.0 / 16.0;

/// Texels per side of a sub-aperture's mask over [−1, 1]: four across the opening.
const SIDE: u32 = 64;

/// Samples per texel of the mask and side.
const POINTS: u32 = 8;

impl Aperture {
    /// A disc of [`SUB_APERTURE_RADIUS`] about `center`, an aperture point in [−1, 1]² (moved inward so that all of the
    /// disc lies in there). A picture taken through it is the light field's view from that point (Ng 2006, *sub-aperture
    /// image*): what is out of focus is displaced by κ·U and hardly blurred.
    pub fn sub_aperture(center: DVec2) -> Self {
        let within = 1.0 - SUB_APERTURE_RADIUS;
        let center = center.clamp(DVec2::splat(-within), DVec2::splat(within));
        let count = SIDE * POINTS;
        let coordinate = |k: u32| (f64::from(k) + 0.5) * 2.0 / f64::from(count) - 1.0;
        let mut transmission = vec![0.0; (SIDE * SIDE) as usize];
        for row in 0..count {
            for column in 0..count {
                let u = DVec2::new(coordinate(column), -coordinate(row));
                if u.distance_squared(center) <= SUB_APERTURE_RADIUS * SUB_APERTURE_RADIUS {
                    let texel = row / POINTS * SIDE + column / POINTS;
                    transmission[texel as usize] += 1.0 / (POINTS * POINTS) as f32;
                }
            }
        }
        let file = String::new();
        ApertureShape::Mask(Arc::new(ApertureMask { width: SIDE, height: SIDE, transmission, file })).into()
    }

    /// Whether it is one of [`Self::sub_aperture`]: a mask of their size that comes from no file.
    pub fn is_sub_aperture(&self) -> bool {
        let is_made = |mask: &ApertureMask| mask.file.is_empty() && [mask.width, mask.height] == [SIDE; 2];
        matches!(&self.shape, ApertureShape::Mask(mask) if is_made(mask))
    }

    /// The centre of the outermost sub-aperture that lies in the opening at `angle` (rad, counter-clockwise from +u
    /// as seen from behind the camera); the aperture's centre if nothing is open there.
    pub fn rim(&self, angle: f64) -> DVec2 {
        const STEPS: u32 = 256;
        let direction = DVec2::from_angle(angle);
        let mut radii = (1..=STEPS).rev().map(|k| SQRT_2 * f64::from(k) / f64::from(STEPS));
        let open = radii.find(|radius| self.transmission(direction * *radius) > 0.0);
        direction * (open.unwrap_or(0.0) - SUB_APERTURE_RADIUS).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn a_sub_aperture_is_a_small_disc_in_its_place() {
        for center in [DVec2::ZERO, DVec2::new(0.4, -0.3), DVec2::new(-0.613, 0.713)] {
            let aperture = Aperture::sub_aperture(center);
            assert!(aperture.is_sub_aperture() && !Aperture::default().is_sub_aperture());
            assert!(aperture.validate().is_ok());
            let ApertureShape::Mask(mask) = &aperture.shape else { panic!("it is a mask") };
            let (mut light, mut moment) = (0.0, DVec2::ZERO);
            for (index, &t) in mask.transmission.iter().enumerate() {
                let [column, row] = [index as u32 % SIDE, index as u32 / SIDE].map(|k| f64::from(k) + 0.5);
                let u = DVec2::new(column, -row) * 2.0 / f64::from(SIDE) + DVec2::new(-1.0, 1.0);
                light += f64::from(t);
                moment += f64::from(t) * u;
            }
            assert!((moment / light).distance(center) < 2e-3, "{center}: {}", moment / light);
            let area = light * 4.0 / f64::from(SIDE * SIDE);
            let wanted = std::f64::consts::PI * SUB_APERTURE_RADIUS.powi(2);
            assert!((area / wanted - 1.0).abs() < 0.02, "{area} {wanted}");
        }
    }

    #[test]
    fn a_sub_aperture_outside_is_moved_in() {
        let far = Aperture::sub_aperture(DVec2::new(7.0, -7.0));
        assert!(far.validate().is_ok());
        assert_eq!(far, Aperture::sub_aperture(DVec2::new(1.0, -1.0)));
    }

    #[test]
    fn the_rim_follows_the_shape() {
        let disc = Aperture::default();
        let square = Aperture::from(ApertureShape::Square);
        let tall = Aperture { shape: ApertureShape::Disc, ratio: 2.0 };
        let near = |a: f64, b: f64| (a - b).abs() < 0.01;
        let round = |k: u32| disc.rim(TAU * f64::from(k) / 12.0).length();
        assert!((0..12).all(|k| near(round(k), 1.0 - SUB_APERTURE_RADIUS)));
        assert!(near(square.rim(TAU / 8.0).length(), SQRT_2 - SUB_APERTURE_RADIUS));
        assert!(near(tall.rim(0.0).x, 0.5 - SUB_APERTURE_RADIUS));
        assert!(near(tall.rim(TAU / 4.0).y, 1.0 - SUB_APERTURE_RADIUS));
    }
}
