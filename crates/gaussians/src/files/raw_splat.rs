//! `.splat`, as antimatter15's viewer reads it: 32 bytes a splat and no header.
//!
//! Three floats of the mean, three of s (not its logarithm), red, green, blue and opacity as bytes, then w x y z of the rotation as
//! bytes (128 is 0). No colour beyond degree 0.

use super::bytes::f32_at;
use super::format::SplatFormat;
use super::quaternion::from_wxyz;
use super::reading::Reading;
use super::splat_file::SplatFile;
use crate::cloud::{CloudTraits, Splat};
use crate::error::GaussianError;
use glam::Vec3;

const BYTES_EACH: usize = 32;

/// Whether bytes may be such a file: whole rows, the first of which are finite, of positive size and with a rotation.
pub(super) fn is_plausible(bytes: &[u8]) -> bool {
    const ROWS: usize = 64;
    let is_splat = |row: &[u8]| {
        let scale = [12, 16, 20].map(|at| f32_at(row, at));
        let mean = [0, 4, 8].map(|at| f32_at(row, at));
        mean.iter().all(|x| x.abs() < 1e6)
            && scale.iter().all(|s| (0.0..1e6).contains(s))
            && scale.iter().any(|s| *s > 1e-12)
            && row[28..].iter().any(|&q| q != 128)
    };
    !bytes.is_empty()
        && bytes.len().is_multiple_of(BYTES_EACH)
        && bytes.chunks_exact(BYTES_EACH).take(ROWS).all(is_splat)
}

/// # Errors
/// The size is no multiple of 32 bytes, or no splat can be drawn.
pub(super) fn read(reading: Reading<'_>, bytes: &[u8]) -> Result<SplatFile, GaussianError> {
    let count = (bytes.len() / BYTES_EACH) as u64;
    if !bytes.len().is_multiple_of(BYTES_EACH) {
        let what = format!("{} bytes are no multiple of {BYTES_EACH}, the size of a splat", bytes.len());
        return Err(reading.malformed("size", what));
    }
    let mut builder = reading.builder(0, count, bytes.len() as u64)?;
    for (index, row) in bytes.chunks_exact(BYTES_EACH).enumerate() {
        reading.at_row(index as u64, count)?;
        let vector = |at: usize| Vec3::new(f32_at(row, at), f32_at(row, at + 4), f32_at(row, at + 8));
        let [red, green, blue, opacity] = [24, 25, 26, 27].map(|at| f32::from(row[at]) / 255.0);
        let splat = Splat {
            mean: vector(0),
            rotation: from_wxyz([28, 29, 30, 31].map(|at| (f64::from(row[at]) - 128.0) / 128.0)),
            log_scale: vector(12).map(f32::ln),
            opacity,
            base_color: Vec3::new(red, green, blue).map(Splat::base_of_color),
        };
        builder.push(splat, &[]);
    }
    reading.finish(builder, CloudTraits::default(), SplatFormat::Splat)
}
