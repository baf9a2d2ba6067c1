//! Writers of every format, made from its description alone: what the readers are tried on.

mod ksplat;
mod ply;
mod sog;
mod spz;

pub use ksplat::ksplat;
pub use ply::{Numbers, compressed_ply, ply_in_other_order};
pub use sog::{sog_files, zipped};
pub use spz::{SpzVersion, gzipped, spz, spz_payload};

use gaussians::{GaussianCloud, Splat, write_ply};
use glam::Vec3;

/// The standard file, by the crate's own writer.
pub fn ply(cloud: &GaussianCloud) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_ply(&mut bytes, cloud).expect("memory can be written");
    bytes
}

/// `.splat`.
pub fn raw_splat(cloud: &GaussianCloud) -> Vec<u8> {
    let mut bytes = Vec::new();
    for index in 0..cloud.len() {
        let splat = cloud.splat(index);
        let floats = splat.mean.to_array().into_iter().chain(splat.log_scale.exp().to_array());
        bytes.extend(floats.flat_map(f32::to_le_bytes));
        bytes.extend(rgba(&splat));
        let q = splat.rotation;
        bytes.extend([q.w, q.x, q.y, q.z].map(|x| (x * 128.0 + 128.0).round().clamp(0.0, 255.0) as u8));
    }
    bytes
}

/// The colour of degree 0 and the opacity as bytes.
fn rgba(splat: &Splat) -> [u8; 4] {
    let color = color(splat);
    [color.x, color.y, color.z, splat.opacity].map(unit_byte)
}

fn color(splat: &Splat) -> Vec3 {
    0.5 + 0.282_094_8 * splat.base_color
}

fn unit_byte(share: f32) -> u8 {
    (share * 255.0).round().clamp(0.0, 255.0) as u8
}

/// Coefficients of a splat: all of red, then green, then blue.
fn by_channel(cloud: &GaussianCloud, index: usize) -> Vec<f32> {
    let values = cloud.coefficients(index);
    let count = values.len() / 3;
    (0..values.len()).map(|k| values[k % count * 3 + k / count].to_f32()).collect()
}

/// The component of w x y z with the largest magnitude, and the others (all signs changed so that it is positive), in units of √½.
fn smallest_three(splat: &Splat) -> (usize, [f32; 3]) {
    let q = splat.rotation;
    let wxyz = [q.w, q.x, q.y, q.z];
    let largest = (0..4).max_by(|a, b| wxyz[*a].abs().total_cmp(&wxyz[*b].abs())).expect("four");
    let sign = wxyz[largest].signum();
    let mut rest = (0..4).filter(|k| *k != largest).map(|k| wxyz[k] * sign * std::f32::consts::SQRT_2);
    (largest, std::array::from_fn(|_| rest.next().expect("three")))
}
