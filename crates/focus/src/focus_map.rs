//! A focus offset a texel of the atlas.

use lens::FocusOffset;

/// The painted focus map: t and anchor over the atlas. Texels that no surface covers hold dilated values.
#[derive(Clone, Debug, PartialEq)]
pub struct FocusMap {
    /// Columns, the atlas's.
    pub width: u32,
    /// Rows, the atlas's.
    pub height: u32,
    /// [t, anchor] a texel, row 0 on top.
    pub texels: Vec<[f32; 2]>,
}

impl FocusMap {
    /// A map of one value.
    pub fn new(width: u32, height: u32, value: FocusOffset) -> Self {
        let texel = [value.t as f32, value.anchor as f32];
        Self { width, height, texels: vec![texel; width as usize * height as usize] }
    }
}
