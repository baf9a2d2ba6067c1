//! A photograph in shades of grey, reduced.

use super::distance_map::DistanceMap;
use glam::DVec2;
use scene::{LoadOptions, PictureError, View};

/// Square roots of luminance, as even to the eye as to noise, one a pixel of a [`DistanceMap`].
pub(super) struct GreyPicture {
    width: usize,
    height: usize,
    pixels: Vec<f32>,
}

impl GreyPicture {
    /// Reads a photograph at the size of its map, whose factor is whole; grey is the square root of luminance.
    ///
    /// # Errors
    /// The photograph cannot be read.
    pub fn read(view: &View, map: &DistanceMap, options: &LoadOptions) -> Result<Self, PictureError> {
        let photograph = view.read_photograph(options)?.downsampled(map.factor as u32);
        let grey = |[red, green, blue]: &[f32; 3]| {
            let luminance = 0.2126 * red + 0.7152 * green + 0.0722 * blue;
            if luminance.is_finite() { luminance.max(0.0).sqrt() } else { 0.0 }
        };
        Ok(Self {
            width: photograph.width as usize,
            height: photograph.height as usize,
            pixels: photograph.pixels.iter().map(grey).collect(),
        })
    }

    /// The grey value of a pixel; positions beyond the right or lower edge are those at the edge.
    pub fn pixel(&self, x: usize, y: usize) -> f64 {
        let (x, y) = (x.min(self.width - 1), y.min(self.height - 1));
        f64::from(self.pixels[y * self.width + x])
    }

    /// Bilinear; (0.5, 0.5) is the centre of the first pixel, and beyond the border the border continues.
    pub fn sample(&self, place: DVec2) -> f64 {
        let last = DVec2::new(self.width as f64 - 1.0, self.height as f64 - 1.0);
        let place = (place - 0.5).clamp(DVec2::ZERO, last);
        let corner = place.floor();
        let share = place - corner;
        let [x, y] = corner.to_array().map(|side| side as usize);
        let row = |y: usize| self.pixel(x, y) * (1.0 - share.x) + self.pixel(x + 1, y) * share.x;
        row(y) * (1.0 - share.y) + row(y + 1) * share.y
    }
}
