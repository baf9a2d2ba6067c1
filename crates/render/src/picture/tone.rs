//! Converting linear radiance to screen pixels: exposure, display gain, tone curve, clamping, sRGB encoding.

use crate::picture::tone_curve::ToneCurve;
use lens::{Exposure, Picture};
use numerics::screen_level;
use rayon::prelude::*;
use std::ops::Range;

/// A screen pixel: sRGB-encoded red, green and blue, and 255.
pub type ScreenPixel = [u8; 4];

/// Minimum number of pixels per task.
const MIN_PIXELS_PER_TASK: usize = 1 << 13;

/// How a picture is shown on screen.
///
/// ```
/// use render::{Tone, to_screen};
/// let mut picture = lens::Picture::black(1, 1);
/// (picture.radiance[0], picture.coverage[0]) = ([1.0; 3], 1.0);
/// assert_eq!(to_screen(&picture, Tone::default()), [[255; 4]]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Tone {
    /// Exposure: conserved or normalised.
    pub exposure: Exposure,
    /// Settings of the display, which are not part of the picture.
    pub display: Display,
}

/// Settings of the display.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Display {
    /// Display gain, stops.
    pub stops: f32,
    /// Tone mapping.
    pub curve: ToneCurve,
}

impl Tone {
    /// The picture as displayed, before clamping and encoding: linear RGB, row by row.
    pub fn displayed(self, picture: &Picture) -> Vec<[f32; 3]> {
        let shown = picture.radiance.par_iter().zip(&picture.coverage);
        let gain = self.display.stops.exp2();
        shown.map(|(radiance, coverage)| self.displayed_pixel(gain, *radiance, *coverage)).collect()
    }

    /// Converts a rectangle of the picture (columns and rows) to screen pixels, row by row.
    pub fn rectangle_to_screen(
        self,
        picture: &Picture,
        [columns, rows]: [Range<u32>; 2],
    ) -> Vec<ScreenPixel> {
        let gain = self.display.stops.exp2();
        let pixel = |index: usize| {
            let [r, g, b] = self.displayed_pixel(gain, picture.radiance[index], picture.coverage[index]);
            [screen_level(r), screen_level(g), screen_level(b), u8::MAX]
        };
        let width = columns.len();
        let mut pixels = vec![[0; 4]; width * rows.len()];
        if width > 0 {
            pixels
                .par_chunks_mut(width)
                .zip(rows)
                .with_min_len(MIN_PIXELS_PER_TASK.div_ceil(width))
                .for_each(|(pixels, row)| {
                    let first = row as usize * picture.width as usize + columns.start as usize;
                    for (offset, shown) in pixels.iter_mut().enumerate() {
                        *shown = pixel(first + offset);
                    }
                });
        }
        pixels
    }

    #[inline(always)]
    fn displayed_pixel(self, gain: f32, radiance: [f32; 3], coverage: f32) -> [f32; 3] {
        let scale = self.exposure.scale(gain, coverage);
        let [r, g, b] = radiance;
        self.display.curve.map([r * scale, g * scale, b * scale])
    }
}

/// Converts a picture of linear light to screen pixels (8-bit), row by row from the top.
pub fn to_screen(picture: &Picture, tone: Tone) -> Vec<ScreenPixel> {
    tone.rectangle_to_screen(picture, [0..picture.width, 0..picture.height])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown_at(exposure: Exposure, stops: f32) -> Tone {
        Tone { exposure, display: Display { stops, curve: ToneCurve::Clip } }
    }

    #[test]
    fn black_grey_and_white_are_encoded() {
        let mut picture = Picture::black(5, 1);
        picture.radiance = vec![[0.0; 3], [0.2140; 3], [1.0; 3], [7.0; 3], [f32::NAN; 3]];
        picture.coverage = vec![1.0; 5];
        let tone = shown_at(Exposure::Conserve, 0.0);
        let shown: Vec<u8> = to_screen(&picture, tone).iter().map(|c| c[0]).collect();
        assert_eq!(shown[0], 0);
        assert!(shown[1].abs_diff(127) <= 1, "{}", shown[1]);
        assert_eq!(shown[2..], [255, 255, 0]);
    }

    #[test]
    fn normalising_divides_by_coverage_and_a_stop_doubles() {
        let mut picture = Picture::black(2, 1);
        picture.radiance = vec![[0.5; 3], [0.25; 3]];
        picture.coverage = vec![2.0, 0.0];
        let shown = to_screen(&picture, shown_at(Exposure::Normalise, 0.0));
        assert_eq!(shown[1], [0, 0, 0, 255], "what nothing covers is black");
        let conserved = to_screen(&picture, shown_at(Exposure::Conserve, 1.0));
        assert_eq!(shown[0], to_screen(&picture, shown_at(Exposure::Conserve, -1.0))[0]);
        assert_eq!(conserved[0][0], 255);
    }
    #[test]
    fn a_rectangle_is_shown_as_it_is_in_the_whole() {
        let mut picture = Picture::black(300, 70);
        for (k, (radiance, coverage)) in picture.radiance.iter_mut().zip(&mut picture.coverage).enumerate() {
            (*radiance, *coverage) = ([k as f32 * 4e-5, 0.3, 0.01], 0.5 + (k % 7) as f32 * 0.1);
        }
        let tone = Tone { display: Display { stops: 0.3, curve: ToneCurve::Agx }, ..Tone::default() };
        let whole = to_screen(&picture, tone);
        let part = tone.rectangle_to_screen(&picture, [120..121, 3..70]);
        let expected: Vec<_> = (3..70).map(|y| whole[y * 300 + 120]).collect();
        assert_eq!(part, expected);
        assert!(tone.rectangle_to_screen(&picture, [5..5, 0..70]).is_empty());
    }
}
