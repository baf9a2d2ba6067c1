//! Writing pictures.
//!
//! **EXR**: one part of linear `R`, `G`, `B`, and every other layer as channels of its own name: `A`, `depth.Z`,
//! `coc`, `coverage`, `pinhole.R`, … The attribute `focusBrush.exposure` gives the exposure, `chromaticities` the
//! colour space. Overscan makes the data window larger than the display window.
//!
//! **PNG**: 8-bit sRGB, clipped to [0, 1], with straight alpha if there is a layer `A`; each other layer is a
//! separate EXR, `STEM.LAYER.exr`.

use crate::ProjectError;
use crate::color_space::{ColorSpace, transform_colors};
use crate::disk::{extension, write_bytes};
use crate::openexr::bands::{ExrHead, write_exr_in_bands};
use crate::openexr::image::{ExrAttribute, ExrImage, write_exr};
use crate::openexr::options::{Compression, ExrOptions, ExrSamples};
use crate::pictures::cryptomatte::{is_cryptomatte, is_cryptomatte_metadata};
use crate::pictures::layer::{Layer, color_channels};
use crate::pictures::png_file::encode_8bit;
use lens::{Exposure, Picture};
use scene::srgb_from_linear;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// How pictures are written.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct PictureOptions {
    /// How the sum becomes the picture.
    pub exposure: Exposure,
    /// Whether an EXR's colours, alpha, coverage and photographed mask are half instead of float. The rest stays
    /// float, and so does alpha if Cryptomatte's shares sum to it.
    pub half: bool,
    /// How an EXR's pixels are compressed.
    pub compression: Compression,
    /// The colour space of an EXR.
    pub color_space: ColorSpace,
    /// Number of overscan pixels on each side of the frame.
    pub overscan: u32,
    /// Text attributes of an EXR.
    pub attributes: BTreeMap<String, String>,
}

/// The attribute that gives the exposure.
pub(crate) const EXPOSURE: &str = "focusBrush.exposure";
/// Its values.
pub(crate) const EXPOSURES: [(Exposure, &str); 2] =
    [(Exposure::Conserve, "conserve"), (Exposure::Normalise, "normalise")];

/// Whether a channel loses nothing visible as half, if no shares have to sum to alpha.
fn half_suffices(channel: &str) -> bool {
    channel == Layer::ALPHA || half_suffices_with_mattes(channel)
}

/// The same if they do.
fn half_suffices_with_mattes(channel: &str) -> bool {
    let layer = channel.split('.').next().unwrap_or(channel);
    ["R", "G", "B", Layer::PINHOLE, "coverage", "seen"].contains(&layer)
}

/// Writes a picture as EXR or PNG, by extension, with other layers. Returns the files that were written, the picture
/// first.
///
/// # Errors
/// The extension is another, the file cannot be written, or Cryptomatte was requested with lossy compression.
pub fn write_picture(
    file: &Path,
    picture: &Picture,
    layers: &[Layer],
    options: &PictureOptions,
) -> Result<Vec<PathBuf>, ProjectError> {
    let exposure = exposure_name(options.exposure);
    let rgb = picture.exposed(options.exposure);
    let size = [picture.width, picture.height];
    match extension(file).as_str() {
        "exr" => {
            let samples = sample_type(file, layers.iter().map(|layer| layer.name.as_str()), options)?;
            let image = ExrImage {
                width: size[0],
                height: size[1],
                channels: to_channels(&rgb, layers, options),
                attributes: to_attributes(options, Some(exposure)),
                ..ExrImage::default()
            };
            write_exr(file, image, exr_options(options, samples))?;
            Ok(vec![file.to_owned()])
        }
        "png" => {
            let alpha = layers.iter().find(|layer| layer.name == Layer::ALPHA);
            write_png(file, size, &rgb, alpha, &[("Exposure", exposure.to_string())])?;
            let mut files = vec![file.to_owned()];
            let mut groups: BTreeMap<&str, BTreeMap<String, Vec<f32>>> = BTreeMap::new();
            for layer in layers.iter().filter(|layer| layer.name != Layer::ALPHA) {
                groups
                    .entry(layer_group(layer))
                    .or_default()
                    .insert(layer.name.clone(), layer.values.clone());
            }
            for (group, channels) in groups {
                let layer_file = file.with_extension(format!("{group}.exr"));
                let attributes =
                    if group == "crypto" { to_attributes(options, None) } else { BTreeMap::new() };
                let image =
                    ExrImage { width: size[0], height: size[1], channels, attributes, ..ExrImage::default() };
                write_exr(&layer_file, image, ExrOptions::default())?;
                files.push(layer_file);
            }
            Ok(files)
        }
        _ => Err(unsupported_format(file)),
    }
}

/// Writes a picture as EXR in bands of rows, from top to bottom, with one band at a time in memory: the same bytes as
/// those of [`write_picture`]. `layers` are the names of the layers that every band has; `band` returns the picture
/// and layers of the given rows.
///
/// # Errors
/// Those of `band`; the file cannot be written, or Cryptomatte was requested with lossy compression.
pub fn write_picture_in_bands<E: From<ProjectError> + Send>(
    file: &Path,
    [width, height]: [u32; 2],
    layers: &[String],
    options: &PictureOptions,
    mut band: impl FnMut(Range<u32>) -> Result<(Picture, Vec<Layer>), E> + Send,
) -> Result<(), E> {
    let samples = sample_type(file, layers.iter().map(String::as_str), options)?;
    let colors = ["R", "G", "B"].map(String::from);
    let head = ExrHead {
        size: [width, height],
        channels: colors.into_iter().chain(layers.iter().cloned()).collect(),
        attributes: to_attributes(options, Some(exposure_name(options.exposure))),
        form: exr_options(options, samples),
    };
    write_exr_in_bands(file, &head, |rows| {
        let (picture, layers) = band(rows)?;
        Ok(to_channels(&picture.exposed(options.exposure), &layers, options))
    })
}

fn exposure_name(exposure: Exposure) -> &'static str {
    EXPOSURES.iter().find(|(candidate, _)| *candidate == exposure).map_or("", |(_, name)| name)
}

/// The channels of an EXR.
fn to_channels(rgb: &[[f32; 3]], layers: &[Layer], options: &PictureOptions) -> BTreeMap<String, Vec<f32>> {
    let named = |layer: &Layer| (layer.name.clone(), layer.values.clone());
    let mut channels: BTreeMap<_, _> = color_channels(rgb).into();
    channels.extend(layers.iter().map(named));
    convert_colors(&mut channels, options.color_space);
    channels
}

/// The sample types of an EXR with layers of these names.
fn sample_type<'a>(
    file: &Path,
    mut layers: impl Iterator<Item = &'a str>,
    options: &PictureOptions,
) -> Result<ExrSamples, ProjectError> {
    let has_mattes = layers.any(is_cryptomatte);
    if has_mattes && !options.compression.is_lossless() {
        let problem = "Cryptomatte does not survive lossy compression";
        return Err(ProjectError::content(
            file,
            problem,
            "take zips, zip or piz, or write it to another file",
        ));
    }
    Ok(match (options.half, has_mattes) {
        (false, _) => ExrSamples::Float,
        (true, false) => ExrSamples::HalfIf(half_suffices),
        (true, true) => ExrSamples::HalfIf(half_suffices_with_mattes),
    })
}

/// The attributes of an EXR; without an exposure only those of Cryptomatte.
fn to_attributes(options: &PictureOptions, exposure: Option<&str>) -> BTreeMap<String, ExrAttribute> {
    let all_attributes =
        options.attributes.iter().filter(|(name, _)| exposure.is_some() || is_cryptomatte_metadata(name));
    let text = |(name, text): (&str, &str)| (name.to_string(), ExrAttribute::Text(text.to_string()));
    let all_attributes = all_attributes.map(|(name, value)| (name.as_str(), value.as_str()));
    all_attributes.chain(exposure.map(|exposure| (EXPOSURE, exposure))).map(text).collect()
}

fn exr_options(options: &PictureOptions, samples: ExrSamples) -> ExrOptions {
    ExrOptions {
        compression: options.compression,
        samples,
        overscan: options.overscan,
        color_space: Some(options.color_space),
    }
}

/// Converts the colours of the picture and of the pinhole to a colour space.
fn convert_colors(channels: &mut BTreeMap<String, Vec<f32>>, space: ColorSpace) {
    let source_space = ColorSpace::Rec709;
    let matrix =
        source_space.chromaticities().matrix_to(&space.chromaticities()).filter(|_| space != source_space);
    let Some(matrix) = matrix else { return };
    for prefix in ["".to_string(), format!("{}.", Layer::PINHOLE)] {
        let names = ["R", "G", "B"].map(|channel| format!("{prefix}{channel}"));
        let Some(values) =
            names.each_ref().map(|name| channels.remove(name)).into_iter().collect::<Option<Vec<_>>>()
        else {
            continue;
        };
        let mut rgb: Vec<_> =
            (0..values[0].len()).map(|k| [values[0][k], values[1][k], values[2][k]]).collect();
        transform_colors(&matrix, &mut rgb);
        let turned = color_channels(&rgb).map(|(_, values)| values);
        channels.extend(names.into_iter().zip(turned));
    }
}

/// Writes linear RGB as EXR (float) or PNG (8-bit sRGB, clipped), by extension.
///
/// # Errors
/// The extension is another, or the file cannot be written.
pub fn write_rgb(file: &Path, width: u32, height: u32, rgb: &[[f32; 3]]) -> Result<(), ProjectError> {
    match extension(file).as_str() {
        "exr" => {
            let channels = color_channels(rgb).into();
            let image = ExrImage { width, height, channels, ..ExrImage::default() };
            write_exr(file, image, ExrOptions::default())
        }
        "png" => write_png(file, [width, height], rgb, None, &[]),
        _ => Err(unsupported_format(file)),
    }
}

/// The group of a layer: the layers of a group share a file when the picture's format has no layers.
fn layer_group(layer: &Layer) -> &str {
    match layer.name.split('.').next() {
        Some(group) if !is_cryptomatte(group) => group,
        _ => "crypto",
    }
}

fn unsupported_format(file: &Path) -> ProjectError {
    ProjectError::content(file, "pictures cannot be written in this format", "name an .exr or .png")
}

fn write_png(
    file: &Path,
    size: [u32; 2],
    rgb: &[[f32; 3]],
    alpha: Option<&Layer>,
    text: &[(&str, String)],
) -> Result<(), ProjectError> {
    let bytes = match alpha {
        None => srgb_bytes(rgb),
        Some(alpha) => straight_alpha_bytes(rgb, &alpha.values),
    };
    let bytes = encode_8bit(size, &bytes, alpha.is_some(), text).map_err(|error| ProjectError::Write {
        file: file.to_owned(),
        source: std::io::Error::other(error),
    })?;
    write_bytes(file, &bytes)
}

/// Premultiplied linear colours as straight 8-bit sRGB with linear alpha, interleaved, as in PNG.
fn straight_alpha_bytes(rgb: &[[f32; 3]], alpha: &[f32]) -> Vec<u8> {
    let pixel = |(color, &alpha): (&[f32; 3], &f32)| {
        let straight = if alpha > 0.0 { color.map(|c| c / alpha) } else { [0.0; 3] };
        let [r, g, b] = straight.map(srgb_byte);
        [r, g, b, (alpha.clamp(0.0, 1.0) * 255.0).round() as u8]
    };
    rgb.iter().zip(alpha).flat_map(pixel).collect()
}

/// Linear RGB as 8-bit sRGB, clipped to [0, 1], interleaved.
pub(crate) fn srgb_bytes(rgb: &[[f32; 3]]) -> Vec<u8> {
    rgb.iter().flatten().map(|&c| srgb_byte(c)).collect()
}

fn srgb_byte(linear: f32) -> u8 {
    (srgb_from_linear(linear.clamp(0.0, 1.0)) * 255.0).round() as u8
}
