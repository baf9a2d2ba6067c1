//! Small boxes, drawn many at once: what takes roots and divisions is done for several of them in one go.

use crate::canvas::{Rows, Word};
use crate::draw::image::Light;
use crate::draw::sized_box::{SMALLEST_HALF, SizedBox, UnsizedBox};
use crate::fixed::{Reciprocal, floored};

/// How many wait until they are drawn.
const COUNT: usize = 32;

/// Small boxes of one level (see [`UnsizedBox::is_small`]) that are drawn together.
#[derive(Default)]
pub struct SmallBoxes {
    len: usize,
    /// By axis, the footprint's and the aperture's, as [`UnsizedBox::legs`].
    legs: [[[u32; COUNT]; 2]; 2],
    center: [[i32; 2]; COUNT],
    share: [u32; COUNT],
    dither: [u32; COUNT],
    light: [Light; COUNT],
}

/// Half the boxes' sides along an axis, and their reciprocals.
struct Sizes {
    half: [u32; COUNT],
    per_half: [Reciprocal; COUNT],
}

impl SmallBoxes {
    /// Adds a box; there must be room ([`Self::is_full`]).
    #[inline(always)]
    pub fn add(&mut self, unsized_box: &UnsizedBox) {
        let at = self.len;
        for axis in 0..2 {
            (0..2).for_each(|leg| self.legs[axis][leg][at] = unsized_box.legs[axis][leg]);
        }
        self.center[at] = unsized_box.image.center;
        self.share[at] = unsized_box.image.share;
        self.dither[at] = unsized_box.image.dither;
        self.light[at] = unsized_box.image.light;
        self.len += 1;
    }

    /// Whether there is no room for another box.
    #[inline(always)]
    pub fn is_full(&self) -> bool {
        self.len == COUNT
    }

    /// Whether it holds no box.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Draws them, their half sides' squares smaller by `less`; none are left.
    #[inline(always)]
    pub fn draw<W: Word>(&mut self, rows: &mut Rows<W>, less: u32, sign: i32) {
        let (across, down) = (sizes(&self.legs[0], less), sizes(&self.legs[1], less));
        for at in 0..self.len {
            let sized = SizedBox {
                center: self.center[at],
                half: [across.half[at], down.half[at]],
                per_half: [across.per_half[at], down.per_half[at]],
                share: self.share[at],
                light: self.light[at],
                dither: self.dither[at],
            };
            sized.draw(rows, sign);
        }
        self.len = 0;
    }
}

/// The sizes along an axis: [`crate::fixed::hypotenuse`] and [`Reciprocal::new`], several at a time.
#[inline(always)]
fn sizes([a, b]: &[[u32; COUNT]; 2], less: u32) -> Sizes {
    let (mut half, mut value, mut bits) = ([0; COUNT], [0; COUNT], [0; COUNT]);
    for at in 0..COUNT {
        let square = (a[at] * a[at] + b[at] * b[at]).saturating_sub(less) as i32;
        half[at] = floored((square as f64).sqrt()).max(SMALLEST_HALF);
    }
    for at in 0..COUNT {
        // 2^bits·mantissa. Of numbers below 2^16 the quotient 2^31/mantissa is much further below the next integer
        // than it is rounded.
        let number = (half[at] as i32 as f64).to_bits();
        let exponent = (number >> 52) - 1023;
        let mantissa = f64::from_bits(number - (exponent << 52));
        let quotient = (1u64 << 31) as f64 / mantissa;
        value[at] = floored(quotient);
        bits[at] = exponent as u32;
    }
    Sizes { half, per_half: std::array::from_fn(|at| Reciprocal { value: value[at], bits: bits[at] }) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixed::hypotenuse;

    #[test]
    fn sizes_are_those_of_single_boxes() {
        let mut legs: Vec<[u32; 2]> = (0..1 << 15).step_by(7).map(|a| [a, (a * 31) & 0x7FFF]).collect();
        legs.extend([
            [0, 0],
            [0, 127],
            [128, 0],
            [0x7FFF, 0x7FFF],
            [4096, 0],
            [3, 4],
            [32767, 1],
            [2048, 2048],
        ]);
        for chunk in legs.chunks(COUNT) {
            let column = |k: usize| std::array::from_fn(|at| chunk.get(at).map_or(0, |legs| legs[k]));
            for less in [0, 12 << 20] {
                let found = sizes(&[column(0), column(1)], less);
                for (at, [a, b]) in chunk.iter().enumerate() {
                    let half = hypotenuse(*a, *b, less).max(SMALLEST_HALF);
                    let wanted = (half, Reciprocal::new(half));
                    assert_eq!((found.half[at], found.per_half[at]), wanted, "{a} {b} {less}");
                }
            }
        }
    }
}
