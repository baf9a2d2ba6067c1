//! Standard 3DGS files: a row of floats for each splat.
//!
//! Scales are logarithms, opacity is a logit, the rotation is w x y z of any length. `f_rest` has all of red, then green, then blue.

use super::super::format::SplatFormat;
use super::super::reading::Reading;
use super::super::splat_file::SplatFile;
use super::columns::{Activation, Columns};
use super::header::Header;
use super::rows::Rows;
use crate::cloud::CloudTraits;
use crate::error::GaussianError;
use std::io::BufRead;

/// Rows that decide whether scales and opacities are stored plain.
const PROBED_ROWS: u64 = 256;

/// # Errors
/// The file has no splats, fewer rows than declared, or exceeds the limits.
pub(super) fn read(
    mut reading: Reading<'_>,
    header: &Header,
    mut rows: Rows<impl BufRead>,
) -> Result<SplatFile, GaussianError> {
    let columns = Columns::new(&reading, header)?;
    let vertices = header.vertices(&reading)?;
    for element in header.elements.iter().take_while(|element| element.name != vertices.name) {
        rows.skip(&reading, element)?;
    }
    rows.check_count(&reading, vertices)?;
    let mut builder = reading.builder(columns.degree, vertices.count, 0)?;
    let mut probed = Vec::new();
    for _ in 0..vertices.count.min(PROBED_ROWS) {
        let mut row = Vec::new();
        rows.next(&reading, vertices, &mut row)?;
        probed.push(row);
    }
    let activation = columns.activation(&probed);
    let mut coefficients = Vec::new();
    for row in &probed {
        builder.push(columns.splat(row, activation, &mut coefficients), &coefficients);
    }
    let mut row = Vec::new();
    for index in probed.len() as u64..vertices.count {
        reading.at_row(index, vertices.count)?;
        rows.next(&reading, vertices, &mut row)?;
        builder.push(columns.splat(&row, activation, &mut coefficients), &coefficients);
    }
    if activation == Activation::Plain {
        let what = "scales and opacities are stored as they are, not as logarithms and logits";
        reading.warn(what, "they are read so; export the file again if it looks wrong");
    }
    if columns.is_flat() {
        let what = "its splats are 2D Gaussians, which have two scales";
        reading.warn(what, "they are drawn as flat 3D Gaussians");
    }
    let traits = CloudTraits { is_antialiased: header.is_antialiased, ..CloudTraits::default() };
    reading.finish(builder, traits, SplatFormat::Ply)
}
