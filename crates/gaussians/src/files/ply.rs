//! PLY: standard 3DGS files, compressed ones, and tables of focus.

mod columns;
mod compressed;
mod focus_table;
mod header;
mod rows;
mod standard;
mod writer;

pub use focus_table::{read_focus_table, write_focus_table};
pub use writer::write_ply;

use super::reading::Reading;
use super::splat_file::SplatFile;
use crate::error::GaussianError;
use header::Header;
use rows::Rows;
use std::io::BufRead;

/// Whether a file begins as PLY does.
pub(super) fn is_ply(beginning: &[u8]) -> bool {
    matches!(beginning, [b'p', b'l', b'y', b'\n' | b'\r', ..])
}

/// Reads a file of `size` bytes from its beginning on.
///
/// # Errors
/// The header is malformed, the file has no splats or fewer rows than declared, or exceeds the limits.
pub(super) fn read(
    reading: Reading<'_>,
    mut input: impl BufRead,
    size: u64,
) -> Result<SplatFile, GaussianError> {
    let header = Header::read(&reading, &mut input)?;
    let is_compressed = header.vertices(&reading)?.column("packed_position").is_some();
    let rows = Rows::new(&header, input, size);
    match is_compressed {
        true => compressed::read(reading, &header, rows),
        false => standard::read(reading, &header, rows),
    }
}
