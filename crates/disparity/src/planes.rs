//! A picture as it is matched: one plane per channel, with one more column and row than the picture.
//!
//! Shifting a whole picture by a fraction of a pixel is then four products per value over slices of one length, which the compiler
//! vectorises; the last column and row are stored twice, so that the neighbour to the right and below always exists.

use crate::view::Picture;

/// The three planes of a picture.
#[derive(Clone, Debug)]
pub struct Planes {
    width: usize,
    height: usize,
    /// (width + 1) × (height + 1) values per channel.
    channels: [Vec<f32>; 3],
}

impl Planes {
    /// The colour channels of `picture` as planes.
    pub fn from_picture(picture: &Picture<'_>) -> Self {
        Self::from_fn(picture.width, picture.height, |x, y| picture.rgb[y * picture.width + x])
    }

    /// Planes of `width` × `height` px with the colour that `colour` returns for column and row of each pixel.
    pub fn from_fn(width: usize, height: usize, colour: impl Fn(usize, usize) -> [f32; 3]) -> Self {
        let stride = width + 1;
        let mut channels: [Vec<f32>; 3] = std::array::from_fn(|_| vec![0.0; stride * (height + 1)]);
        for y in 0..=height {
            for x in 0..=width {
                let pixel = colour(x.min(width - 1), y.min(height - 1));
                for (plane, value) in channels.iter_mut().zip(pixel) {
                    plane[y * stride + x] = value;
                }
            }
        }
        Self { width, height, channels }
    }

    /// The number of pixels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// The number of rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The RGB of the pixel in column `x` and row `y`.
    pub fn pixel(&self, x: usize, y: usize) -> [f32; 3] {
        let at = y * (self.width + 1) + x;
        [self.channels[0][at], self.channels[1][at], self.channels[2][at]]
    }

    /// Row `y` (up to `height`) of a channel (0 red, 1 green, 2 blue): width + 1 values, the last repeated.
    pub fn row(&self, channel: usize, y: usize) -> &[f32] {
        let stride = self.width + 1;
        &self.channels[channel][y * stride..(y + 1) * stride]
    }

    /// The bilinearly interpolated colour; `None` beyond the centres of the outermost pixels.
    pub fn sample_bilinear(&self, x: f32, y: f32) -> Option<[f32; 3]> {
        let (right, bottom) = ((self.width - 1) as f32, (self.height - 1) as f32);
        if !(x >= 0.0 && y >= 0.0 && x <= right && y <= bottom) {
            return None;
        }
        let (column, row) = (x as usize, y as usize);
        let (fx, fy) = (x - column as f32, y - row as f32);
        let stride = self.width + 1;
        let at = row * stride + column;
        let weights = [(1.0 - fx) * (1.0 - fy), fx * (1.0 - fy), (1.0 - fx) * fy, fx * fy];
        Some(std::array::from_fn(|c| {
            let plane = &self.channels[c];
            weights[0] * plane[at]
                + weights[1] * plane[at + 1]
                + weights[2] * plane[at + stride]
                + weights[3] * plane[at + stride + 1]
        }))
    }

    /// The picture at 1 / `factor` of its size, each pixel the mean of those it covers; a remainder at the right and below is
    /// dropped.
    pub fn shrunk(&self, factor: usize) -> Self {
        let share = 1.0 / (factor * factor) as f32;
        Self::from_fn(self.width / factor, self.height / factor, |x, y| {
            let mut sum = [0.0; 3];
            for row in y * factor..(y + 1) * factor {
                for column in x * factor..(x + 1) * factor {
                    let pixel = self.pixel(column, row);
                    sum.iter_mut().zip(pixel).for_each(|(sum, value)| *sum += value);
                }
            }
            sum.map(|sum| sum * share)
        })
    }

    /// Multiplies the RGB of every pixel by what `gain` returns for its column and row.
    pub fn scale(&mut self, gain: impl Fn(usize, usize) -> [f32; 3]) {
        let stride = self.width + 1;
        for y in 0..=self.height {
            for x in 0..=self.width {
                let gain = gain(x.min(self.width - 1), y.min(self.height - 1));
                for (plane, gain) in self.channels.iter_mut().zip(gain) {
                    plane[y * stride + x] *= gain;
                }
            }
        }
    }
}
