//! Decoding images: PNG, JPEG and WebP, 8 or 16 bits, grey, palette or colour, and KTX 2 with Basis Universal
//! textures, within limits.

use crate::error::Fault;
use crate::gltf::document::{Document, nonempty_name};
use crate::picture_decoder::open_picture;
use crate::{Image, ImageLevel};
use basisu::{DecodeFlags, TargetFormat, Transcoder};
use image::{DynamicImage, ImageDecoder, ImageFormat, Limits};
use std::borrow::Cow;
use std::io::Cursor;

/// The first bytes of a KTX 2 file.
const KTX2: [u8; 12] = *b"\xABKTX 20\xBB\r\n\x1A\n";

/// glTF's media type of an image, for the formats that glTF defines.
pub(crate) fn mime_type(bytes: &[u8]) -> Option<&'static str> {
    if bytes.starts_with(&KTX2) {
        return Some("image/ktx2");
    }
    match image::guess_format(bytes).ok()? {
        ImageFormat::Png => Some("image/png"),
        ImageFormat::Jpeg => Some("image/jpeg"),
        ImageFormat::WebP => Some("image/webp"),
        _ => None,
    }
}

impl Document<'_> {
    /// The encoded bytes of image `index`, to which `place` refers.
    ///
    /// # Errors
    /// The image does not exist, is faulty, or its file cannot be read.
    pub fn image_bytes(&self, index: usize, place: &str) -> Result<Cow<'_, [u8]>, Fault> {
        let place = self.entry("images", index, place)?;
        self.check_below(&place)?;
        // The typed view requires a media type with a buffer view; the bytes are sufficient.
        let image = self.typed().as_json().images.get(index);
        let source = image.map(|image| (image.uri.as_deref(), image.buffer_view));
        match source {
            Some((Some(uri), _)) => Ok(self.resource(&place, uri)?.into()),
            Some((None, Some(view))) => {
                Ok(self.buffer_view(view.value(), &format!("{place}/bufferView"))?.0.into())
            }
            _ => Err(Fault::Malformed {
                place: format!("{place}/uri"),
                what: "is missing, and there is no bufferView either".into(),
            }),
        }
    }

    /// Decodes image `index`, to which `place` refers.
    ///
    /// # Errors
    /// As [`Self::image_bytes`], or it is no PNG, JPEG, WebP or KTX 2, is damaged, or exceeds the budget.
    pub fn decode_image(&self, index: usize, place: &str) -> Result<Image, Fault> {
        let bytes = self.image_bytes(index, place)?;
        let place = format!("/images/{index}");
        match mime_type(&bytes) {
            Some("image/png" | "image/jpeg" | "image/webp") => {}
            Some("image/ktx2") => return self.decode_basis_image(index, &bytes, &place),
            _ => {
                return Err(Fault::Malformed { place, what: "is neither PNG, JPEG, WebP nor KTX 2".into() });
            }
        }
        let broken = |error: image::ImageError| Fault::Malformed {
            place: place.clone(),
            what: format!("cannot be decoded: {error}"),
        };
        // The budget limits the memory of the pixels.
        let decoder = open_picture(Cursor::new(&bytes[..]), Limits::no_limits()).map_err(broken)?;
        let (width, height) = decoder.dimensions();
        let texels = self.checked_texel_count([width, height], bytes.len(), &place)?;
        let deep = decoder.color_type().bytes_per_pixel() / decoder.color_type().channel_count() > 1;
        let size = texels * if deep { 8 } else { 4 };
        // The decoder's own picture and the converted one exist at the same time.
        let decoding = decoder.total_bytes();
        self.budget.take_memory(size, &place)?;
        self.budget.take_memory(decoding, &place)?;
        let picture = DynamicImage::from_decoder(decoder).map_err(broken)?;
        let texels = match deep {
            true => ImageLevel::Bits16(picture.into_rgba16().into_raw()),
            false => ImageLevel::Bits8(picture.into_rgba8().into_raw()),
        };
        self.budget.release_memory(decoding);
        if let Cow::Owned(bytes) = bytes {
            self.budget.release_memory(bytes.len() as u64);
        }
        Ok(Image { name: self.image_name(index), width, height, texels })
    }

    /// Decodes the largest level of a Basis Universal texture.
    fn decode_basis_image(&self, index: usize, bytes: &[u8], place: &str) -> Result<Image, Fault> {
        let broken = |error: basisu::Error| Fault::Malformed {
            place: place.into(),
            what: format!("cannot be decoded: {error:?}"),
        };
        // The declared size, before anything is allocated.
        let [width, height] = [20, 24].map(|at| le_bytes(bytes, at).map_or(0, u32::from_le_bytes));
        let texels = self.checked_texel_count([width, height], bytes.len(), place)?;
        self.budget.take_memory(4 * texels, place)?;
        let inflated = ktx2_inflated_bytes(bytes);
        let blocks = u64::from(width.div_ceil(4)) * u64::from(height.div_ceil(4));
        if inflated > BLOCK_BYTES * blocks {
            return Err(Fault::Malformed {
                place: place.into(),
                what: format!("claims {inflated} bytes for {width}×{height} texels"),
            });
        }
        self.budget.take_memory(inflated, place)?;
        let texture = Transcoder::new(bytes).map_err(broken)?;
        if texture.base_dimensions() != (width, height) {
            return Err(Fault::Malformed {
                place: place.into(),
                what: "declares two different sizes".into(),
            });
        }
        let texels = texture.transcode(0, TargetFormat::Rgba32, DecodeFlags::NONE).map_err(broken)?;
        self.budget.release_memory(inflated);
        Ok(Image { name: self.image_name(index), width, height, texels: ImageLevel::Bits8(texels) })
    }

    /// Number of texels of an image of this size, if within the limits.
    pub(crate) fn checked_texel_count(
        &self,
        [width, height]: [u32; 2],
        bytes: usize,
        place: &str,
    ) -> Result<u64, Fault> {
        let texels = u64::from(width) * u64::from(height);
        let limit = self.budget.options.max_texels;
        if texels > limit {
            let what = format!("{place}: {width}×{height} texels, the limit is {limit}");
            return Err(Fault::TooBig { what });
        }
        self.budget.take_work(texels + bytes as u64 / 8, place)?;
        if texels == 0 {
            return Err(Fault::Malformed { place: place.into(), what: "has no texels".into() });
        }
        Ok(texels)
    }

    fn image_name(&self, index: usize) -> String {
        let file = self.typed().as_json().images.get(index);
        let uri = file.and_then(|file| file.uri.clone());
        let uri = uri.filter(|uri| crate::gltf::container::data_uri::strip_data_scheme(uri).is_none());
        let name = file.and_then(|file| nonempty_name(file.name.as_deref())).or(uri);
        name.unwrap_or_else(|| format!("image {index}"))
    }
}

/// Bytes of a block of UASTC, of 4 × 4 texels, and of ASTC, of at least as many.
const BLOCK_BYTES: u64 = 16;

/// The bytes that the largest level of a KTX 2 file claims to inflate to; 0 where it is not compressed by Zstandard
/// ([KTX 2.0](https://registry.khronos.org/KTX/specs/2.0/ktxspec.v2.html), *File Structure*).
fn ktx2_inflated_bytes(bytes: &[u8]) -> u64 {
    const ZSTANDARD: u32 = 2;
    let scheme = le_bytes(bytes, 44).map(u32::from_le_bytes);
    let inflated = le_bytes(bytes, 96).map(u64::from_le_bytes);
    inflated.filter(|_| scheme == Some(ZSTANDARD)).unwrap_or(0)
}

/// The bytes of a number in a file.
fn le_bytes<const N: usize>(bytes: &[u8], at: usize) -> Option<[u8; N]> {
    bytes.get(at..at + N)?.try_into().ok()
}
