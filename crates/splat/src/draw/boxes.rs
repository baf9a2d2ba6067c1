//! Small images as boxes.

use crate::aperture::stencil::HEIGHT_BITS;
use crate::canvas::{PIXEL, POSITION_BITS, Word};
use crate::character::node_shape::NodeShape;
use crate::draw::image::Image;
use crate::draw::paper::Paper;
use crate::draw::pen::Pen;
use crate::draw::sized_box::{HALF_PIXEL, UnsizedBox, too_blurred};
use crate::fixed::{ONE, mul_shift};

/// Half the longest side of a stretched footprint, 1/4096 px.
pub const LARGEST_HALF: u32 = 10 << POSITION_BITS;

/// The largest aperture's part that leaves a pixel's box a pixel: (h + 1)² is 2h + 1 more than h².
const LARGEST_WITHIN_PIXEL: u32 = (2 * HALF_PIXEL).isqrt();

impl Pen<'_> {
    /// The boxes of the aperture's parts, each with the node's weight toward it.
    ///
    /// Across a slanted surface the radius r changes, and neighbours move apart or together by 1 + u·∂r/∂x; the footprint
    /// is stretched as much, so that they still meet. For an unpainted surface ∂r/∂x is its weight's relative tilt. What rims and edges leave of a part is
    /// `shape`'s.
    #[inline(always)]
    pub fn draw_parts<W: Word>(
        &self,
        image: &Image,
        depth_share: i32,
        shape: Option<&NodeShape>,
        paper: &mut Paper<W>,
        sign: i32,
    ) {
        let node = image.node;
        let tilt = [0, 1].map(|k| (node.tilt[k] as i32 * self.stop) >> 14);
        for (index, part_of) in self.parts.iter().enumerate() {
            // Times 2²⁴.
            let exact =
                ((node.base as i32) << 10) + ((tilt[0] * part_of.mean[0] + tilt[1] * part_of.mean[1]) >> 4);
            let weight = exact >> 10;
            if weight <= 0 {
                continue;
            }
            let share = mul_shift(mul_shift(image.share, part_of.share, 24), exact as u32, 24);
            let share = shape.map_or(share, |shape| shape.part_share(share, part_of));
            let mut part = Image { share, dither: image.dither.wrapping_add(index as u32), ..*image };
            // Within the part the light leans toward where the weight is, and stays within it however little there is.
            let lean = |k: usize| {
                let most = (part_of.half[k] >> 2) as i32;
                part_of.mean[k] + (tilt[k] * part_of.variance[k] / weight).clamp(-most, most)
            };
            part.shift([lean(0), lean(1)]);
            let stretched = |k: usize| {
                let slope = (tilt[k] * depth_share) >> 14;
                let factor = (ONE + ((slope * part_of.mean[k]) >> 14)).abs().max(ONE / 16) as u32;
                mul_shift(node.half_size[k] as u32, factor, 14).min(LARGEST_HALF)
            };
            let half = part_of.half.map(|half| mul_shift(image.radius.unsigned_abs(), half, 16));
            self.draw_box(&part, [stretched(0), stretched(1)], half, paper, sign);
        }
    }

    /// One box of the light, mean and variance that a partly occluded node sends, within a pixel of its image.
    #[inline(always)]
    pub fn draw_partial_box<W: Word>(&self, image: &mut Image, paper: &mut Paper<W>, sign: i32) {
        let moments = self.moments.of(self.nodes, image.node);
        image.shift([moments.mean[0].into(), moments.mean[1].into()]);
        image.share = moments.share;
        let half_size = image.node.half_size;
        let half_size = [u32::from(half_size[0]) >> image.level, u32::from(half_size[1]) >> image.level];
        // Little of what is seen on one side and much on the other has its mean near a side, and spreads no further than the image.
        let radius = image.radius.unsigned_abs();
        let half = [0, 1].map(|k| {
            let beyond_mean = (ONE - i32::from(moments.mean[k]).abs()) as u32;
            let most = mul_shift(radius, beyond_mean, 14) + PIXEL as u32;
            mul_shift(radius, moments.half_width[k].into(), 14).min(most)
        });
        self.draw_box(image, half_size, half, paper, sign);
    }

    /// A box of the variance of footprint and aperture together: half the sides of a box of either, 1/4096 px.
    #[inline(always)]
    pub fn draw_box<W: Word>(
        &self,
        image: &Image,
        half_size: [u32; 2],
        half: [u32; 2],
        paper: &mut Paper<W>,
        sign: i32,
    ) {
        let filled = image.filled_pixel(half_size, half);
        if let Some([column, row]) = filled.filter(|at| paper.rows.has_column(at[0])) {
            // What such a box is, without its arithmetic.
            let shift = image.light.shift(HEIGHT_BITS);
            let value = image.light.in_pixel(image.share, shift, image.dither, 0);
            return paper.rows.add_pixel(row, column, value, sign);
        }
        let unsized_box = UnsizedBox { image, legs: [[half_size[0], half[0]], [half_size[1], half[1]]] };
        if unsized_box.is_small() {
            paper.add(&unsized_box, sign)
        } else {
            unsized_box.sized(too_blurred(image.level)).draw(&mut paper.rows, sign)
        }
    }
}

impl Image<'_> {
    /// The column and row of the pixel of the picture that is its box, if that is one: its footprint fills it, and the
    /// aperture's part, `half`, is too small to make it wider by the least step.
    #[inline(always)]
    fn filled_pixel(&self, half_size: [u32; 2], half: [u32; 2]) -> Option<[i32; 2]> {
        let [x, y] = self.center;
        let is_centered = [x & (PIXEL - 1), y & (PIXEL - 1)] == [HALF_PIXEL as i32; 2];
        let is_sharp = half_size == [HALF_PIXEL; 2] && half[0].max(half[1]) <= LARGEST_WITHIN_PIXEL;
        (is_centered && is_sharp && self.level == 0).then_some([x >> POSITION_BITS, y >> POSITION_BITS])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::canvas::Accumulator;
    use crate::draw::image::Light;
    use crate::draw::sized_box::SizedBox;
    use crate::fixed::WHOLE;
    use crate::fixed::{Reciprocal, hypotenuse};

    #[test]
    fn a_filled_pixel_is_a_box_bit_for_bit() {
        let half = |aperture: u32| hypotenuse(HALF_PIXEL, aperture, too_blurred(0));
        let least = [LARGEST_WITHIN_PIXEL, LARGEST_WITHIN_PIXEL + 1].map(half);
        assert_eq!(least, [HALF_PIXEL, HALF_PIXEL + 1]);
        for (light, share, sign) in
            [([1e6f32, 3e5, 7.0, 4.2e6], WHOLE, 1), ([0.3, 0.0, 8.1, 1.0], 12_345_678, -1), ([2.0; 4], 1, 1)]
        {
            let light = Light::from_floats(light);
            let [mut wanted, mut found] = [0, 1].map(|_| Accumulator::<i32>::new(8, 8, 1));
            for (column, row) in [(-1, 0), (3, 2), (7, 7), (5, -1)] {
                let center = [column, row].map(|at| (at << POSITION_BITS) + HALF_PIXEL as i32);
                let (half, per_half) = ([HALF_PIXEL; 2], [Reciprocal::new(HALF_PIXEL); 2]);
                let sized = SizedBox { center, half, per_half, share, light, dither: 77 };
                sized.draw(&mut wanted.canvas().levels[0], sign);
                let value = light.in_pixel(share, light.shift(HEIGHT_BITS), 77, 0);
                found.canvas().levels[0].add_pixel(row, column, value, sign);
            }
            assert!(found == wanted, "{light:?} {share}");
        }
    }
}
