//! A photograph packed to four bytes per pixel.
//!
//! Ten bits per channel store the square root of the light: a step is about two thousandths of white at white and finer
//! in the dark, similar to 8-bit sRGB. The last two bits tell whether the sensor clipped.

use glam::{DVec2, Vec3};
use scene::Photograph;

/// A photograph as linear light between 0 and its brightest pixel.
#[derive(Debug)]
pub(crate) struct PackedPicture {
    pub width: u32,
    pub height: u32,
    /// Pixels of the file per stored pixel, each way.
    pub reduction: u32,
    brightest: f32,
    pixels: Vec<u32>,
}

/// An interpolated value of a picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PictureSample {
    pub light: Vec3,
    /// Share of clipped pixels, in [0, 1].
    pub clipped: f32,
}

const STEPS: f32 = 1023.0;

impl PackedPicture {
    /// Packs a photograph, averaging squares of `reduction` × `reduction` pixels (at least 1).
    pub fn new(photograph: &Photograph, reduction: u32) -> Self {
        let reduction = reduction.max(1);
        let [width, height] =
            [photograph.width, photograph.height].map(|side| side.div_ceil(reduction).max(1));
        let brightest = photograph.pixels.iter().flatten().copied().filter(|v| v.is_finite());
        let (brightest, limit) = (brightest.fold(1.0, f32::max), photograph.clipping_level());
        let mut pixels = Vec::with_capacity(width as usize * height as usize);
        for y in 0..height {
            for x in 0..width {
                let (mut sum, mut count, mut is_clipped) = (Vec3::ZERO, 0.0, false);
                for row in (y * reduction)..((y + 1) * reduction).min(photograph.height) {
                    for column in (x * reduction)..((x + 1) * reduction).min(photograph.width) {
                        let pixel = photograph.pixels[(row * photograph.width + column) as usize];
                        let light = Vec3::from_array(pixel).max(Vec3::ZERO);
                        is_clipped |= light.max_element() >= limit;
                        sum += light;
                        count += 1.0;
                    }
                }
                pixels.push(pack_pixel(sum / (count * brightest), is_clipped));
            }
        }
        Self { width, height, reduction, brightest, pixels }
    }

    /// The picture at half the resolution, each pixel the mean of up to four.
    pub fn halved(&self) -> Self {
        let [width, height] = [self.width, self.height].map(|side| side.div_ceil(2));
        let mut pixels = Vec::with_capacity(width as usize * height as usize);
        for y in 0..height {
            for x in 0..width {
                let (mut sum, mut count, mut is_clipped) = (Vec3::ZERO, 0.0, false);
                for row in 2 * y..(2 * y + 2).min(self.height) {
                    for column in 2 * x..(2 * x + 2).min(self.width) {
                        let (light, is_at_limit) = self.pixel((row * self.width + column) as usize);
                        is_clipped |= is_at_limit;
                        sum += light;
                        count += 1.0;
                    }
                }
                pixels.push(pack_pixel(sum / (count * self.brightest), is_clipped));
            }
        }
        Self { width, height, reduction: 2 * self.reduction, brightest: self.brightest, pixels }
    }

    /// Position of a pixel position of the file in this picture, from its upper left corner.
    pub fn place(&self, pixel: DVec2) -> DVec2 {
        pixel / f64::from(self.reduction)
    }

    /// The light at a [`Self::place`]: bilinear between pixels, clamped at the border.
    pub fn at(&self, place: DVec2) -> PictureSample {
        let at = place - 0.5;
        let floor = at.floor();
        let share = (at - floor).as_vec2();
        let (x, y) = (floor.x as i64, floor.y as i64);
        let mut sample = PictureSample { light: Vec3::ZERO, clipped: 0.0 };
        for (dx, dy, weight) in [
            (0, 0, (1.0 - share.x) * (1.0 - share.y)),
            (1, 0, share.x * (1.0 - share.y)),
            (0, 1, (1.0 - share.x) * share.y),
            (1, 1, share.x * share.y),
        ] {
            let column = (x + dx).clamp(0, i64::from(self.width) - 1) as usize;
            let row = (y + dy).clamp(0, i64::from(self.height) - 1) as usize;
            let (light, is_clipped) = self.pixel(row * self.width as usize + column);
            sample.light += light * weight;
            sample.clipped += if is_clipped { weight } else { 0.0 };
        }
        sample
    }

    /// The light of a pixel, linear RGB, by its index row by row, and whether it is clipped.
    pub fn pixel(&self, index: usize) -> (Vec3, bool) {
        let word = self.pixels[index];
        let square_root =
            Vec3::new((word & 1023) as f32, (word >> 10 & 1023) as f32, (word >> 20 & 1023) as f32);
        let square_root = square_root / STEPS;
        (square_root * square_root * self.brightest, word >> 30 != 0)
    }

    /// Upper bound of the light of all pixels, per channel.
    pub fn brightest(&self) -> f32 {
        self.brightest
    }
}

fn pack_pixel(share: Vec3, is_clipped: bool) -> u32 {
    let [r, g, b] = share.to_array().map(|v| (v.clamp(0.0, 1.0).sqrt() * STEPS + 0.5) as u32);
    r | g << 10 | b << 20 | u32::from(is_clipped) << 30
}

#[cfg(test)]
mod tests {
    use super::*;

    fn photograph(pixels: &[f32]) -> Photograph {
        let pixels = pixels.iter().map(|&v| [v, v / 2.0, v / 4.0]).collect::<Vec<_>>();
        Photograph { width: 2, height: 2, pixels }
    }

    #[test]
    fn packing_preserves_light() {
        let packed = PackedPicture::new(&photograph(&[0.0, 0.25, 0.5, 1.0]), 1);
        for (index, value) in [0.0, 0.25, 0.5, 1.0].into_iter().enumerate() {
            let (light, is_clipped) = packed.pixel(index);
            // Half a step of the root, times twice the root.
            assert!((light.x - value).abs() <= value.sqrt() / STEPS + 1e-6, "{light} for {value}");
            assert_eq!(is_clipped, value == 1.0);
        }
        let middle = packed.at(DVec2::ONE);
        assert!((middle.light.x - 0.4375).abs() < 2e-3 && middle.clipped == 0.25, "{middle:?}");
    }

    #[test]
    fn reduced_pixels_are_means_and_bright_ones_stay_bright() {
        let packed = PackedPicture::new(&photograph(&[0.0, 4.0, 8.0, 4.0]), 2);
        let (light, is_clipped) = packed.pixel(0);
        assert!((light.x - 4.0).abs() < 0.02 && !is_clipped, "{light}");
        assert_eq!((packed.width, packed.height, packed.place(DVec2::ONE)), (1, 1, DVec2::splat(0.5)));
        let halved = PackedPicture::new(&photograph(&[0.0, 4.0, 8.0, 4.0]), 1).halved();
        assert_eq!((halved.width, halved.height, halved.reduction), (1, 1, 2));
        assert!((halved.pixel(0).0.x - light.x).abs() < 0.02);
    }
}
