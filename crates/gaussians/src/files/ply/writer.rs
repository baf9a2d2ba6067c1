//! Writing standard 3DGS files.

use crate::cloud::{GaussianCloud, Splat};
use std::io::{self, Write};

/// Writes a cloud as a standard 3DGS file: binary, little-endian, the properties in the order of the reference implementation. Splats that
/// were left out of the cloud are not written. Its axes are those of the file that the cloud is from.
///
/// # Errors
/// `out` cannot be written.
pub fn write_ply(out: &mut impl Write, cloud: &GaussianCloud) -> io::Result<()> {
    let rest = (0..cloud_coefficients(cloud)).map(|k| format!("f_rest_{k}"));
    let names = ["x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2"].map(String::from).into_iter();
    let shape =
        ["opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"].map(String::from);
    let comment = if cloud.traits().is_antialiased { "comment SplatRenderMode: mip\n" } else { "" };
    write_header(out, comment, cloud.len(), names.chain(rest).chain(shape))?;
    let count = cloud_coefficients(cloud) / 3;
    for index in 0..cloud.len() {
        let Splat { mean, rotation: q, log_scale, opacity, base_color } = cloud.splat(index);
        let coefficients = cloud.coefficients(index);
        let by_channel = (0..3 * count).map(|k| coefficients[k % count * 3 + k / count].to_f32());
        let numbers =
            mean.to_array().into_iter().chain([0.0; 3]).chain(base_color.to_array()).chain(by_channel);
        let numbers = numbers
            .chain([Splat::logit_of_opacity(opacity)])
            .chain(log_scale.to_array())
            .chain([q.w, q.x, q.y, q.z]);
        write_row(out, numbers)?;
    }
    Ok(())
}

fn cloud_coefficients(cloud: &GaussianCloud) -> usize {
    3 * crate::cloud::harmonics::coefficient_count(cloud.degree())
}

/// The header of a table `vertex` of floats.
pub(super) fn write_header(
    out: &mut impl Write,
    comments: &str,
    count: usize,
    names: impl Iterator<Item = String>,
) -> io::Result<()> {
    write!(out, "ply\nformat binary_little_endian 1.0\n{comments}element vertex {count}\n")?;
    for name in names {
        writeln!(out, "property float {name}")?;
    }
    out.write_all(b"end_header\n")
}

pub(super) fn write_row(out: &mut impl Write, numbers: impl Iterator<Item = f32>) -> io::Result<()> {
    for number in numbers {
        out.write_all(&number.to_le_bytes())?;
    }
    Ok(())
}
