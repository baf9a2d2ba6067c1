//! The attributes of an SPZ file, inflated.

use super::super::bounded::{MAX_DEFLATE_RATIO, inflate_zstd, read_exactly};
use super::super::bytes::Bytes;
use super::super::reading::Reading;
use super::header::Header;
use crate::cloud::harmonics::{MAX_DEGREE, coefficient_count};
use crate::error::GaussianError;
use flate2::bufread::GzDecoder;
use std::io::Read;

const MAGIC: u32 = 0x5053_474e;

/// Maximum bytes of extensions in a compressed stream; the two known ones take 20 and 12.
const MAX_EXTENSIONS: u64 = 1 << 16;

/// Attributes, one after the other.
pub(super) struct Streams {
    pub means: Vec<u8>,
    pub opacities: Vec<u8>,
    pub colors: Vec<u8>,
    pub scales: Vec<u8>,
    pub rotations: Vec<u8>,
    pub coefficients: Vec<u8>,
    /// Records of extensions.
    pub extensions: Vec<u8>,
}

impl Streams {
    /// The bytes that they take.
    pub fn bytes(&self) -> u64 {
        let all =
            [&self.means, &self.opacities, &self.colors, &self.scales, &self.rotations, &self.coefficients];
        all.iter().map(|stream| stream.len() as u64).sum()
    }
}

/// The bytes of each attribute, in the order of the file.
fn sizes(header: &Header) -> [u64; 6] {
    let each =
        [header.mean_bytes(), 1, 3, 3, header.rotation_bytes(), 3 * coefficient_count(header.degree) as u64];
    each.map(|bytes| bytes * u64::from(header.count))
}

/// Reads the beginning that all versions share: 16 bytes, the last of which is returned.
fn read_header(reading: &Reading<'_>, bytes: &mut Bytes<'_>) -> Result<(Header, u8), GaussianError> {
    let mut numbers = || {
        Some((bytes.u32()?, bytes.u32()?, bytes.u32()?, bytes.u8()?, bytes.u8()?, bytes.u8()?, bytes.u8()?))
    };
    let (magic, version, count, degree, fractional_bits, flags, last) =
        numbers().ok_or_else(|| reading.malformed("header", "the file ends in it"))?;
    if magic != MAGIC {
        return Err(GaussianError::no_splats(reading.file(), "is compressed, but no SPZ file"));
    }
    if !(1..=4).contains(&version) {
        let what = format!("is SPZ of version {version}, 1 to 4 are read");
        return Err(GaussianError::unsupported(
            reading.file(),
            what,
            "convert it to version 3 or 4, or to .ply",
        ));
    }
    let degree = u32::from(degree);
    if degree > MAX_DEGREE {
        return Err(reading.malformed("header", format!("degree {degree} is above {MAX_DEGREE}")));
    }
    let is_antialiased = flags & 1 != 0;
    let has_extensions = flags & 2 != 0;
    Ok((Header { version, count, degree, fractional_bits, is_antialiased, has_extensions }, last))
}

/// Checks that a file may have as many splats as it says, so that room for them is justified.
fn check_count(reading: &Reading<'_>, header: &Header, file_bytes: u64) -> Result<(), GaussianError> {
    let bytes: u64 = sizes(header).iter().sum();
    // Streams of zstd may be denser than deflate's, but no splats are: the reference implementation has about the same limit.
    if bytes > file_bytes.saturating_mul(MAX_DEFLATE_RATIO) {
        let what = format!("{} splats are more than its {file_bytes} bytes can hold", header.count);
        return Err(reading.malformed("header", what));
    }
    reading.check_memory(&format!("{} packed splats take", header.count), bytes)
}

/// Version 1 to 3: one gzip stream.
pub(super) fn inflate_gzip(reading: &Reading<'_>, bytes: &[u8]) -> Result<(Header, Streams), GaussianError> {
    let mut input = GzDecoder::new(bytes);
    let cut = |e: std::io::Error| reading.malformed("gzip stream", e);
    let mut beginning = [0; 16];
    input.read_exact(&mut beginning).map_err(cut)?;
    let (header, _) = read_header(reading, &mut Bytes::new(&beginning))?;
    check_count(reading, &header, bytes.len() as u64)?;
    let mut streams = Vec::new();
    for size in sizes(&header) {
        streams.push(read_exactly(&mut input, size).map_err(cut)?);
    }
    // To the end of the stream, where its checksum is.
    let mut extensions = Vec::new();
    input.take(MAX_EXTENSIONS).read_to_end(&mut extensions).map_err(cut)?;
    Ok((header, collect(streams, extensions)))
}

/// Version 4: a plain header and a zstd frame for each attribute that has bytes.
pub(super) fn inflate_frames(
    reading: &Reading<'_>,
    bytes: &[u8],
) -> Result<(Header, Streams), GaussianError> {
    let mut beginning = Bytes::new(bytes);
    let (header, frames) = read_header(reading, &mut beginning)?;
    let wrong = |what: &str| reading.malformed("table of streams", what);
    if header.version < 4 {
        return Err(reading.malformed("header", format!("version {} is not compressed", header.version)));
    }
    check_count(reading, &header, bytes.len() as u64)?;
    let table_at = beginning.u32().ok_or_else(|| wrong("the file ends before it"))?;
    let extensions = bytes.get(32..table_at as usize).ok_or_else(|| wrong("it lies outside the file"))?;
    let mut rest = Bytes::new(&bytes[table_at as usize..]);
    let sizes = sizes(&header);
    let used = sizes.iter().filter(|size| **size > 0).count();
    if usize::from(frames) != used {
        return Err(wrong(&format!("it has {frames} streams, not {used}")));
    }
    let table: Option<Vec<(u64, u64)>> = (0..frames).map(|_| Some((rest.u64()?, rest.u64()?))).collect();
    let mut table = table.ok_or_else(|| wrong("the file ends in it"))?.into_iter();
    let mut streams = Vec::new();
    for size in sizes {
        let entry = if size > 0 { table.next() } else { None };
        let Some((packed, inflated)) = entry else {
            streams.push(Vec::new());
            continue;
        };
        if inflated != size {
            return Err(wrong(&format!("a stream has {inflated} bytes, not {size}")));
        }
        let frame = rest.take(packed).ok_or_else(|| wrong("a stream ends after the file"))?;
        let inflated = inflate_zstd(frame, size);
        streams.push(inflated.map_err(|e| reading.malformed(format!("stream {}", streams.len()), e))?);
    }
    Ok((header, collect(streams, extensions.to_vec())))
}

fn collect(streams: Vec<Vec<u8>>, extensions: Vec<u8>) -> Streams {
    let mut streams = streams.into_iter();
    let mut next = || streams.next().unwrap_or_default();
    Streams {
        means: next(),
        opacities: next(),
        colors: next(),
        scales: next(),
        rotations: next(),
        coefficients: next(),
        extensions,
    }
}
