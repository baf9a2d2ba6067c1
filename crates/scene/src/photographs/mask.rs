//! Masks of photographs.

use super::View;
use super::photograph::{PictureError, decode_file};
use crate::LoadOptions;

/// A mask over the pixels of a photograph.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mask {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Whether each pixel is valid, row 0 on top.
    pub is_valid: Vec<bool>,
}

impl View {
    /// Reads the mask, if there is one: pixels brighter than half are valid. It may be smaller or larger than the
    /// picture; each pixel takes the value at its centre.
    ///
    /// # Errors
    /// The file cannot be read or decoded, or exceeds the limits of `options`.
    pub fn read_mask(&self, options: &LoadOptions) -> Result<Option<Mask>, PictureError> {
        let Some(file) = &self.mask else { return Ok(None) };
        let stored = decode_file(file, self.orientation, options)?.0.into_luma8();
        let [width, height] = self.lens.size_px();
        // The centre of pixel i of n lies in pixel ⌊(i + ½)·m/n⌋ of m.
        let stored_index =
            |i: u32, n: u32, m: u32| ((2 * u64::from(i) + 1) * u64::from(m) / (2 * u64::from(n))) as u32;
        let rows = 0..height;
        let is_valid = rows.flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| {
            stored
                .get_pixel(stored_index(x, width, stored.width()), stored_index(y, height, stored.height()))
                .0[0]
                > 127
        });
        Ok(Some(Mask { width, height, is_valid: is_valid.collect() }))
    }
}
