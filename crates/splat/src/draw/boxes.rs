//! Small images as boxes.

use crate::canvas::{PIXEL, POSITION_BITS, Rows, Word};
use crate::draw::Pen;
use crate::draw::image::Image;
use crate::nodes::ONE;
use crate::stencil::HEIGHT_BITS;

/// Half the longest side of a stretched footprint, 1/4096 px.
const LARGEST_HALF: i64 = 10 << POSITION_BITS;

/// A part of the aperture: its share times 2²⁴, mean and variance times 16384.
#[derive(Clone, Copy)]
pub struct BoxPart {
    pub share: i64,
    pub mean: [i64; 2],
    pub variance: [i64; 2],
}

impl Pen<'_> {
    /// The boxes of the aperture's parts, each with the node's weight toward it.
    ///
    /// Across a slanted surface the radius r changes, and neighbours move apart or together by 1 + u·∂r/∂x; the footprint
    /// is stretched as much, so that they still meet. For an unpainted surface ∂r/∂x is its weight's relative tilt.
    #[inline(always)]
    pub fn draw_parts<W: Word>(&self, image: &Image, depth_share: i32, rows: &mut Rows<W>, sign: i64) {
        let node = image.node;
        let tilt = [0, 1].map(|k| (node.tilt[k] as i64 * self.stop as i64) >> 14);
        for (index, part_of) in self.parts.iter().enumerate() {
            let weight = node.base as i64 + ((tilt[0] * part_of.mean[0] + tilt[1] * part_of.mean[1]) >> 14);
            if weight <= 0 {
                continue;
            }
            let exact =
                ((node.base as i64) << 10) + ((tilt[0] * part_of.mean[0] + tilt[1] * part_of.mean[1]) >> 4);
            let share = (((image.share * part_of.share) >> 24) * exact) >> 24;
            let mut part = Image { share, dither: image.dither.wrapping_add(index as u32), ..*image };
            // Within the part the light leans toward where the weight is.
            let lean = |k: usize| part_of.mean[k] + tilt[k] * part_of.variance[k] / weight;
            part.shift([lean(0), lean(1)]);
            let stretched = |k: usize| {
                let slope = (tilt[k] * depth_share as i64) >> 14;
                let factor = (ONE as i64 + ((slope * part_of.mean[k]) >> 14)).abs().max(ONE as i64 / 16);
                ((node.half_size[k] as i64 * factor) >> 14).min(LARGEST_HALF) as u16
            };
            self.draw_box(&part, [stretched(0), stretched(1)], part_of.variance, rows, sign);
        }
    }

    /// A box of the variance of footprint and aperture together.
    #[inline(always)]
    pub fn draw_box<W: Word>(
        &self,
        image: &Image,
        half_size: [u16; 2],
        variance: [i64; 2],
        rows: &mut Rows<W>,
        sign: i64,
    ) {
        let square = image.radius as i64 * image.radius as i64;
        let widened = |k: usize| {
            let half = half_size[k] as i64;
            integer_sqrt(half * half + ((3 * square * variance[k]) >> 14)).max(PIXEL as i64 / 32) as i32
        };
        let half = [widened(0), widened(1)];
        let [top, bottom] = [image.center[1] - half[1], image.center[1] + half[1]];
        let first = (top >> POSITION_BITS).max(rows.first);
        let last = ((bottom - 1) >> POSITION_BITS).min(rows.end - 1);
        if first > last {
            return;
        }
        let density = (1i64 << 52) / (4 * half[0] as i64 * half[1] as i64);
        for row in first..=last {
            let overlap = (bottom.min((row + 1) << POSITION_BITS) - top.max(row << POSITION_BITS)) as i64;
            let height = (overlap * density) >> 16;
            let value = image.value(height, HEIGHT_BITS, row);
            rows.add_run(row, image.center[0] - half[0], image.center[0] + half[0], value, sign);
        }
    }
}

/// ⌊√x⌋ for 0 ≤ x < 2⁵².
#[inline(always)]
pub fn integer_sqrt(x: i64) -> i64 {
    (x as f64).sqrt() as i64
}
