//! A node's image before it is drawn: where, how large, how bright.

use crate::canvas::POSITION_BITS;
use crate::fixed::{GOLDEN, mul_shift, signed_mul_shift};
use crate::nodes::SplatNode;

/// Odd multipliers of the hash that dithers.
pub const HASH_Y: u32 = 0x85EB_CA77;
pub const HASH_MIX: u32 = 0xC2B2_AE3D;
pub const HASH_DITHER: u32 = 0x2C1B_3C6D;

/// Red, green, blue and coverage: `mantissa`·2^`exponent` quanta. The largest mantissa has 31 bits.
#[derive(Clone, Copy, Debug, Default)]
pub struct Light {
    /// Red, green, blue and coverage, to be multiplied by 2 to the power of `exponent`.
    pub mantissa: [u32; 4],
    /// The exponent that all four share.
    pub exponent: i32,
}

impl Light {
    /// Packs red, green, blue and weight, which must be finite and ≥ 0, as mantissas with one exponent.
    #[inline(always)]
    pub fn from_floats(light: [f32; 4]) -> Self {
        let bits = light.map(f32::to_bits);
        let top = bits[0].max(bits[1]).max(bits[2]).max(bits[3]) >> 23;
        let mut mantissa = [0; 4];
        for (mantissa, bits) in mantissa.iter_mut().zip(bits) {
            // Subnormal numbers are nothing.
            let is_normal = bits >> 23 > 0;
            let fraction = if is_normal { (bits & 0x7F_FFFF) | 0x80_0000 } else { 0 };
            *mantissa = (fraction << 7) >> (top - (bits >> 23)).min(31);
        }
        Self { mantissa, exponent: top as i32 - 157 }
    }

    /// That of a pixel of a level, where it is that of one of a level so many finer.
    #[inline(always)]
    pub fn coarser(self, levels: u8) -> Self {
        Self { exponent: self.exponent - 2 * levels as i32, ..self }
    }

    /// The shift that takes a mantissa times a height with `bits` bits behind the point to quanta.
    #[inline(always)]
    pub fn shift(&self, bits: u32) -> u32 {
        (bits as i32 - self.exponent).clamp(0, 63) as u32
    }

    /// That of a pixel of `height` (see [`Self::shift`]), rounded up or down at random so that the mean is kept: by where
    /// the node's dither starts, and the row from its centre's.
    #[inline(always)]
    pub fn in_pixel(&self, height: u32, shift: u32, dither: u32, row: i32) -> [u64; 4] {
        let hash = dither.wrapping_add((row as u32).wrapping_mul(GOLDEN));
        let hash = (hash ^ hash >> 15).wrapping_mul(HASH_DITHER) as u64;
        let dither = (hash << shift.saturating_sub(32)) >> 32u32.saturating_sub(shift);
        let mut value = [0; 4];
        for (value, mantissa) in value.iter_mut().zip(self.mantissa) {
            *value = (mantissa as u64 * height as u64 + dither) >> shift;
        }
        value
    }
}

/// A node's image on its level: centre and signed radius, 1/4096 px of the level.
pub struct Image<'a> {
    /// The node.
    pub node: &'a SplatNode,
    /// The level that it is drawn on; a pixel of it has a side of 2 to this, px.
    pub level: u8,
    /// The image's centre, 1/4096 px of the level.
    pub center: [i32; 2],
    /// The image's signed radius, 1/4096 px of the level: below 0 for near defocus.
    pub radius: i32,
    /// The node's light.
    pub light: Light,
    /// How much of the light is drawn, times 2²⁴.
    pub share: u32,
    /// Where its dither starts.
    pub dither: u32,
}

impl Image<'_> {
    /// Moves the centre by what the node's tilt moves its light's mean aperture point.
    #[inline(always)]
    pub fn lean(&mut self, node: &SplatNode, tilt_shift: [i32; 2]) {
        let lean = |k: usize| (node.tilt[k] as i32 * tilt_shift[k]) >> 14;
        self.shift([lean(0), lean(1)]);
    }

    /// Moves the centre to that of the light whose mean aperture point is `mean` (1/16384).
    #[inline(always)]
    pub fn shift(&mut self, mean: [i32; 2]) {
        let [x, y] = [signed_mul_shift(self.radius, mean[0], 14), signed_mul_shift(self.radius, mean[1], 14)];
        // Pixel rows go down, v goes up.
        self.center = [self.center[0].wrapping_add(x), self.center[1].wrapping_sub(y)];
    }

    /// The light of a pixel of `height` (see [`Light::in_pixel`]), in integers.
    #[inline(always)]
    pub fn value(&self, height: u32, shift: u32, row: i32) -> [u64; 4] {
        self.light.in_pixel(
            mul_shift(height, self.share, 24),
            shift,
            self.dither,
            self.rows_below_center(row),
        )
    }

    /// How far below the centre a row is: a frame's crop has the same bits.
    #[inline(always)]
    fn rows_below_center(&self, row: i32) -> i32 {
        row - (self.center[1] >> POSITION_BITS)
    }
}

/// The seed of a node's dither on a level, from the node's place relative to `middle`, the picture's: it does not
/// depend on what else is in the light field.
#[inline(always)]
pub fn seed(node: &SplatNode, level: u8, middle: [i32; 2]) -> u32 {
    let [x, y] = [(node.center[0] - middle[0]) as u32, (node.center[1] - middle[1]) as u32];
    (x.wrapping_mul(GOLDEN) ^ y.wrapping_mul(HASH_Y) ^ level as u32).wrapping_mul(HASH_MIX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_keeps_its_value() {
        for light in [[1.0f32, 0.5, 3.0, 1.0], [0.0, 1e-3, 4e6, 1.0], [0.0; 4], [1e14, 1.0, 7.0, 9.0]] {
            let found = Light::from_floats(light);
            let top = light.into_iter().fold(0.0, f32::max) as f64;
            for (wanted, mantissa) in light.into_iter().zip(found.mantissa) {
                let apart = mantissa as f64 * (found.exponent as f64).exp2() - wanted as f64;
                assert!(apart.abs() <= top * (-30f64).exp2(), "{light:?} {found:?}");
            }
        }
    }
}
