//! Surfaces made from a picture.

use crate::PictureGloss;
use std::sync::Arc;

/// The texture of a surface made from a picture: the picture, and below it the surface continued behind foreground
/// objects. The first UV set is an atlas.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureTexture {
    /// Columns and rows.
    pub size: [u32; 2],
    /// First row of the continued surface.
    pub behind_first_row: u32,
    /// Columns and rows around the picture that are not visible in it.
    pub margin: u32,
    /// Pixels of the picture per texel, in each direction.
    pub pixels_per_texel: u32,
    /// Description of its origin, for the user: the views and the source of their disparities, or the picture and its
    /// depth.
    pub origin: String,
    /// For each texel, row 0 on top, whether it was photographed; otherwise it is invented.
    pub is_photographed: Vec<bool>,
    /// How its light varies over the captured aperture, if there were views to measure it.
    pub gloss: Option<Arc<PictureGloss>>,
}

impl PictureTexture {
    /// Rows between the picture and the continued surface.
    pub const GUTTER: u32 = 4;

    /// Columns and rows of the picture itself, px, without what surrounds it.
    pub fn picture_size(&self) -> [u32; 2] {
        [self.size[0] - 2 * self.margin, self.behind_first_row - Self::GUTTER - 2 * self.margin]
    }

    /// Whether the texture shows the photograph at this position; u and v in [0, 1].
    pub fn is_photographed_at(&self, [u, v]: [f64; 2]) -> bool {
        let [width, height] = self.size;
        let texel = |at: f64, side: u32| ((at * f64::from(side)) as u32).min(side - 1) as usize;
        self.is_photographed[texel(v, height) * width as usize + texel(u, width)]
    }
}
