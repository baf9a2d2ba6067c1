//! Texture sampling: the colour of an image at texture coordinates.
//!
//! glTF's rules: (0, 0) is the upper left corner of the upper left texel, texel centres lie at +0.5, colour is
//! decoded from sRGB for each texel *before* filtering, opacity is linear. There are no mip-maps: callers that need
//! texels over an area average them.

use crate::{Image, ImageLevel, Wrap};
use glam::{Vec2, Vec4};
use numerics::linear_from_srgb;
use std::sync::LazyLock;

/// sRGB decoding of 8-bit values.
static LINEAR_FROM_8: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|v| linear_from_srgb(v as f64 / 255.0)));
/// sRGB decoding of 16-bit values.
static LINEAR_FROM_16: LazyLock<Vec<f32>> =
    LazyLock::new(|| (0..=65535).map(|v| linear_from_srgb(v as f64 / 65535.0)).collect());

impl Wrap {
    /// The texel shown at position `i` of a row of `n` texels.
    #[inline]
    fn wrap_index(self, i: i32, n: i32) -> i32 {
        if (i as u32) < (n as u32) {
            return i;
        }
        match self {
            Self::Repeat => i.rem_euclid(n),
            Self::Clamp => i.clamp(0, n - 1),
            Self::Mirror => {
                let m = i64::from(i).rem_euclid(2 * i64::from(n)) as i32;
                if m < n { m } else { 2 * n - 1 - m }
            }
        }
    }
}

impl Image {
    /// RGBA of the texel in column `x` of row `y`, both within the image: linear RGB for an image of colours, else
    /// the numbers as they are, in [0, 1].
    pub fn texel(&self, x: u32, y: u32, is_color: bool) -> Vec4 {
        let at = self.texel_offset(x, y);
        self.mean(&TexelQuad { starts: [at; 4], shares: None }, is_color)
    }

    /// RGBA at texture coordinates, bilinear or of the nearest texel; colours are linear.
    #[inline]
    pub fn sample(&self, uv: Vec2, wrap: [Wrap; 2], nearest: bool, is_color: bool) -> Vec4 {
        /// At most half the range of i32, so that the right neighbour has a valid index.
        const FAR: f32 = (1 << 30) as f32;
        let (w, h) = (self.width as i32, self.height as i32);
        let start = |x: i32, y: i32| {
            self.texel_offset(wrap[0].wrap_index(x, w) as u32, wrap[1].wrap_index(y, h) as u32)
        };
        let at = uv * Vec2::new(w as f32, h as f32) - if nearest { 0.0 } else { 0.5 };
        let at = at.clamp(Vec2::splat(-FAR), Vec2::splat(FAR));
        let [x, y] = at.to_array().map(floor);
        let texels = match nearest {
            true => TexelQuad { starts: [start(x, y); 4], shares: None },
            false => TexelQuad {
                starts: [start(x, y), start(x + 1, y), start(x, y + 1), start(x + 1, y + 1)],
                shares: Some(at - Vec2::new(x as f32, y as f32)),
            },
        };
        self.mean(&texels, is_color)
    }

    /// Offset of a texel's values.
    #[inline]
    fn texel_offset(&self, x: u32, y: u32) -> usize {
        4 * (y as usize * self.width as usize + x as usize)
    }

    /// The weighted mean of some texels.
    #[inline]
    fn mean(&self, texels: &TexelQuad, is_color: bool) -> Vec4 {
        match (&self.texels, is_color) {
            (ImageLevel::Bits8(data), true) => {
                texels.mean(|at| color(&data[at..at + 4], &*LINEAR_FROM_8, 255.0))
            }
            (ImageLevel::Bits8(data), false) => texels.mean(|at| numbers(&data[at..at + 4], 255.0)),
            (ImageLevel::Bits16(data), true) => {
                texels.mean(|at| color(&data[at..at + 4], &LINEAR_FROM_16, 65535.0))
            }
            (ImageLevel::Bits16(data), false) => texels.mean(|at| numbers(&data[at..at + 4], 65535.0)),
            (ImageLevel::Float(data), _) => texels.mean(|at| Vec4::from_slice(&data[at..at + 4])),
        }
    }
}

/// Texels to be averaged: their offsets are computed once, and the format is dispatched once for all of them.
struct TexelQuad {
    /// Offsets of upper left, upper right, lower left, lower right.
    starts: [usize; 4],
    /// Weights of the right and lower ones, in [0, 1]; `None` for a single texel.
    shares: Option<Vec2>,
}

impl TexelQuad {
    #[inline]
    fn mean(&self, texel: impl Fn(usize) -> Vec4) -> Vec4 {
        let [upper_left, upper_right, lower_left, lower_right] = self.starts;
        let Some(to) = self.shares else { return texel(upper_left) };
        let upper = texel(upper_left) * (1.0 - to.x) + texel(upper_right) * to.x;
        let lower = texel(lower_left) * (1.0 - to.x) + texel(lower_right) * to.x;
        upper * (1.0 - to.y) + lower * to.y
    }
}

/// The largest whole number not above `v`, which must be within the range of i32: faster than [`f32::floor`], for
/// which not every processor has an instruction.
#[inline]
fn floor(v: f32) -> i32 {
    let toward_zero = v as i32;
    toward_zero - i32::from(toward_zero as f32 > v)
}

/// A texel of colours, decoded by a table; its opacity is linear, scaled by `max_value`.
#[inline]
fn color<T: Copy + Into<f32> + Into<usize>>(texel: &[T], linear: &[f32], max_value: f32) -> Vec4 {
    let linear_channel = |k: usize| linear[Into::<usize>::into(texel[k])];
    Vec4::new(
        linear_channel(0),
        linear_channel(1),
        linear_channel(2),
        Into::<f32>::into(texel[3]) * (1.0 / max_value),
    )
}

/// The four numbers of a texel, scaled by `max_value`.
#[inline]
fn numbers<T: Copy + Into<f32>>(texel: &[T], max_value: f32) -> Vec4 {
    Vec4::new(texel[0].into(), texel[1].into(), texel[2].into(), texel[3].into()) * (1.0 / max_value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row() -> Image {
        let texels = ImageLevel::Bits8(vec![0, 0, 0, 255, 255, 0, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255]);
        Image { name: "row".into(), width: 4, height: 1, texels }
    }

    fn at(x: f32, wrap: Wrap) -> Vec4 {
        row().sample(Vec2::new(x / 4.0, 0.5), [wrap; 2], false, true)
    }

    #[test]
    fn texel_centres_are_at_half() {
        assert_eq!(at(1.5, Wrap::Repeat), Vec4::new(1.0, 0.0, 0.0, 1.0));
        assert_eq!(at(2.5, Wrap::Repeat), Vec4::new(0.0, 1.0, 0.0, 0.0));
        assert_ne!(at(1.6, Wrap::Repeat), Vec4::new(1.0, 0.0, 0.0, 1.0));
    }

    #[test]
    fn colour_is_decoded_before_it_is_filtered() {
        // Between black and full red lies half the light, not the light of the encoded middle (0.214).
        assert_eq!(at(1.0, Wrap::Repeat).x, 0.5);
    }

    #[test]
    fn wraps() {
        assert_eq!(at(0.0, Wrap::Repeat).x, 0.5);
        assert_eq!(at(0.0, Wrap::Clamp).x, 0.0);
        assert_eq!(at(4.5, Wrap::Mirror), Vec4::ONE);
        assert_eq!(at(5.5, Wrap::Mirror), Vec4::new(0.0, 1.0, 0.0, 0.0));
        assert_eq!(at(-1.5, Wrap::Mirror), Vec4::new(1.0, 0.0, 0.0, 1.0));
        assert_eq!(at(-2.5, Wrap::Repeat), Vec4::new(1.0, 0.0, 0.0, 1.0));
    }

    #[test]
    fn nearest_takes_the_texel_that_covers_the_point() {
        let at = |x: f32| row().sample(Vec2::new(x / 4.0, 0.5), [Wrap::Repeat; 2], true, true);
        assert_eq!(at(1.01), Vec4::new(1.0, 0.0, 0.0, 1.0));
        assert_eq!(at(1.99), Vec4::new(1.0, 0.0, 0.0, 1.0));
    }

    #[test]
    fn absurd_coordinates_have_a_colour() {
        for x in [f32::MAX, f32::MIN, f32::INFINITY, f32::NAN, 3e9] {
            for wrap in [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror] {
                row().sample(Vec2::splat(x), [wrap; 2], false, true);
                row().sample(Vec2::splat(x), [wrap; 2], true, true);
            }
        }
    }

    #[test]
    fn sixteen_bits_decode_as_eight() {
        for v in 0..=255u16 {
            assert_eq!(LINEAR_FROM_8[v as usize], LINEAR_FROM_16[v as usize * 257]);
        }
    }
}
