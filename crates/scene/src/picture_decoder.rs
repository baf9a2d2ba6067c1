//! Decoders of picture files, chosen by their first bytes.

mod radiance;

use image::{ImageDecoder, ImageReader, ImageResult, Limits};
use radiance::RadianceDecoder;
use std::io::{BufRead, Seek};

/// Opens the decoder of a picture (PNG, JPEG, WebP or Radiance HDR), which its first bytes determine. Only its header
/// is read; the decoder checks the sides and, where the format lets it, the memory against `limits`.
///
/// Radiance HDR is read as Radiance, Blender and ImageMagick write it: any `#?` at the beginning, all eight
/// orientations, pixels uncoded or in either run-length coding. The result is linear RGB in 32-bit floats. Like in
/// Blender and three.js, `EXPOSURE` and `COLORCORR` are not divided out.
///
/// # Errors
/// The input cannot be read, its format is none of these, its header is damaged, or the picture exceeds the limits.
pub fn open_picture<'a>(
    mut input: impl BufRead + Seek + 'a,
    limits: Limits,
) -> ImageResult<Box<dyn ImageDecoder + 'a>> {
    if RadianceDecoder::is_radiance(&mut input)? {
        let mut decoder = RadianceDecoder::open(input)?;
        decoder.set_limits(limits)?;
        return Ok(Box::new(decoder));
    }
    let mut reader = ImageReader::new(input).with_guessed_format()?;
    reader.limits(limits);
    Ok(Box::new(reader.into_decoder()?))
}
