//! The image of the aperture that one sample throws on the picture.

use crate::accumulator::{Band, Rectangle};
use crate::kernel::{Kernel, LinearWeight, Piece};
use glam::DVec2;
use salf::{Sample, Visibility};
use std::ops::Range;

/// A sample's aperture image: its footprint, thrown by every point of the aperture that it sees.
pub struct ApertureImage<'a> {
    /// The sample.
    pub sample: &'a Sample,
    /// The lens's aperture.
    pub kernel: &'a Kernel,
    /// Radius of the baked aperture's image, px; negative (turned by 180°) for near defocus.
    pub radius_px: f64,
    /// How fast its defocus changes with depth, as a share of the unpainted.
    pub depth_share: f64,
}

/// Half the longest side of a stretched footprint, px.
const LARGEST_FOOTPRINT_PX: f64 = 10.0;

impl ApertureImage<'_> {
    /// The pixel rows it may touch.
    pub fn rows(&self) -> Range<i64> {
        let center = self.sample.center.y as f64;
        let half = self.radius_px.abs() + self.largest_footprint();
        (center - half).floor() as i64..(center + half).ceil() as i64 + 1
    }

    /// Adds (`sign` 1) it to a band, or takes it away (−1); `light` is the value of each channel.
    pub fn deposit<const C: usize>(&self, band: &mut Band<C>, light: &[f64; C], sign: i64) {
        let Self { sample, kernel, radius_px, .. } = *self;
        let center = sample.center.as_dvec2();
        let footprint = sample.half_size.as_dvec2();
        let weight = LinearWeight { at_center: sample.weight as f64, gradient: sample.tilt.as_dvec2() };
        let (first, end) = (band.rows.start as f64, band.rows.end as f64);
        let margin = self.largest_footprint();
        let throw = |piece: Piece| {
            let rectangle = Rectangle {
                // Pixel rows go down, v goes up.
                center: center + piece.center * DVec2::new(radius_px, -radius_px),
                half_size: piece.half_size * radius_px.abs(),
                footprint: self.stretched(footprint, piece.center),
            };
            band.deposit(&rectangle, &light.map(|value| value * piece.share), sign);
        };
        // Pixel rows that a row of the aperture cannot reach are not its business.
        let in_band = |span: [f64; 2]| {
            let [a, b] = span.map(|v| center.y - v * radius_px);
            a.max(b) + margin >= first && a.min(b) - margin <= end
        };
        match &sample.visibility {
            Visibility::Open => kernel.pieces(radius_px, weight, in_band, throw),
            Visibility::Cells(words) => kernel.visible_pieces(words, radius_px, weight, in_band, throw),
        }
    }
}

impl ApertureImage<'_> {
    /// The footprint as the aperture point u throws it.
    ///
    /// The splat radius r changes across a slanted surface, and so neighbouring samples move apart or together by
    /// ∂(x + r·u)/∂x = 1 + u·∂r/∂x. For an unpainted surface ∂r/∂x is its weight's relative tilt, so that the
    /// density w(u)/(1 + tilt·u) of a uniform wall stays uniform.
    fn stretched(&self, footprint: DVec2, u: DVec2) -> DVec2 {
        let relative = self.relative_tilt();
        let factor = (1.0 + relative * self.depth_share * u).abs().max(DVec2::splat(1.0 / 16.0));
        (footprint * factor).min(DVec2::splat(LARGEST_FOOTPRINT_PX))
    }

    /// Half the height of the footprint at most, px, however it is stretched.
    fn largest_footprint(&self) -> f64 {
        let stretch = 1.0 + (self.relative_tilt().y * self.depth_share).abs();
        (self.sample.half_size.y as f64 * stretch).min(LARGEST_FOOTPRINT_PX)
    }

    /// The weight's relative change over the unit aperture; 0 for a patch edge-on to the aperture, which has no
    /// neighbours in the pinhole picture.
    fn relative_tilt(&self) -> DVec2 {
        let (weight, tilt) = (self.sample.weight as f64, self.sample.tilt.as_dvec2());
        if tilt.abs().element_sum() < weight { tilt / weight } else { DVec2::ZERO }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accumulator::running_sum;
    use crate::fixed_point::QUANTA;
    use glam::Vec2;
    use lens::ApertureShape;

    /// Coverage along the middle row of a plane whose splat radius changes by `slope` px a px, from negative to positive.
    /// `tilt` is what the weights change by; that of a plane is its slope.
    fn coverage_of_ramp(slope: f64, tilt: f64) -> Vec<f64> {
        const SIZE: i64 = 160;
        const HEIGHT: i64 = 9;
        let kernel = Kernel::new(&ApertureShape::Disc.into(), 1.0);
        let mut differences = vec![[0i64; 1]; (SIZE * HEIGHT) as usize];
        for y in -40..HEIGHT + 40 {
            for x in -60..SIZE + 60 {
                let center = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                let sample = Sample {
                    center: center.as_vec2(),
                    half_size: Vec2::splat(0.5),
                    inverse_depth: 1.0,
                    weight: 1.0,
                    tilt: Vec2::new(tilt as f32, 0.0),
                    radiance: glam::Vec3::ONE,
                    surface: None,
                    visibility: Visibility::Open,
                };
                let radius_px = slope * (center.x - 71.3);
                let image = ApertureImage { sample: &sample, kernel: &kernel, radius_px, depth_share: 1.0 };
                let mut band = Band::new(SIZE as usize, 0..HEIGHT, &mut differences);
                image.deposit(&mut band, &[1.0], 1);
            }
        }
        let middle = (HEIGHT / 2 * SIZE) as usize;
        running_sum(&differences[middle..middle + SIZE as usize]).map(|sum| sum[0] as f64 / QUANTA).collect()
    }

    /// The standard picture of a uniform wall is uniform, wherever its blur goes through 0 or from one cut of the
    /// aperture to the next.
    #[test]
    fn a_slanted_wall_is_covered_evenly() {
        let worst = |coverage: &[f64]| coverage.iter().map(|c| (c - 1.0).abs()).fold(0.0, f64::max);
        for slope in [0.0, 0.01, 0.04, 0.1, 0.3] {
            let found = worst(&coverage_of_ramp(slope, slope));
            assert!(found < 0.007, "slope {slope}: {found}");
        }
        assert!(worst(&coverage_of_ramp(0.3, 0.0)) > 0.02, "weights that ignore the slope");
    }
}
