//! Pictures encoded for the screen, and their differences.

use crate::error::{MAX_SIDE_PX, WebPageError};
use std::ops::Range;
use std::sync::LazyLock;

/// The side of WebP's blocks, px.
const BLOCK_PX: usize = 16;
/// The root mean square difference of levels that eyes miss in a block.
const MISSED_LEVELS: f64 = 4.0;

/// The linear light of each level, in [0, 1].
static LIGHT: LazyLock<[f64; 256]> = LazyLock::new(|| {
    std::array::from_fn(|level| f64::from(numerics::linear_from_srgb(level as f64 / 255.0)))
});

/// A picture encoded for the screen: 8-bit sRGB, row by row from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ScreenPicture {
    /// Columns and rows.
    size: [u32; 2],
    /// One colour a pixel.
    pixels: Vec<[u8; 3]>,
}

impl ScreenPicture {
    /// A picture of `size` columns and rows.
    ///
    /// # Errors
    /// A side has no pixel or more than WebP allows, or the number of pixels is another.
    pub fn new(size: [u32; 2], pixels: Vec<[u8; 3]>) -> Result<Self, WebPageError> {
        Self::check_size(size)?;
        let [width, height] = size;
        if pixels.len() != width as usize * height as usize {
            return Err(WebPageError::Inconsistent("a picture has another number of pixels than its size"));
        }
        Ok(Self { size, pixels })
    }

    /// Checks that a picture may have `size` columns and rows.
    ///
    /// # Errors
    /// A side has no pixel or more than WebP allows.
    pub fn check_size(size: [u32; 2]) -> Result<(), WebPageError> {
        let fits = size.iter().all(|side| (1..=MAX_SIDE_PX).contains(side));
        if fits { Ok(()) } else { Err(WebPageError::Size(size[0], size[1])) }
    }

    /// Columns and rows.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The colours, row by row from the top.
    pub fn pixels(&self) -> &[[u8; 3]] {
        &self.pixels
    }

    /// The peak signal-to-noise ratio against a picture of the same size, dB, of linear light as elsewhere in the program; 200 for equal
    /// pictures.
    pub(crate) fn psnr(&self, reference: &Self) -> f64 {
        let light = &*LIGHT;
        let pairs = self.pixels.as_flattened().iter().zip(reference.pixels.as_flattened());
        let squares = pairs.map(|(&a, &b)| (light[usize::from(a)] - light[usize::from(b)]).powi(2));
        numerics::psnr(squares.sum::<f64>() / (3 * self.pixels.len()) as f64)
    }

    /// The picture with the blocks of `base`, a picture of the same size, whose mean square difference from it, of linear light, is at most
    /// `mean_square`, and whose levels differ by no more than eyes miss: linear light alone would keep dark blocks blurred.
    pub(crate) fn with_blocks_of(&self, base: &Self, mean_square: f64) -> Self {
        let mut pixels = self.pixels.clone();
        for block in self.blocks() {
            let (mut of_light, mut of_levels, mut count) = (0.0, 0, 0);
            for row in block.clone() {
                let [own, other] = [self, base].map(|picture| picture.pixels[row.clone()].as_flattened());
                for (&a, &b) in own.iter().zip(other) {
                    of_light += (LIGHT[usize::from(a)] - LIGHT[usize::from(b)]).powi(2);
                    of_levels += u64::from(a.abs_diff(b)).pow(2);
                }
                count += own.len();
            }
            let count = count as f64;
            if of_light <= mean_square * count && of_levels as f64 <= MISSED_LEVELS.powi(2) * count {
                block.for_each(|row| pixels[row.clone()].copy_from_slice(&base.pixels[row]));
            }
        }
        Self { size: self.size, pixels }
    }

    /// The blocks, each as the pixels of its rows.
    fn blocks(&self) -> impl Iterator<Item = impl Iterator<Item = Range<usize>> + Clone> {
        let [width, height] = self.size.map(|side| side as usize);
        let corners = (0..height).step_by(BLOCK_PX);
        let corners = corners.flat_map(move |top| (0..width).step_by(BLOCK_PX).map(move |left| [left, top]));
        corners.map(move |[left, top]| {
            let columns = left..(left + BLOCK_PX).min(width);
            (top..(top + BLOCK_PX).min(height))
                .map(move |y| y * width + columns.start..y * width + columns.end)
        })
    }

    /// What is to be added to `base`, a picture of the same size, for this one: their differences, 128 where there is none, as far as that goes.
    pub(crate) fn difference_from(&self, base: &Self) -> Self {
        self.combined(base, |own, base| own - base + 128)
    }

    /// The picture of which `difference` is the [difference](Self::difference_from) from this one.
    pub(crate) fn plus_difference(&self, difference: &Self) -> Self {
        self.combined(difference, |own, difference| own + difference - 128)
    }

    fn combined(&self, other: &Self, level: impl Fn(i16, i16) -> i16) -> Self {
        let level = |a: u8, b: u8| level(i16::from(a), i16::from(b)).clamp(0, 255) as u8;
        let color = |(a, b): (&[u8; 3], &[u8; 3])| std::array::from_fn(|c| level(a[c], b[c]));
        Self { size: self.size, pixels: self.pixels.iter().zip(&other.pixels).map(color).collect() }
    }

    /// What a browser shows half way through a cross-fade of two pictures of the same size.
    pub(crate) fn cross_fade(&self, other: &Self) -> Self {
        let mean = |a: u8, b: u8| u16::from(a).midpoint(u16::from(b) + 1) as u8;
        let mean_color = |(a, b): (&[u8; 3], &[u8; 3])| std::array::from_fn(|c| mean(a[c], b[c]));
        Self { size: self.size, pixels: self.pixels.iter().zip(&other.pixels).map(mean_color).collect() }
    }

    /// The picture reduced by a whole number to at most `longest_side_px`: means of squares; incomplete ones at the right and at the bottom
    /// are left out.
    pub(crate) fn reduced(&self, longest_side_px: u32) -> Self {
        let [width, height] = self.size;
        let factor = width.max(height).div_ceil(longest_side_px).min(width).min(height);
        let size = [width / factor, height / factor];
        let mean_color = |x: u32, y: u32| -> [u8; 3] {
            let mut sum = [0u64; 3];
            for row in y * factor..(y + 1) * factor {
                let first = (row * width + x * factor) as usize;
                for color in &self.pixels[first..first + factor as usize] {
                    (0..3).for_each(|c| sum[c] += u64::from(color[c]));
                }
            }
            sum.map(|sum| (sum / u64::from(factor).pow(2)) as u8)
        };
        let pixels = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| mean_color(x, y))).collect();
        Self { size, pixels }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_that_are_good_enough_are_kept() {
        // Blocks of 16 × 16 px, the last ones cut off; each by one more level from the base than the one before.
        let block = |k: u32| (k % 40 / 16 + 3 * (k / 40 / 16)) as u8;
        let picture = |level: &dyn Fn(u8) -> u8| {
            ScreenPicture::new([40, 24], (0..40 * 24).map(|k| [level(block(k)); 3]).collect()).unwrap()
        };
        let base = picture(&|_| 100);
        let kept = picture(&|block| 100 + block).with_blocks_of(&base, 1.0);
        assert_eq!(kept, picture(&|block| if block <= 4 { 100 } else { 100 + block }), "by levels");
        let step = LIGHT[102] - LIGHT[100];
        let kept = picture(&|block| 100 + block).with_blocks_of(&base, 1.001 * step * step);
        assert_eq!(kept, picture(&|block| if block <= 2 { 100 } else { 100 + block }), "by light");
    }

    fn grey(values: &[u8]) -> ScreenPicture {
        ScreenPicture::new([values.len() as u32, 1], values.iter().map(|&v| [v; 3]).collect()).unwrap()
    }

    #[test]
    fn sizes_are_checked() {
        for size in [[0, 1], [1, 0], [16384, 1], [u32::MAX, u32::MAX]] {
            assert_eq!(ScreenPicture::new(size, Vec::new()), Err(WebPageError::Size(size[0], size[1])));
        }
        assert!(ScreenPicture::new([2, 2], vec![[0; 3]; 3]).is_err());
    }

    #[test]
    fn differences_are_those_of_light() {
        // Levels 188 and 255 are the light 0.5029 and 1.
        let (a, b) = (grey(&[188, 255]), grey(&[255, 188]));
        assert!((a.psnr(&b) + 20.0 * (1.0 - 0.5029f64).log10()).abs() < 1e-3, "{}", a.psnr(&b));
        assert_eq!(a.psnr(&a), 200.0);
        assert_eq!(grey(&[0]).psnr(&grey(&[255])), 0.0);
    }

    #[test]
    fn a_difference_leads_back() {
        let (base, picture) = (grey(&[0, 255, 10, 200]), grey(&[100, 200, 13, 60]));
        let difference = picture.difference_from(&base);
        assert_eq!(difference, grey(&[228, 73, 131, 0]));
        assert_eq!(base.plus_difference(&difference), grey(&[100, 200, 13, 72]), "no more than 128 darker");
    }

    #[test]
    fn midway_lies_between() {
        assert_eq!(
            grey(&[0, 255, 10, 255]).cross_fade(&grey(&[255, 255, 13, 254])),
            grey(&[128, 255, 12, 255])
        );
    }

    #[test]
    fn a_reduced_picture_has_the_means() {
        let picture = ScreenPicture::new([5, 2], (0..10).map(|k| [10 * k; 3]).collect()).unwrap();
        let reduced = picture.reduced(2);
        assert_eq!(reduced.size(), [2, 1], "by 2, since by 3 the picture is not high enough");
        assert_eq!(reduced.pixels(), [[30; 3], [50; 3]]);
        assert_eq!(picture.reduced(5), picture);
    }
}
