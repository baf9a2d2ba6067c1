//! Points that are even over an aperture.

use glam::DVec2;
use lens::{Aperture, ApertureSampler, ApertureShape};

/// `count` points, even over the opening of an aperture, in [−1, 1]² (units of the aperture radius): a sunflower (Vogel 1979) for a disc, else
/// Roberts's R₂ sequence, warped to the transmission.
pub(crate) fn aperture_points(aperture: &Aperture, count: u32) -> Vec<DVec2> {
    /// π (3 − √5).
    const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
    /// 1/ρ and 1/ρ² of ρ³ = ρ + 1.
    const PLASTIC: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3];
    let is_disc = aperture.shape == ApertureShape::Disc && aperture.ratio == 1.0;
    let sampler = ApertureSampler::new(aperture);
    let point = |index: u32| {
        let index = f64::from(index) + 0.5;
        if is_disc {
            return DVec2::from_angle(index * GOLDEN_ANGLE) * (index / f64::from(count)).sqrt();
        }
        let [a, b] = PLASTIC.map(|step| (index * step).fract());
        sampler.sample(a, b)
    };
    (0..count).map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_even() {
        let hexagon = ApertureShape::Polygon { blades: 6, rotation: 0.3, roundness: 0.0 };
        for aperture in [Aperture::default(), Aperture::from(hexagon), Aperture::from(ApertureShape::Square)]
        {
            let points = aperture_points(&aperture, 256);
            assert!(points.iter().all(|u| aperture.transmission(*u * 0.999) == 1.0), "{aperture:?}");
            let mean = points.iter().sum::<DVec2>() / 256.0;
            assert!(mean.length() < 0.02, "{aperture:?} {mean}");
        }
    }
}
