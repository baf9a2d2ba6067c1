//! Decoders of picture files, chosen by their first bytes.

mod radiance;

use image::{ImageDecoder, ImageFormat, ImageReader, ImageResult, Limits};
use radiance::RadianceDecoder;
use std::io::{BufRead, Seek};

/// Maximum memory for what a PNG has beside its pixels (a colour profile, texts) and for a row of them, bytes.
pub const MAX_PNG_EXTRAS_BYTES: u64 = 64 << 20;

/// Opens the decoder of a picture (PNG, JPEG, WebP or Radiance HDR), which its first bytes determine. Only its header
/// is read; the sides, and the memory of the decoded pixels, are checked against `limits`.
///
/// Radiance HDR is read as Radiance, Blender and ImageMagick write it: any `#?` at the beginning, all eight
/// orientations, pixels uncoded or in either run-length coding. The result is linear RGB in 32-bit floats. Like in
/// Blender and three.js, `EXPOSURE` and `COLORCORR` are not divided out.
///
/// # Errors
/// The input cannot be read, its format is none of these, its header is damaged, or the picture exceeds the limits.
pub fn open_picture<'a>(
    input: impl BufRead + Seek + 'a,
    limits: Limits,
) -> ImageResult<Box<dyn ImageDecoder + 'a>> {
    open_boxed(Box::new(input), limits)
}

/// What a decoder reads.
trait Input: BufRead + Seek {}

impl<T: BufRead + Seek> Input for T {}

/// The same for any input at once: the decoders are compiled a single time.
fn open_boxed<'a>(
    mut input: Box<dyn Input + 'a>,
    mut limits: Limits,
) -> ImageResult<Box<dyn ImageDecoder + 'a>> {
    if RadianceDecoder::is_radiance(&mut input)? {
        let mut decoder = RadianceDecoder::open(input)?;
        decoder.set_limits(limits)?;
        return Ok(Box::new(decoder));
    }
    let mut reader = ImageReader::new(input).with_guessed_format()?;
    let mut header_limits = limits.clone();
    if reader.format() == Some(ImageFormat::Png) {
        // The decoder of PNG inflates a profile of any length that its limit allows.
        let most = limits.max_alloc.unwrap_or(u64::MAX);
        header_limits.max_alloc = Some(most.min(MAX_PNG_EXTRAS_BYTES));
    }
    reader.limits(header_limits);
    let decoder = reader.into_decoder()?;
    limits.reserve(decoder.total_bytes())?;
    Ok(Box::new(decoder))
}
