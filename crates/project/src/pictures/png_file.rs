//! PNG files as stored numbers, and other pictures through the `image` crate.

use crate::ProjectError;
use crate::disk::read_bytes;
use image::{DynamicImage, ImageDecoder, Limits};
use png::{BitDepth, ColorType};
use std::io::Cursor;
use std::path::Path;

/// Maximum width and height of a picture that is read.
const MAX_SIDE: u32 = 32768;

/// Maximum number of pixels of a picture that is read: its decoded and its linear pixels take up to 20 bytes each.
const MAX_PIXELS: u64 = 1 << 27;

/// A decoded picture.
pub(crate) fn read_image(file: &Path) -> Result<DynamicImage, ProjectError> {
    let bytes = read_bytes(file)?;
    let error = |problem: String| {
        ProjectError::content(
            file,
            format!("is not a readable picture: {problem}"),
            "write it again, or take another copy",
        )
    };
    decode(&bytes).map_err(error)
}

/// Decodes the bytes of a picture's file.
pub(crate) fn decode(bytes: &[u8]) -> Result<DynamicImage, String> {
    let decoded = std::panic::catch_unwind(|| {
        let decoder =
            scene::open_picture(Cursor::new(bytes), Limits::no_limits()).map_err(|e| e.to_string())?;
        check_size(decoder.dimensions())?;
        DynamicImage::from_decoder(decoder).map_err(|e| e.to_string())
    });
    decoded.unwrap_or_else(|_| Err("its content contradicts itself".to_string()))
}

/// Checks a declared size before anything of it is allocated.
fn check_size((width, height): (u32, u32)) -> Result<(), String> {
    let pixels = u64::from(width) * u64::from(height);
    match (width.max(height) > MAX_SIDE, pixels > MAX_PIXELS) {
        (true, _) => Err(format!("it has {width}×{height} pixels, more than {MAX_SIDE} a side")),
        (_, true) => Err(format!("it has {width}×{height} pixels, more than {MAX_PIXELS} in all")),
        _ => Ok(()),
    }
}

/// Columns, rows and the stored red, green and blue of a picture, in [0, 1], without sRGB decoding.
pub(crate) fn read_stored_rgb(file: &Path) -> Result<(u32, u32, Vec<[f32; 3]>), ProjectError> {
    let image = read_image(file)?;
    let (width, height) = (image.width(), image.height());
    let deep = image.color().bytes_per_pixel() / image.color().channel_count() > 1;
    let texels = if deep {
        image.into_rgb16().pixels().map(|p| p.0.map(|c| c as f32 / 65535.0)).collect()
    } else {
        image.into_rgb8().pixels().map(|p| p.0.map(|c| c as f32 / 255.0)).collect()
    };
    Ok((width, height, texels))
}

/// The bytes of an 8-bit sRGB PNG; `text` are pairs of keyword and text.
pub(crate) fn encode_rgb8(
    width: u32,
    height: u32,
    rgb: &[u8],
    text: &[(&str, String)],
) -> Result<Vec<u8>, String> {
    encode_8bit([width, height], rgb, false, text)
}

/// The bytes of an 8-bit sRGB PNG: columns and rows, and red, green, blue and opacity of each pixel, row by row.
///
/// # Errors
/// The size is 0 or does not match the data, which is a bug in the caller.
pub fn texture_png(size: [u32; 2], rgba: &[u8]) -> Result<Vec<u8>, String> {
    encode_8bit(size, rgba, true, &[])
}

/// The same with or without alpha.
pub(crate) fn encode_8bit(
    size: [u32; 2],
    data: &[u8],
    has_alpha: bool,
    text: &[(&str, String)],
) -> Result<Vec<u8>, String> {
    let color = if has_alpha { ColorType::Rgba } else { ColorType::Rgb };
    encode(size, (color, BitDepth::Eight), data, text, true)
}

/// The bytes of a 16-bit RGB PNG without a colour profile.
pub(crate) fn encode_rgb16(
    width: u32,
    height: u32,
    rgb: &[u16],
    text: &[(&str, String)],
) -> Result<Vec<u8>, String> {
    let bytes: Vec<u8> = rgb.iter().flat_map(|c| c.to_be_bytes()).collect();
    encode([width, height], (ColorType::Rgb, BitDepth::Sixteen), &bytes, text, false)
}

fn encode(
    [width, height]: [u32; 2],
    (color, depth): (ColorType, BitDepth),
    data: &[u8],
    text: &[(&str, String)],
    is_srgb: bool,
) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(color);
    encoder.set_depth(depth);
    if is_srgb {
        encoder.set_source_srgb(png::SrgbRenderingIntent::RelativeColorimetric);
    }
    for (keyword, text) in text {
        encoder.add_text_chunk(keyword.to_string(), text.clone()).map_err(|e| e.to_string())?;
    }
    let mut writer = encoder.write_header().map_err(|e| e.to_string())?;
    writer.write_image_data(data).map_err(|e| e.to_string())?;
    writer.finish().map_err(|e| e.to_string())?;
    Ok(bytes)
}

/// A 16-bit PNG as stored.
pub(crate) struct StoredPng {
    pub width: u32,
    pub height: u32,
    /// Red, green, blue.
    pub rgb: Vec<[u16; 3]>,
    /// Whether the file declares a colour encoding (sRGB, gamma or a profile).
    pub has_color_space: bool,
}

/// Reads a PNG of 16 bits per channel as stored; opacity is dropped.
pub(crate) fn read_png16(file: &Path) -> Result<StoredPng, ProjectError> {
    let bytes = read_bytes(file)?;
    let error = |problem: String| {
        ProjectError::content(
            file,
            format!("is not a readable PNG: {problem}"),
            "write it again, or take another copy",
        )
    };
    let decoded = std::panic::catch_unwind(|| decode_png16(&bytes));
    match decoded.unwrap_or_else(|_| Err("its content contradicts itself".to_string())).map_err(error)? {
        Some(stored) => Ok(stored),
        None => Err(ProjectError::content(
            file,
            "does not have three channels of 16 bits",
            "a focus map needs 16-bit RGB; it may have been saved again with 8 bits",
        )),
    }
}

/// `None` if it is not 16-bit RGB or RGBA.
fn decode_png16(bytes: &[u8]) -> Result<Option<StoredPng>, String> {
    let limits = png::Limits { bytes: scene::MAX_PNG_EXTRAS_BYTES as usize };
    let decoder = png::Decoder::new_with_limits(Cursor::new(bytes), limits);
    let mut reader = decoder.read_info().map_err(|e| e.to_string())?;
    let info = reader.info();
    let (width, height) = (info.width, info.height);
    check_size((width, height))?;
    let has_color_space = info.srgb.is_some() || info.gama_chunk.is_some() || info.icc_profile.is_some();
    let channels = match (info.bit_depth, info.color_type) {
        (BitDepth::Sixteen, ColorType::Rgb) => 3,
        (BitDepth::Sixteen, ColorType::Rgba) => 4,
        _ => return Ok(None),
    };
    let mut data = vec![0; reader.output_buffer_size().ok_or("it is too large")?];
    reader.next_frame(&mut data).map_err(|e| e.to_string())?;
    reader.finish().map_err(|e| e.to_string())?;
    let sample = |texel: &[u8], k: usize| u16::from_be_bytes([texel[2 * k], texel[2 * k + 1]]);
    let texel = |texel: &[u8]| [0, 1, 2].map(|k| sample(texel, k));
    let rgb = data.chunks_exact(2 * channels).map(texel).collect();
    Ok(Some(StoredPng { width, height, rgb, has_color_space }))
}
