//! Decoding images: PNG, JPEG and WebP, 8 or 16 bits, grey, palette or colour, within limits.

use crate::document::Document;
use crate::error::Fault;
use crate::json_object::Object;
use crate::{Image, ImageLevel};
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};
use std::borrow::Cow;
use std::io::Cursor;

/// glTF's name of an image format, for those that glTF knows.
pub(crate) fn mime_type(bytes: &[u8]) -> Option<&'static str> {
    match image::guess_format(bytes).ok()? {
        ImageFormat::Png => Some("image/png"),
        ImageFormat::Jpeg => Some("image/jpeg"),
        ImageFormat::WebP => Some("image/webp"),
        _ => None,
    }
}

impl Document<'_> {
    /// The encoded bytes of an image.
    pub fn image_bytes(&self, image: &Object<'_>) -> Result<Cow<'_, [u8]>, Fault> {
        match (image.text("uri")?, image.index("bufferView")?) {
            (Some(uri), _) => Ok(self.resource(image, uri)?.into()),
            (None, Some(view)) => {
                Ok(self.buffer_view(view, &format!("{}/bufferView", image.place))?.0.into())
            }
            (None, None) => Err(image.malformed("uri", "is missing, and there is no bufferView either")),
        }
    }

    /// Decodes image `index`.
    pub fn image(&self, index: usize, place: &str) -> Result<Image, Fault> {
        let object = self.item("images", index, place)?;
        let bytes = self.image_bytes(&object)?;
        let format = match mime_type(&bytes) {
            Some("image/png") => ImageFormat::Png,
            Some("image/jpeg") => ImageFormat::Jpeg,
            Some("image/webp") => ImageFormat::WebP,
            _ => {
                return Err(Fault::Malformed {
                    place: object.place,
                    what: "is neither PNG, JPEG nor WebP".into(),
                });
            }
        };
        let broken = |error: image::ImageError| Fault::Malformed {
            place: object.place.clone(),
            what: format!("cannot be decoded: {error}"),
        };
        let mut reader = ImageReader::with_format(Cursor::new(&bytes[..]), format);
        let mut limits = Limits::default();
        limits.max_alloc = Some(self.budget.memory_left());
        reader.limits(limits);
        let decoder = reader.into_decoder().map_err(broken)?;
        let (width, height) = decoder.dimensions();
        let texels = u64::from(width) * u64::from(height);
        if texels > self.budget.options.max_texels {
            let limit = self.budget.options.max_texels;
            return Err(Fault::TooBig {
                what: format!("{}: {width}×{height} texels, the limit is {limit}", object.place),
            });
        }
        self.budget.work(texels + bytes.len() as u64 / 8, &object.place)?;
        if texels == 0 {
            return Err(Fault::Malformed { place: object.place, what: "has no texels".into() });
        }
        let deep = decoder.color_type().bytes_per_pixel() / decoder.color_type().channel_count() > 1;
        let size = texels * if deep { 8 } else { 4 };
        // The decoder's own picture exists beside the converted one.
        let decoding = decoder.total_bytes();
        self.budget.memory(size, &object.place)?;
        self.budget.memory(decoding, &object.place)?;
        let picture = DynamicImage::from_decoder(decoder).map_err(broken)?;
        let texels = match deep {
            true => ImageLevel::Bits16(picture.into_rgba16().into_raw()),
            false => ImageLevel::Bits8(picture.into_rgba8().into_raw()),
        };
        self.budget.release(decoding);
        if let Cow::Owned(bytes) = bytes {
            self.budget.release(bytes.len() as u64);
        }
        let uri = object.text("uri")?.filter(|uri| crate::resource::data_uri(uri).is_none());
        let name = object.name().or(uri).map_or_else(|| format!("image {index}"), String::from);
        Ok(Image { name, width, height, texels })
    }
}
