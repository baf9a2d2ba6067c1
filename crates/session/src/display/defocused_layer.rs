//! What a picture of one ray a pixel knows better than a rough picture that is enlarged.
//!
//! A rough picture has few pixels, and shows as blocks what is in focus or hardly blurred. There, the picture without blur, blurred by itself,
//! takes its place; the rough one shows what that cannot know, in large blur: what is behind, and light that differs over the aperture.

use crate::display::defocusing::Defocused;
use crate::display::enlarging::enlarged;
use crate::display::layer::{PictureLayer, share_below};
use lens::Picture;
use std::ops::RangeInclusive;
use std::sync::Arc;

/// Between these diameters of the smallest circle of confusion whose light is there, in pixels of the rough picture, that one's light takes over.
const ROUGH_CIRCLES: RangeInclusive<f32> = 2.5..=5.0;

impl Defocused {
    /// What is laid over a picture of `rough` columns and rows that is enlarged to `size`.
    pub fn layer_over(&self, rough: [u32; 2], size: [u32; 2]) -> PictureLayer {
        let circles = smallest_circles(self, rough);
        let shares = circles.into_iter().map(|circle| share_below(circle, &ROUGH_CIRCLES)).collect();
        PictureLayer::new(Arc::new(enlarged(&self.picture, size)), rough, shares)
    }
}

/// For every pixel of a rough picture the smallest circle whose light is in it, or in a pixel beside it; in its pixels.
fn smallest_circles(defocused: &Defocused, [columns, rows]: [u32; 2]) -> Vec<f32> {
    let Picture { width, height, .. } = defocused.picture;
    let diameters_per_radius = 2.0 * columns as f32 / width as f32;
    let mut circles = vec![f32::INFINITY; columns as usize * rows as usize];
    for (index, &radius) in (0..).zip(&defocused.min_radii) {
        let [column, row] = [index % width * columns / width, index / width * rows / height];
        for row in row.saturating_sub(1)..(row + 2).min(rows) {
            for column in column.saturating_sub(1)..(column + 2).min(columns) {
                let circle: &mut f32 = &mut circles[(row * columns + column) as usize];
                *circle = circle.min(diameters_per_radius * radius);
            }
        }
    }
    circles
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::display::layer::Layer;

    /// How much of a middle row of a picture of 160 × 80, enlarged to 320 × 160, is laid over a rough one of 40 × 20: the circles of its left half
    /// have so many pixels of the rough one, those of its right half eight.
    fn shares(left: f32) -> Vec<f32> {
        let mut picture = Picture::black(160, 80);
        picture.radiance.fill([1.0; 3]);
        let circle = |index: u32| if index % 160 < 80 { left } else { 8.0 };
        let min_radii = (0..160 * 80).map(|index| circle(index) * 4.0 / 2.0).collect();
        let layer = Defocused { picture, min_radii }.layer_over([40, 20], [320, 160]);
        let mut part = Picture::black(320, 1);
        layer.lay_over(&mut part, &[0..320, 80..81]);
        part.radiance.iter().map(|rgb| rgb[0]).collect()
    }

    #[test]
    fn what_is_hardly_blurred_is_shown_itself_and_large_blur_is_not() {
        let shares = shares(1.0);
        // One pixel of the rough picture, 8 of the enlarged one, beyond the middle, and half of that between two.
        assert!(shares[..160 + 4].iter().all(|&share| share == 1.0), "{shares:?}");
        assert!(shares[160 + 12..].iter().all(|&share| share == 0.0), "{shares:?}");
    }

    #[test]
    fn between_both_they_are_mixed() {
        let shares = shares(3.75);
        assert!(shares[..160].iter().all(|&share| (share - 0.5).abs() < 1e-5), "{shares:?}");
    }
}
