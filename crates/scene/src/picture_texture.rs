//! Surfaces that were made from a picture.

use crate::PictureGloss;
use std::sync::Arc;

/// The texture of a surface that was made from a picture: the picture, and what goes on behind it below. The first UV set is an atlas.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureTexture {
    /// Columns and rows.
    pub size: [u32; 2],
    /// The first row of what goes on behind.
    pub behind_first_row: u32,
    /// Columns and rows around the picture that it does not show.
    pub margin: u32,
    /// Pixels of the picture that a texel is wide and high.
    pub pixels_per_texel: u32,
    /// What it was made from, for people: the views and where their disparities are from, or the picture and its depth.
    pub origin: String,
    /// By texel, row 0 on top, whether it was photographed; else it was invented.
    pub is_photographed: Vec<bool>,
    /// How what it shows changes over the captured aperture, if there were views to tell it.
    pub gloss: Option<Arc<PictureGloss>>,
}

impl PictureTexture {
    /// Rows between the picture and what goes on behind it.
    pub const GUTTER: u32 = 4;

    /// Columns and rows that the picture shows.
    pub fn picture_size(&self) -> [u32; 2] {
        [self.size[0] - 2 * self.margin, self.behind_first_row - Self::GUTTER - 2 * self.margin]
    }

    /// Whether what is at this place of the texture, each coordinate in [0, 1], was photographed.
    pub fn is_photographed_at(&self, [u, v]: [f64; 2]) -> bool {
        let [width, height] = self.size;
        let texel = |at: f64, side: u32| ((at * f64::from(side)) as u32).min(side - 1) as usize;
        self.is_photographed[texel(v, height) * width as usize + texel(u, width)]
    }
}
