//! `.ksplat` of GaussianSplats3D: a header of 4,096 bytes, a header of 1,024 bytes for each section, then the sections.
//!
//! A section has splats in buckets. At level 0 all numbers are 32-bit floats; at 1 and 2 means are 16 bits about the centre of their
//! bucket, and scales (not logarithms) and rotations (w x y z) are 16-bit floats. Colours are four bytes. Coefficients beyond degree 0 (all of red, then green, then
//! blue, degree by degree) are 32-bit floats, 16-bit floats, or bytes between a least and a largest value.

mod header;
mod section;

use super::bytes::{Bytes, u32_at};
use super::format::SplatFormat;
use super::reading::Reading;
use super::splat_file::SplatFile;
use crate::cloud::CloudTraits;
use crate::error::GaussianError;
use header::{HEADER_BYTES, Header};
use section::Section;

const SECTION_HEADER_BYTES: u64 = 1024;

/// Whether bytes may be such a file: a header, whose sections and splats have room in it.
pub(super) fn is_plausible(bytes: &[u8]) -> bool {
    Header::new(bytes).is_some_and(|header| {
        let sections = HEADER_BYTES as u64 + header.sections * SECTION_HEADER_BYTES;
        let splats = u64::from(header.count) * Section::least_bytes_each(header.level);
        header.sections > 0 && header.count > 0 && sections + splats <= bytes.len() as u64
    })
}

/// # Errors
/// The header is none, a section does not fit the file, or the limits are exceeded.
pub(super) fn read(reading: Reading<'_>, bytes: &[u8]) -> Result<SplatFile, GaussianError> {
    let header =
        Header::new(bytes).ok_or_else(|| reading.malformed("header", "is none of version 0.1 of ksplat"))?;
    let mut rest = Bytes::new(&bytes[HEADER_BYTES..]);
    let headers = rest.take(header.sections * SECTION_HEADER_BYTES).ok_or_else(|| {
        reading.malformed("header", format!("{} sections do not fit the file", header.sections))
    })?;
    let mut sections = Vec::new();
    for (index, section) in headers.chunks_exact(SECTION_HEADER_BYTES as usize).enumerate() {
        if u32_at(section, 0) > 0 || u32_at(section, 4) > 0 {
            let place = format!("section {index}");
            let section = Section::new(&header, section, &mut rest);
            sections.push(
                section.ok_or_else(|| {
                    reading.malformed(place, "does not fit the file, or contradicts itself")
                })?,
            );
        }
    }
    let count: u64 = sections.iter().map(Section::count).sum();
    if count != u64::from(header.count) {
        let what = format!("{} splats are declared, but the sections have {count}", header.count);
        return Err(reading.malformed("header", what));
    }
    let degree = sections.iter().map(Section::degree).max().unwrap_or(0);
    let mut builder = reading.builder(degree, count, bytes.len() as u64)?;
    let mut coefficients = vec![0.0; builder.coefficients_each()];
    let mut row = 0;
    for section in &sections {
        for splat in 0..section.count() {
            reading.at_row(row, count)?;
            row += 1;
            coefficients.fill(0.0);
            builder.push(section.decode(splat as usize, &mut coefficients), &coefficients);
        }
    }
    reading.finish(builder, CloudTraits::default(), SplatFormat::Ksplat)
}
