//! Grey levels of pictures of 8 and 16 bits as numbers from 0 to 1, without conversion to linear light.

use super::stored::{Numbers, Stored};
use crate::files::folder::extension;
use crate::files::whole_file::whole_file;
use image::{ColorType, DynamicImage, ImageDecoder, Limits};
use scene::LoadOptions;
use std::io::Cursor;
use std::path::Path;

/// The error for maps whose numbers are colours.
const CODED: &str = "is coded by colour, not by grey";

/// Whether a file is a picture that is not grey: a map coded by colour. Files that cannot be read are reported when
/// they are decoded.
pub(crate) fn is_coded_by_color(file: &Path, options: &LoadOptions) -> bool {
    let is_picture = ["png", "jpg", "jpeg", "webp"].contains(&extension(file).as_str());
    let bytes = is_picture.then(|| whole_file(file, options.max_memory / 4).ok()).flatten();
    bytes.is_some_and(|bytes| levels_of(&bytes, options).is_err_and(|why| why == CODED))
}

/// Decodes the levels of a picture's bytes: the mean of the channels. If they differ, the map is coded by colour,
/// which is an error.
pub(crate) fn levels_of(bytes: &[u8], options: &LoadOptions) -> Result<Stored, String> {
    let text = |error: image::ImageError| format!("cannot be decoded: {error}");
    let mut limits = Limits::default();
    limits.max_alloc = Some(options.max_memory / 2);
    let decoder = scene::open_picture(Cursor::new(bytes), limits).map_err(text)?;
    let (width, height) = decoder.dimensions();
    let (pixels, limit) =
        (u64::from(width) * u64::from(height), options.max_texels.min(options.max_memory / 16));
    if pixels > limit {
        return Err(format!("has {width} × {height} px, more than the limit of {limit} px"));
    }
    let picture = DynamicImage::from_decoder(decoder).map_err(text)?;
    if is_colored(&picture) {
        return Err(CODED.into());
    }
    let numbers = match picture.color() {
        ColorType::Rgb32F | ColorType::Rgba32F => Numbers::Floats,
        _ => Numbers::Levels,
    };
    let values = match picture {
        DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_) => {
            picture.into_rgb32f().pixels().map(|pixel| pixel.0[0]).collect()
        }
        // Luma is a weighted mean; for equal channels it is each of them.
        picture if picture.color().bytes_per_pixel() / picture.color().channel_count() == 2 => {
            picture.into_luma16().into_raw().into_iter().map(|level| f32::from(level) / 65535.0).collect()
        }
        picture => {
            picture.into_luma8().into_raw().into_iter().map(|level| f32::from(level) / 255.0).collect()
        }
    };
    Ok(Stored { width, height, values, numbers })
}

/// Whether a tenth of the pixels are coloured; JPEG leaves traces of colour.
fn is_colored(picture: &DynamicImage) -> bool {
    let spread =
        |channels: [u16; 3]| channels.iter().max().unwrap_or(&0) - channels.iter().min().unwrap_or(&0);
    let (colored, all) = match picture {
        DynamicImage::ImageRgb8(rgb) => {
            counted(rgb.pixels().map(|pixel| spread(pixel.0.map(u16::from)) > 24))
        }
        DynamicImage::ImageRgba8(rgb) => counted(
            rgb.pixels().map(|pixel| spread([pixel.0[0], pixel.0[1], pixel.0[2]].map(u16::from)) > 24),
        ),
        DynamicImage::ImageRgb16(rgb) => counted(rgb.pixels().map(|pixel| spread(pixel.0) > 24 << 8)),
        DynamicImage::ImageRgba16(rgb) => {
            counted(rgb.pixels().map(|pixel| spread([pixel.0[0], pixel.0[1], pixel.0[2]]) > 24 << 8))
        }
        _ => (0, 1),
    };
    colored * 10 > all
}

fn counted(pixels: impl Iterator<Item = bool>) -> (usize, usize) {
    pixels.fold((0, 0), |(colored, all), is_colored| (colored + usize::from(is_colored), all + 1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{GrayImage, ImageFormat, Luma, Rgb, RgbImage};

    fn png(picture: DynamicImage) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        picture.write_to(&mut bytes, ImageFormat::Png).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn levels_are_not_light() {
        let options = LoadOptions::default();
        let grey = png(GrayImage::from_fn(3, 1, |x, _| Luma([[0, 51, 255][x as usize]])).into());
        assert_eq!(levels_of(&grey, &options).unwrap().values, [0.0, 0.2, 1.0]);
        let deep = image::ImageBuffer::from_fn(2, 1, |x, _| Luma([[1u16, 65535][x as usize]]));
        let deep = levels_of(&png(deep.into()), &options).unwrap();
        assert_eq!(deep.values, [1.0 / 65535.0, 1.0]);
        let equal = png(RgbImage::from_pixel(2, 2, Rgb([51; 3])).into());
        assert!(levels_of(&equal, &options).unwrap().values.iter().all(|level| (level - 0.2).abs() < 1e-6));
    }

    #[test]
    fn colours_are_no_levels() {
        let rainbow = png(RgbImage::from_fn(8, 8, |x, _| Rgb([x as u8 * 30, 255 - x as u8 * 30, 90])).into());
        assert!(levels_of(&rainbow, &LoadOptions::default()).err().unwrap().contains("coded by colour"));
        assert!(levels_of(b"no picture", &LoadOptions::default()).is_err());
    }
}
