//! SOG of PlayCanvas, version 1 and 2: attributes as pixels of lossless WebP pictures, described by a `meta.json`.
//!
//! A splat is the same pixel of all pictures, row by row from the top. Means are 16 bits in two pictures, on a scale of sign(x)·ln(1 + |x|);
//! rotations have their smallest three components as bytes and in alpha 252 + which of w x y z is left out. Version 2 has codebooks of 256
//! values for ln s and the colours, and opacity in alpha; version 1 the least and the largest instead, and opacity as a logit. Colours beyond
//! degree 0 are entries of a palette.

mod container;
mod meta;
mod palette;
mod texture;

use super::format::SplatFormat;
use super::quaternion::from_smallest_three;
use super::reading::Reading;
use super::splat_file::SplatFile;
use crate::cloud::{CloudTraits, Splat};
use crate::error::GaussianError;
use container::Container;
use glam::{Quat, Vec3};
use meta::{Levels, Meta, Opacity};
use palette::Palette;
use std::fs::File;
use std::io::Read;
use std::path::Path;
use texture::Texture;

/// Whether a file is the list of a SOG scene: by its name and what it begins with.
pub(super) fn is_list(path: &Path) -> bool {
    const BEGINNING: u64 = 1 << 16;
    let mut text = Vec::new();
    path.file_name().is_some_and(|name| name == "meta.json")
        && File::open(path).is_ok_and(|file| file.take(BEGINNING).read_to_end(&mut text).is_ok())
        && ["\"means\"", "\"quats\""].iter().all(|key| text.windows(key.len()).any(|w| w == key.as_bytes()))
}

/// Reads a scene in a folder.
///
/// # Errors
/// `meta.json` or a picture is missing, malformed, lossy or too small, or the limits are exceeded.
pub(super) fn read_folder(reading: Reading<'_>, folder: &Path) -> Result<SplatFile, GaussianError> {
    read(reading, Container::folder(folder), SplatFormat::SogFolder)
}

/// Reads a scene in a zip archive.
///
/// # Errors
/// As [`read_folder`], or the archive is malformed.
pub(super) fn read_archive(reading: Reading<'_>, bytes: &[u8]) -> Result<SplatFile, GaussianError> {
    let container = Container::archive(&reading, bytes)?;
    read(reading, container, SplatFormat::Sog)
}

fn read(
    mut reading: Reading<'_>,
    mut container: Container<'_>,
    format: SplatFormat,
) -> Result<SplatFile, GaussianError> {
    let meta = Meta::read(&mut reading, &mut container)?;
    let count = meta.count;
    let mut texture = |file: &str| Texture::read(&reading, &mut container, file, count);
    let [low, high] = [texture(&meta.means.files[0])?, texture(&meta.means.files[1])?];
    let scales = texture(&meta.scales.file)?;
    let rotations = texture(&meta.rotations)?;
    let colors = texture(&meta.colors.file)?;
    let palette = match &meta.palette {
        Some(palette) => Some(Palette::read(&reading, &mut container, palette, count)?),
        None => None,
    };
    let degree = palette.as_ref().map_or(0, Palette::degree);
    let held = [&low, &high, &scales, &rotations, &colors].iter().map(|t| t.bytes()).sum::<u64>();
    let held = held + palette.as_ref().map_or(0, Palette::bytes);
    let mut builder = reading.builder(degree, count, held)?;
    let mut coefficients = vec![0.0; builder.coefficients_each()];
    for index in 0..count as usize {
        reading.at_row(index as u64, count)?;
        if let Some(palette) = &palette {
            palette.decode(index, &mut coefficients);
        }
        let color = colors.pixel(index);
        let splat = Splat {
            mean: meta.means.decode(low.pixel(index), high.pixel(index)),
            rotation: rotation(rotations.pixel(index)),
            log_scale: meta.scales.levels.decode(scales.pixel(index)),
            opacity: match meta.colors.opacity {
                Opacity::Plain => f32::from(color[3]) / 255.0,
                Opacity::Logit([least, most]) => {
                    Splat::opacity_of_logit(least + (most - least) * f64::from(color[3]) / 255.0)
                }
            },
            base_color: meta.colors.levels.decode(color),
        };
        builder.push(splat, &coefficients);
    }
    let traits = CloudTraits { is_antialiased: meta.is_antialiased, ..CloudTraits::default() };
    reading.finish(builder, traits, format)
}

/// The rotation of a pixel; none, the identity, where alpha names no component.
fn rotation([a, b, c, tag]: [u8; 4]) -> Quat {
    let Some(largest) = tag.checked_sub(252) else { return Quat::IDENTITY };
    from_smallest_three(largest.into(), [a, b, c].map(|byte| f64::from(byte) / 255.0 * 2.0 - 1.0))
}

impl Levels {
    /// The values of the first three bytes of a pixel.
    fn decode(&self, [a, b, c, _]: [u8; 4]) -> Vec3 {
        match self {
            Self::Codebook(values) => Vec3::new(values[a as usize], values[b as usize], values[c as usize]),
            Self::Range([least, most]) => {
                let share = Vec3::new(a.into(), b.into(), c.into()) / 255.0;
                least + (most - least) * share
            }
        }
    }
}
