//! Layers of a picture: numbers in addition to its colours.

use lens::Picture;

/// One number per pixel in addition to the colour.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Its channel's name: `A` (alpha: the colour is then multiplied by it), `coverage`, `coc` (diameter of the
    /// circle of confusion, px), `depth.Z` (along the axis), `t`, …
    pub name: String,
    /// One value per pixel, row 0 on top.
    pub values: Vec<f32>,
}

impl Layer {
    /// The name of alpha.
    pub const ALPHA: &'static str = "A";
    /// The pinhole picture: `pinhole.R`, `pinhole.G` and `pinhole.B`, in the picture's own colour space.
    pub const PINHOLE: &'static str = "pinhole";

    /// The picture's coverage as a layer.
    pub fn coverage(picture: &Picture) -> Self {
        Self { name: "coverage".to_string(), values: picture.coverage.clone() }
    }

    /// Linear RGB as three layers: the name with .R, .G and .B.
    pub fn from_colors(name: &str, rgb: &[[f32; 3]]) -> [Self; 3] {
        color_channels(rgb).map(|(channel, values)| Self { name: format!("{name}.{channel}"), values })
    }
}

pub(crate) fn color_channels(rgb: &[[f32; 3]]) -> [(String, Vec<f32>); 3] {
    [("R", 0), ("G", 1), ("B", 2)].map(|(name, k)| (name.to_string(), rgb.iter().map(|c| c[k]).collect()))
}
