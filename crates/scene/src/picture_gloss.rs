//! How what a picture's surface sends changes over the aperture that it was captured through.

use glam::{DVec2, Vec3};

/// Gloss of a surface that was made from views: what it sends through other places of the aperture, beside what it sends through the middle.
///
/// By blocks of texels, polynomials of the place in the aperture as far as views told it. Beyond the captured aperture what is told at its
/// rim goes on and fades; where it is [`PictureGloss::ENDS`] times as large, nothing is left.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureGloss {
    /// Texels that a block is wide and high.
    pub block: u32,
    /// Columns and rows of blocks; the first begins in the picture's upper left corner.
    pub blocks: [u32; 2],
    /// How far the captured aperture reaches to the right and upward, scene units; ≥ 0.
    pub reach: [f64; 2],
    /// By block, row by row, which of the polynomials it has; [`PictureGloss::NONE`] for none.
    pub numbers: Vec<u32>,
    /// Linear RGB: coefficients of x, y, x², xy, y², x³ … y⁴, where (x, y) is the place in the aperture over `reach`, to the right and
    /// *downward*.
    pub polynomials: Vec<[[f32; 3]; PictureGloss::TERMS]>,
}

impl PictureGloss {
    /// Of a block that sends the same through all of the aperture.
    pub const NONE: u32 = u32::MAX;
    /// Terms up to the fourth degree, but for the constant.
    pub const TERMS: usize = 14;
    /// How many times as large as the captured aperture one is where nothing of gloss is left.
    pub const ENDS: f64 = 2.0;

    /// What is added at a place of the picture, texels from its upper left corner, toward a place in the aperture, scene units to the right
    /// and upward of its middle. Between the middles of blocks it is linear.
    pub fn added(&self, place: DVec2, aperture: DVec2) -> Vec3 {
        let mut around = self.around(place).peekable();
        if around.peek().is_none() {
            return Vec3::ZERO;
        }
        let over = |at: f64, reach: f64| if reach > 0.0 { at / reach } else { 0.0 };
        let (x, y) = (over(aperture.x, self.reach[0]), over(-aperture.y, self.reach[1]));
        let fades = (Self::ENDS - x.abs().max(y.abs())) / (Self::ENDS - 1.0);
        let left = fades.clamp(0.0, 1.0) as f32;
        if left == 0.0 {
            return Vec3::ZERO;
        }
        let terms = terms(x.clamp(-1.0, 1.0) as f32, y.clamp(-1.0, 1.0) as f32);
        let of_block = |number: usize| -> Vec3 {
            self.polynomials[number].iter().zip(terms).map(|(by, term)| Vec3::from_array(*by) * term).sum()
        };
        around.map(|(number, share)| of_block(number) * (share * left)).sum()
    }

    /// Whether anything is added at a place.
    pub(crate) fn is_at(&self, place: DVec2) -> bool {
        self.around(place).next().is_some()
    }

    /// The polynomials of the blocks around a place, and how much of each counts there.
    fn around(&self, place: DVec2) -> impl Iterator<Item = (usize, f32)> {
        let at = place / f64::from(self.block) - 0.5;
        let first = at.floor();
        let share = (at - first).as_vec2();
        let corners = [[0, 0], [1, 0], [0, 1], [1, 1]];
        corners.into_iter().filter_map(move |[right, below]| {
            // Blocks at the border go on beyond it.
            let column = (first.x as i64 + right).clamp(0, i64::from(self.blocks[0]) - 1) as usize;
            let row = (first.y as i64 + below).clamp(0, i64::from(self.blocks[1]) - 1) as usize;
            let number = self.numbers[row * self.blocks[0] as usize + column];
            let of = |share: f32, is_after: bool| if is_after { share } else { 1.0 - share };
            let share = of(share.x, right == 1) * of(share.y, below == 1);
            (number != Self::NONE && share > 0.0).then_some((number as usize, share))
        })
    }
}

/// The terms of a place.
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
            block: 2,
            blocks: [2, 1],
            reach: [0.1, 0.2],
            numbers: vec![0, PictureGloss::NONE],
            polynomials: vec![polynomial],
        }
    }

    #[test]
    fn gloss_is_a_polynomial_of_the_place_in_the_aperture() {
        let at = |x: f64, u: f64, v: f64| gloss().added(DVec2::new(x, 1.0), DVec2::new(u, v));
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
        let at = |u: f64| gloss().added(DVec2::ONE, DVec2::new(u, 0.0)).x;
        assert!((at(0.15) - 0.25).abs() < 1e-6 && at(0.2) == 0.0 && at(7.0) == 0.0);
        let row = PictureGloss { reach: [0.1, 0.0], ..gloss() };
        assert_eq!(
            row.added(DVec2::ONE, DVec2::new(0.1, 9.0)),
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
