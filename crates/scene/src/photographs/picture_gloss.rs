//! View dependence of a picture's surface over the captured aperture.

use glam::{DVec2, Vec3};

/// Gloss of a surface made from views: the difference of its light toward other points of the aperture from its light
/// toward the middle.
///
/// Per block of texels, a polynomial of the aperture position, fitted as far as the views reach. Beyond the captured
/// aperture its value at the rim continues and fades out; at [`PictureGloss::FADE_END`] times the captured aperture
/// it is 0.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureGloss {
    /// Width and height of a block, texels.
    pub block_size: u32,
    /// Columns and rows of blocks; the first starts in the picture's upper left corner.
    pub block_counts: [u32; 2],
    /// Half width and half height of the captured aperture, scene units; ≥ 0.
    pub aperture_half_extent: [f64; 2],
    /// For each block, row by row, the index of its polynomial, or [`PictureGloss::NO_POLYNOMIAL`].
    pub polynomial_of_block: Vec<u32>,
    /// Linear RGB: coefficients of x, y, x², xy, y², x³ … y⁴, where (x, y) is the aperture position over
    /// `aperture_half_extent`, to the right and *downward*.
    pub polynomials: Vec<[[f32; 3]; PictureGloss::TERMS]>,
}

impl PictureGloss {
    /// Index of a block whose light is the same over all of the aperture.
    pub const NO_POLYNOMIAL: u32 = u32::MAX;
    /// Terms up to the fourth degree, without the constant one.
    pub const TERMS: usize = 14;
    /// The fade ends at this multiple of the captured aperture.
    pub const FADE_END: f64 = 2.0;

    /// The radiance to add at a position in the picture, texels from its upper left corner, toward a position in the
    /// aperture, scene units to the right and upward of its middle. Bilinear between the centres of blocks.
    pub fn radiance_offset(&self, position: DVec2, aperture: DVec2) -> Vec3 {
        let mut nearby_blocks = self.blocks_around(position).peekable();
        if nearby_blocks.peek().is_none() {
            return Vec3::ZERO;
        }
        let normalized = |at: f64, reach: f64| if reach > 0.0 { at / reach } else { 0.0 };
        let (x, y) = (
            normalized(aperture.x, self.aperture_half_extent[0]),
            normalized(-aperture.y, self.aperture_half_extent[1]),
        );
        let fades = (Self::FADE_END - x.abs().max(y.abs())) / (Self::FADE_END - 1.0);
        let fade = fades.clamp(0.0, 1.0) as f32;
        if fade == 0.0 {
            return Vec3::ZERO;
        }
        let terms = terms(x.clamp(-1.0, 1.0) as f32, y.clamp(-1.0, 1.0) as f32);
        let evaluate = |number: usize| -> Vec3 {
            self.polynomials[number].iter().zip(terms).map(|(by, term)| Vec3::from_array(*by) * term).sum()
        };
        nearby_blocks.map(|(number, share)| evaluate(number) * (share * fade)).sum()
    }

    /// Whether the light varies over the aperture at a position.
    pub(crate) fn varies_at(&self, position: DVec2) -> bool {
        self.blocks_around(position).next().is_some()
    }

    /// The polynomials of the blocks around a position, with their weights.
    fn blocks_around(&self, position: DVec2) -> impl Iterator<Item = (usize, f32)> {
        let at = position / f64::from(self.block_size) - 0.5;
        let first = at.floor();
        let share = (at - first).as_vec2();
        let corners = [[0, 0], [1, 0], [0, 1], [1, 1]];
        corners.into_iter().filter_map(move |[right, below]| {
            // Blocks at the border extend beyond it.
            let column = (first.x as i64 + right).clamp(0, i64::from(self.block_counts[0]) - 1) as usize;
            let row = (first.y as i64 + below).clamp(0, i64::from(self.block_counts[1]) - 1) as usize;
            let number = self.polynomial_of_block[row * self.block_counts[0] as usize + column];
            let axis_weight = |share: f32, is_after: bool| if is_after { share } else { 1.0 - share };
            let share = axis_weight(share.x, right == 1) * axis_weight(share.y, below == 1);
            (number != Self::NO_POLYNOMIAL && share > 0.0).then_some((number as usize, share))
        })
    }
}

/// The terms of the polynomial.
fn terms(x: f32, y: f32) -> [f32; PictureGloss::TERMS] {
    let ([x2, xy, y2], [x3, y3]) = ([x * x, x * y, y * y], [x * x * x, y * y * y]);
    [x, y, x2, xy, y2, x3, x2 * y, x * y2, y3, x2 * x2, x3 * y, x2 * y2, x * y3, y2 * y2]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two blocks of two texels: the left one sends more to the right, the right one nothing else.
    fn gloss() -> PictureGloss {
        let mut polynomial = [[0.0; 3]; PictureGloss::TERMS];
        polynomial[0] = [0.5, 0.0, 0.0];
        polynomial[1] = [0.0, 0.25, 0.0];
        polynomial[13] = [0.0, 0.0, 0.125];
        PictureGloss {
            block_size: 2,
            block_counts: [2, 1],
            aperture_half_extent: [0.1, 0.2],
            polynomial_of_block: vec![0, PictureGloss::NO_POLYNOMIAL],
            polynomials: vec![polynomial],
        }
    }

    #[test]
    fn gloss_is_a_polynomial_of_the_place_in_the_aperture() {
        let at = |x: f64, u: f64, v: f64| gloss().radiance_offset(DVec2::new(x, 1.0), DVec2::new(u, v));
        assert_eq!(at(1.0, 0.1, 0.0), Vec3::new(0.5, 0.0, 0.0));
        assert_eq!(at(1.0, -0.05, 0.0), Vec3::new(-0.25, 0.0, 0.0));
        // Upward is less of y.
        assert_eq!(at(1.0, 0.0, 0.2), Vec3::new(0.0, -0.25, 0.125));
        assert_eq!(at(1.0, 0.0, 0.0), Vec3::ZERO);
        // Halfway between the blocks half of it is left, in the other nothing.
        assert_eq!(at(2.0, 0.1, 0.0), Vec3::new(0.25, 0.0, 0.0));
        assert_eq!(at(3.0, 0.1, 0.0), Vec3::ZERO);
        assert_eq!(at(0.0, 0.1, 0.0), at(1.0, 0.1, 0.0), "the border goes on");
    }

    #[test]
    fn beyond_the_captured_aperture_it_fades() {
        let at = |u: f64| gloss().radiance_offset(DVec2::ONE, DVec2::new(u, 0.0)).x;
        assert!((at(0.15) - 0.25).abs() < 1e-6 && at(0.2) == 0.0 && at(7.0) == 0.0);
        let row = PictureGloss { aperture_half_extent: [0.1, 0.0], ..gloss() };
        assert_eq!(
            row.radiance_offset(DVec2::ONE, DVec2::new(0.1, 9.0)),
            Vec3::new(0.5, 0.0, 0.0),
            "of a row of views"
        );
    }

    #[test]
    fn terms_are_in_order() {
        let (x, y) = (0.5f32, -0.25f32);
        let mut number = 0;
        for degree in 1..=4 {
            for k in 0..=degree {
                let expected = x.powi(degree - k) * y.powi(k);
                assert!((terms(x, y)[number] - expected).abs() < 1e-7, "{number}");
                number += 1;
            }
        }
        assert_eq!(number, PictureGloss::TERMS);
    }
}
