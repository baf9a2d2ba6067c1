//! Maps of one byte a pixel that the viewer reads where somebody clicks, or draws as a tint.
//!
//! Their format: rows from the top, each byte as the difference from its left neighbour (mod 256; the first from 0), all compressed (zlib).
//! They are no pictures, because browsers that protect against fingerprinting alter what is read from a canvas.

use crate::deflate::deflate;
use crate::error::WebPageError;

/// A byte for each of `size` columns × rows, row by row from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PixelMap {
    /// Columns and rows.
    pub size: [u32; 2],
    /// One code a pixel: of [`DistanceRange::code`] or of paint.
    pub codes: Vec<u8>,
}

impl PixelMap {
    /// The map as the viewer reads it.
    ///
    /// # Errors
    /// [`WebPageError::Inconsistent`]: the number of codes is not that of the pixels.
    pub(crate) fn packed(&self) -> Result<Vec<u8>, WebPageError> {
        let [width, height] = self.size.map(|side| side as usize);
        if width == 0 || self.codes.len() != width * height {
            return Err(WebPageError::Inconsistent("a map has another number of codes than pixels"));
        }
        let differences = self.codes.chunks(width).flat_map(|row| {
            let left = std::iter::once(&0).chain(row);
            row.iter().zip(left).map(|(code, left)| code.wrapping_sub(*left))
        });
        deflate(&differences.collect::<Vec<_>>())
    }
}

/// The focus distances of a page, as reciprocals 1/s in 1/length: from the farthest to the nearest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DistanceRange {
    /// 1/s of the farthest, 0 at infinity.
    pub farthest: f64,
    /// 1/s of the nearest, at least `farthest`.
    pub nearest: f64,
}

impl DistanceRange {
    /// The code of a reciprocal distance: 1 for the farthest to 255 for the nearest, rounded; 0 where there is none in the range.
    pub fn code(&self, inverse_distance: Option<f64>) -> u8 {
        let extent = self.nearest - self.farthest;
        // Rounding is not to lose the ends.
        let slack = 1e-9 * self.nearest.abs();
        match inverse_distance {
            Some(inverse) if inverse >= self.farthest - slack && inverse <= self.nearest + slack => {
                let share = if extent > 0.0 { (inverse - self.farthest) / extent } else { 0.0 };
                1 + (254.0 * share.clamp(0.0, 1.0)).round() as u8
            }
            _ => 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::read::ZlibDecoder;
    use std::io::Read;

    #[test]
    fn maps_unpack_to_their_codes() {
        let codes: Vec<u8> = (0..7 * 5).map(|k: u32| (k * k % 256) as u8).collect();
        let packed = PixelMap { size: [7, 5], codes: codes.clone() }.packed().unwrap();
        let mut differences = Vec::new();
        ZlibDecoder::new(&packed[..]).read_to_end(&mut differences).unwrap();
        for row in differences.chunks_mut(7) {
            for x in 1..row.len() {
                row[x] = row[x].wrapping_add(row[x - 1]);
            }
        }
        assert_eq!(differences, codes);
        for size in [[7, 4], [0, 0]] {
            assert!(PixelMap { size, codes: codes.clone() }.packed().is_err());
        }
    }

    #[test]
    fn codes_span_the_range() {
        let range = DistanceRange { farthest: 0.1, nearest: 0.6 };
        let codes = [0.1, 0.35, 0.6, 0.6 + 1e-12, 0.6001, 0.0999].map(|inverse| range.code(Some(inverse)));
        assert_eq!(codes, [1, 128, 255, 255, 0, 0]);
        assert_eq!((range.code(None), range.code(Some(f64::NAN))), (0, 0));
        let flat = DistanceRange { farthest: 0.5, nearest: 0.5 };
        assert_eq!((flat.code(Some(0.5)), flat.code(Some(0.4))), (1, 0));
    }
}
