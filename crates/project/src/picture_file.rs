//! Pictures as files.
//!
//! **EXR**: linear `R`, `G`, `B`, and every further layer as a channel of its own name: `coverage`, `coc`,
//! `depth`, `t`, `anchor`. The attribute `focusBrush.exposure` says how the sum became the picture.
//!
//! **PNG**: 8-bit sRGB, clipped to [0, 1]; each further layer is an EXR beside it, `STEM.LAYER.exr`, with
//! one channel of the layer's name.

use crate::ProjectError;
use crate::disk::{extension, write_bytes};
use crate::exr_file::{ExrAttribute, ExrImage, ExrSamples, read_exr, write_exr};
use crate::png_file::{encode_rgb8, read_image};
use lens::{Exposure, Picture};
use scene::srgb_from_linear;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// One number a pixel beside the colour.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Its channel's name: `coverage`, `coc` (diameter of the circle of confusion, px), `depth` (along the
    /// axis), `t` or `anchor`.
    pub name: String,
    /// A value a pixel, row 0 on top.
    pub values: Vec<f32>,
}

impl Layer {
    /// The picture's coverage.
    pub fn coverage(picture: &Picture) -> Self {
        Self { name: "coverage".to_string(), values: picture.coverage.clone() }
    }
}

/// How pictures are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct PictureOptions {
    /// How the sum becomes the picture.
    pub exposure: Exposure,
    /// Whether an EXR's samples are half instead of float.
    pub half: bool,
}

/// The attribute that says how the sum became the picture.
const EXPOSURE: &str = "focusBrush.exposure";
/// Its values.
const EXPOSURES: [(Exposure, &str); 2] =
    [(Exposure::Conserve, "conserve"), (Exposure::Normalise, "normalise")];

/// Writes a picture as EXR or PNG, by extension, with further layers. Returns the files that were written,
/// the picture first.
pub fn write_picture(
    file: &Path,
    picture: &Picture,
    layers: &[Layer],
    options: PictureOptions,
) -> Result<Vec<PathBuf>, ProjectError> {
    let exposure =
        EXPOSURES.iter().find(|(known, _)| *known == options.exposure).map_or("", |(_, name)| name);
    let samples = if options.half { ExrSamples::Half } else { ExrSamples::Float };
    let rgb = picture.exposed(options.exposure);
    let named = |layer: &Layer| (layer.name.clone(), layer.values.clone());
    let size = [picture.width, picture.height];
    match extension(file).as_str() {
        "exr" => {
            let mut channels: BTreeMap<_, _> = color_channels(&rgb).into();
            channels.extend(layers.iter().map(named));
            let exposure = ExrAttribute::Text(exposure.to_string());
            let attributes = [(EXPOSURE.to_string(), exposure)].into();
            let image = ExrImage { width: size[0], height: size[1], channels, attributes };
            write_exr(file, &image, samples)?;
            Ok(vec![file.to_owned()])
        }
        "png" => {
            write_png(file, size, &rgb, &[("Exposure", exposure.to_string())])?;
            let mut files = vec![file.to_owned()];
            for layer in layers {
                let beside = file.with_extension(format!("{}.exr", layer.name));
                let channels = [named(layer)].into();
                let image = ExrImage { width: size[0], height: size[1], channels, ..ExrImage::default() };
                write_exr(&beside, &image, ExrSamples::Float)?;
                files.push(beside);
            }
            Ok(files)
        }
        _ => Err(unknown_form(file)),
    }
}

/// Writes linear RGB as EXR (float) or PNG (8-bit sRGB, clipped), by extension.
pub fn write_rgb(file: &Path, width: u32, height: u32, rgb: &[[f32; 3]]) -> Result<(), ProjectError> {
    match extension(file).as_str() {
        "exr" => {
            let channels = color_channels(rgb).into();
            let image = ExrImage { width, height, channels, ..ExrImage::default() };
            write_exr(file, &image, ExrSamples::Float)
        }
        "png" => write_png(file, [width, height], rgb, &[]),
        _ => Err(unknown_form(file)),
    }
}

fn unknown_form(file: &Path) -> ProjectError {
    ProjectError::content(file, "pictures are not written in this form", "name an .exr or .png")
}

fn write_png(
    file: &Path,
    size: [u32; 2],
    rgb: &[[f32; 3]],
    text: &[(&str, String)],
) -> Result<(), ProjectError> {
    let bytes = encode_rgb8(size[0], size[1], &srgb_bytes(rgb), text).map_err(|error| {
        ProjectError::Write { file: file.to_owned(), source: std::io::Error::other(error) }
    })?;
    write_bytes(file, &bytes)
}

pub(crate) fn color_channels(rgb: &[[f32; 3]]) -> [(String, Vec<f32>); 3] {
    [("R", 0), ("G", 1), ("B", 2)].map(|(name, k)| (name.to_string(), rgb.iter().map(|c| c[k]).collect()))
}

/// Linear RGB as 8-bit sRGB, clipped to [0, 1], interleaved.
pub(crate) fn srgb_bytes(rgb: &[[f32; 3]]) -> Vec<u8> {
    rgb.iter().flatten().map(|&c| (srgb_from_linear(c.clamp(0.0, 1.0)) * 255.0).round() as u8).collect()
}

/// The linear value of an sRGB-encoded one, both in [0, 1]. Inverse of [`srgb_from_linear`].
pub(crate) fn linear_from_srgb(c: f32) -> f32 {
    if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

/// A picture as read: linear RGB, and the further channels that its file has.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LinearPicture {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Linear RGB a pixel, row 0 on top.
    pub rgb: Vec<[f32; 3]>,
    /// Further channels by name.
    pub layers: BTreeMap<String, Vec<f32>>,
    /// How the model's sum became the picture, if that is known.
    pub exposure: Option<Exposure>,
}

impl LinearPicture {
    /// A picture under an exposure, as [`write_picture`] followed by [`read_picture`] would give it.
    pub fn of(picture: &Picture, exposure: Exposure) -> Self {
        let layers = [("coverage".to_string(), picture.coverage.clone())].into();
        let rgb = picture.exposed(exposure);
        Self { width: picture.width, height: picture.height, rgb, layers, exposure: Some(exposure) }
    }
}

/// Reads a picture as linear RGB: EXR (its display window, 0 where it has no pixels; R, G, B of any precision, else a
/// single grey channel), Radiance HDR, or an sRGB picture of 8 or 16 bits (PNG, JPEG, WebP).
pub fn read_picture(file: &Path) -> Result<LinearPicture, ProjectError> {
    match extension(file).as_str() {
        "exr" => from_exr(file, read_exr(file, |_| 0.0)?),
        "hdr" => {
            let image = read_image(file)?.into_rgb32f();
            let rgb = image.pixels().map(|p| p.0).collect();
            Ok(LinearPicture {
                width: image.width(),
                height: image.height(),
                rgb,
                ..LinearPicture::default()
            })
        }
        _ => {
            let (width, height, stored) = crate::png_file::stored_rgb(file)?;
            let rgb = stored.into_iter().map(|c| c.map(linear_from_srgb)).collect();
            Ok(LinearPicture { width, height, rgb, ..LinearPicture::default() })
        }
    }
}

fn from_exr(file: &Path, mut exr: ExrImage) -> Result<LinearPicture, ProjectError> {
    // R, G, B as they are, or of the first layer that has them.
    let prefix = exr.channels.keys().filter_map(|name| name.strip_suffix('R')).find(|prefix| {
        let dotted = prefix.is_empty() || prefix.ends_with('.');
        dotted && ["G", "B"].iter().all(|c| exr.channels.contains_key(&format!("{prefix}{c}")))
    });
    let prefix = prefix.map(str::to_owned);
    let grey = || ["Y", "V"].into_iter().find(|name| exr.channels.contains_key(*name)).map(str::to_owned);
    let single = || (exr.channels.len() == 1).then(|| exr.channels.keys().next().cloned()).flatten();
    let rgb = if let Some(prefix) = prefix {
        let [r, g, b] =
            ["R", "G", "B"].map(|c| exr.channels.remove(&format!("{prefix}{c}")).unwrap_or_default());
        r.into_iter().zip(g).zip(b).map(|((r, g), b)| [r, g, b]).collect()
    } else if let Some(name) = grey().or_else(single) {
        exr.channels[&name].iter().map(|&y| [y; 3]).collect()
    } else {
        let names: Vec<_> = exr.channels.keys().cloned().collect();
        let problem = format!("has no channels R, G, B, only {}", names.join(", "));
        return Err(ProjectError::content(file, problem, "give an EXR with R, G and B, or one channel"));
    };
    let exposure = EXPOSURES.iter().find(
        |(_, name)| matches!(exr.attributes.get(EXPOSURE), Some(ExrAttribute::Text(text)) if text == name),
    );
    let exposure = exposure.map(|(exposure, _)| *exposure);
    Ok(LinearPicture { width: exr.width, height: exr.height, rgb, layers: exr.channels, exposure })
}
