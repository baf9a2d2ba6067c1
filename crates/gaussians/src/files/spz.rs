//! SPZ of Niantic, version 1 to 4.
//!
//! | attribute | version 1 | 2 | 3, 4 |
//! | --- | --- | --- | --- |
//! | mean | 3 × f16 | 3 × 24-bit fixed point | the same |
//! | opacity | u8/255 | | |
//! | colour of degree 0 | (u8/255 − ½)/0.15 | | |
//! | ln s | u8/16 − 10 | | |
//! | rotation | x y z, u8/127.5 − 1; w ≥ 0 | the same | 2 bits: which of x y z w is left out; 3 × (sign, 9 bits) |
//! | colour beyond | (u8 − 128)/128, red, green and blue of a coefficient beside each other | | |
//!
//! Attribute after attribute in one gzip stream after a header of 16 bytes; from version 4 on each in a zstd frame of its own, after a plain
//! header of 32 bytes, extensions, and a table of sizes. Axes are right, up, back, unless an extension of Adobe names others.

mod extensions;
mod header;
mod streams;

use super::bytes::{u16_at, u32_at};
use super::format::SplatFormat;
use super::quaternion::from_xyz;
use super::reading::Reading;
use super::splat_file::SplatFile;
use crate::cloud::{CloudTraits, ColorSpace, Splat};
use crate::error::GaussianError;
use glam::{Quat, Vec3};
use half::f16;
use header::Header;
use streams::Streams;

/// The factor of the colour of degree 0: it has room for values a bit beyond black and white.
const COLOR_SCALE: f32 = 0.15;

/// # Errors
/// The file is cut, malformed or of another version, or exceeds the limits.
pub(super) fn read(mut reading: Reading<'_>, bytes: &[u8]) -> Result<SplatFile, GaussianError> {
    let (header, streams) = match bytes {
        [0x1f, 0x8b, ..] => streams::inflate_gzip(&reading, bytes)?,
        _ => streams::inflate_frames(&reading, bytes)?,
    };
    let extensions = extensions::read(&mut reading, header.has_extensions, &streams.extensions);
    let count = u64::from(header.count);
    let mut builder = reading.builder(header.degree, count, streams.bytes() + bytes.len() as u64)?;
    let each = builder.coefficients_each();
    let unit = |byte: u8| f32::from(byte) / 255.0;
    let mut coefficients = vec![0.0; each];
    for index in 0..header.count as usize {
        reading.at_row(index as u64, count)?;
        for (value, byte) in coefficients.iter_mut().zip(&streams.coefficients[index * each..]) {
            *value = (f32::from(*byte) - 128.0) / 128.0;
        }
        let three = |bytes: &[u8]| {
            Vec3::new(bytes[3 * index].into(), bytes[3 * index + 1].into(), bytes[3 * index + 2].into())
        };
        let splat = Splat {
            mean: mean(&header, &streams, index),
            rotation: rotation(&header, &streams, index),
            log_scale: three(&streams.scales) / 16.0 - 10.0,
            opacity: unit(streams.opacities[index]),
            base_color: (three(&streams.colors) / 255.0 - 0.5) / COLOR_SCALE,
        };
        builder.push(splat, &coefficients);
    }
    let traits = CloudTraits {
        color_space: ColorSpace::Srgb,
        is_antialiased: header.is_antialiased,
        axes: extensions.axes,
    };
    reading.finish(builder, traits, SplatFormat::Spz)
}

fn mean(header: &Header, streams: &Streams, index: usize) -> Vec3 {
    if header.version == 1 {
        let at = |axis: usize| f16::from_bits(u16_at(&streams.means, 6 * index + 2 * axis)).to_f32();
        return Vec3::new(at(0), at(1), at(2));
    }
    let scale = 0.5f64.powi(i32::from(header.fractional_bits));
    let at = |axis: usize| {
        let at = 9 * index + 3 * axis;
        let [low, middle, high] = [0, 1, 2].map(|byte| streams.means[at + byte]);
        // The sign is that of the highest bit: shifted up and down again.
        let fixed = i32::from_le_bytes([0, low, middle, high]) >> 8;
        (f64::from(fixed) * scale) as f32
    };
    Vec3::new(at(0), at(1), at(2))
}

fn rotation(header: &Header, streams: &Streams, index: usize) -> Quat {
    if header.version < 3 {
        let at = |axis: usize| f64::from(streams.rotations[3 * index + axis]) / 127.5 - 1.0;
        return from_xyz([at(0), at(1), at(2)]);
    }
    let mut packed = u32_at(&streams.rotations, 4 * index);
    let largest = (packed >> 30) as usize;
    let mut xyzw = [0.0; 4];
    for component in (0..4).rev().filter(|component| *component != largest) {
        let magnitude = f64::from(packed & 0x1ff) / 511.0 * std::f64::consts::FRAC_1_SQRT_2;
        xyzw[component] = if packed >> 9 & 1 == 1 { -magnitude } else { magnitude };
        packed >>= 10;
    }
    xyzw[largest] = (1.0 - xyzw.iter().map(|x: &f64| x * x).sum::<f64>()).max(0.0).sqrt();
    Quat::from_array(xyzw.map(|x| x as f32))
}
