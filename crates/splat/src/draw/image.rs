//! A node's image before it is drawn: where, how large, how bright.

use crate::canvas::POSITION_BITS;
use crate::nodes::{Light, ONE, SplatNode};
use crate::stencil::HEIGHT_BITS;

/// All of the light, as a share.
pub const WHOLE: i64 = 1 << 24;

/// A node's image on its level: centre and signed radius, 1/4096 px of the level.
pub struct Image<'a> {
    pub node: &'a SplatNode,
    pub center: [i32; 2],
    pub radius: i32,
    pub light: Light,
    /// How much of the light is drawn, times 2²⁴.
    pub share: i64,
    /// Where its dither starts.
    pub dither: u32,
}

impl Image<'_> {
    /// Moves the centre by what the node's tilt moves its light's mean aperture point.
    #[inline(always)]
    pub fn lean(&mut self, node: &SplatNode, tilt_shift: [i64; 2]) {
        let moved = |k: usize| (node.tilt[k] as i64 * tilt_shift[k]) >> 14;
        self.shift([moved(0), moved(1)]);
    }

    /// Moves the centre to that of the light whose mean aperture point is `mean` (1/16384).
    #[inline(always)]
    pub fn shift(&mut self, mean: [i64; 2]) {
        let radius = self.radius as i64;
        // Rounded alike for either sign.
        let (x, y) = (radius * mean[0] / ONE as i64, radius * mean[1] / ONE as i64);
        // Pixel rows go down, v goes up.
        self.center = [self.center[0].saturating_add(x as i32), self.center[1].saturating_sub(y as i32)];
    }

    /// The light of a pixel, rounded up or down at random so that the mean is kept.
    #[inline(always)]
    pub fn value(&self, height: i64, bits: u32, row: i32) -> Light {
        // By the row from the centre's, so that a frame's crop has the same bits.
        let row = (row - (self.center[1] >> POSITION_BITS)) as u32;
        let dither = self.dither.wrapping_add(row.wrapping_mul(0x9E37_79B1));
        let dither = (dither ^ dither >> 15).wrapping_mul(0x2C1B_3C6D) as i64 >> (32 - HEIGHT_BITS);
        let dither = dither << (bits - HEIGHT_BITS);
        let height = (height * self.share) >> 24;
        let mut value = self.light;
        for light in &mut value {
            *light = (*light * height + dither) >> bits;
        }
        value
    }
}

/// Where a node's dither starts: its place from the picture's middle, whatever else is in the light field.
#[inline(always)]
pub fn seed(node: &SplatNode, middle: [i32; 2]) -> u32 {
    let [x, y] = [(node.center[0] - middle[0]) as u32, (node.center[1] - middle[1]) as u32];
    (x.wrapping_mul(0x9E37_79B1) ^ y.wrapping_mul(0x85EB_CA77) ^ node.level as u32).wrapping_mul(0xC2B2_AE3D)
}
