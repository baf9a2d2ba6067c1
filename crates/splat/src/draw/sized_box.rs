//! A box: how large it is, and its pixels.

use crate::aperture::stencil::HEIGHT_BITS;
use crate::canvas::{PIXEL, POSITION_BITS, Rows, Word};
use crate::draw::image::{Image, Light};
use crate::fixed::{Reciprocal, hypotenuse, mul_shift};

/// Half the shortest side of a box, 1/4096 px.
pub const SMALLEST_HALF: u32 = PIXEL as u32 / 32;

/// Half the side of a box that is a pixel, 1/4096 px.
pub const HALF_PIXEL: u32 = PIXEL as u32 / 2;

/// What a level blurs too much, as the square of half a box's side, (1/4096 px of the level)²: a pixel of level ℓ has a
/// variance that is larger by (4^ℓ − 1)/12 px² than it should be.
#[inline(always)]
pub const fn too_blurred(level: u8) -> u32 {
    const HALF_SQUARED: u32 = HALF_PIXEL * HALF_PIXEL;
    HALF_SQUARED - (HALF_SQUARED >> (2 * level))
}

/// The box of an image. Half its side along each axis is √(a² + b²), a the footprint's part and b the aperture's, less what
/// its level blurs too much.
pub struct UnsizedBox<'a> {
    pub image: &'a Image<'a>,
    /// By axis a and b, 1/4096 px.
    pub legs: [[u32; 2]; 2],
}

impl UnsizedBox<'_> {
    /// Whether its half sides' squares fit 31 bits.
    #[inline(always)]
    pub fn is_small(&self) -> bool {
        let [[a, b], [c, d]] = self.legs;
        a | b | c | d < 1 << 15
    }

    /// The box at its size, without `less`, the variance by which its level blurs too much.
    #[inline(always)]
    pub fn sized(&self, less: u32) -> SizedBox {
        let half = self.legs.map(|[a, b]| hypotenuse(a, b, less).max(SMALLEST_HALF));
        let Image { center, share, light, dither, .. } = *self.image;
        SizedBox { center, half, per_half: half.map(Reciprocal::new), share, light, dither }
    }
}

/// A box with its size.
pub struct SizedBox {
    /// On its level, 1/4096 px of it.
    pub center: [i32; 2],
    /// Half its sides, 1/4096 px.
    pub half: [u32; 2],
    /// Their reciprocals.
    pub per_half: [Reciprocal; 2],
    /// How much of the light is drawn, times 2²⁴.
    pub share: u32,
    pub light: Light,
    pub dither: u32,
}

impl SizedBox {
    /// Adds the box to the pixels in `rows`, or with `sign` −1 takes it away.
    #[inline(always)]
    pub fn draw<W: Word>(&self, rows: &mut Rows<W>, sign: i32) {
        let Self { center, half: [half, half_height], per_half: [across, down], .. } = *self;
        let [top, bottom] = [center[1] - half_height as i32, center[1] + half_height as i32];
        let first = (top >> POSITION_BITS).max(rows.first);
        let last = ((bottom - 1) >> POSITION_BITS).min(rows.end - 1);
        if first > last {
            return;
        }
        // The share is applied before rounding.
        let density = mul_shift(across.value, self.share, 26);
        let shift = self.light.shift(HEIGHT_BITS);
        let [start, end] = [center[0] - half as i32, center[0] + half as i32];
        let middle = center[1] >> POSITION_BITS;
        for row in first..=last {
            let overlap = bottom.min((row + 1) << POSITION_BITS) - top.max(row << POSITION_BITS);
            let share = mul_shift(overlap as u32, down.value, down.bits + 1);
            let height = mul_shift(share, density, across.bits + 25);
            let value = self.light.in_pixel(height, shift, self.dither, row - middle);
            rows.add_run(row, start, end, value, sign);
        }
    }
}
