//! Inflating no further than needed.

use ruzstd::StreamingDecoder;
use std::io::{self, Read};

/// The largest ratio of deflate: 258 bytes in two bits.
pub(super) const MAX_DEFLATE_RATIO: u64 = 1032;

/// The largest window of a zstd frame that is accepted whatever its content, bytes: that of level 19.
const MAX_ZSTD_WINDOW: u64 = 8 << 20;

/// Reads exactly `count` bytes, which the caller has checked against the bytes that are there.
///
/// # Errors
/// There are fewer, or they cannot be inflated.
pub(super) fn read_exactly(input: impl Read, count: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::with_capacity(count as usize);
    input.take(count).read_to_end(&mut bytes)?;
    if (bytes.len() as u64) < count {
        return Err(io::Error::new(io::ErrorKind::UnexpectedEof, "it ends too early"));
    }
    Ok(bytes)
}

/// Inflates a zstd frame of exactly `count` bytes.
///
/// # Errors
/// It is malformed, has fewer or more bytes, or demands a window larger than it needs.
pub(super) fn inflate_zstd(frame: &[u8], count: u64) -> io::Result<Vec<u8>> {
    let invalid = |what: &str| io::Error::new(io::ErrorKind::InvalidData, what);
    let (header, _) = ruzstd::frame::read_frame_header(frame).map_err(|e| invalid(&e.to_string()))?;
    let window = header.header.window_size().map_err(|e| invalid(&e.to_string()))?;
    if window > count.max(MAX_ZSTD_WINDOW) {
        return Err(invalid("its window is larger than its content"));
    }
    let mut decoder = StreamingDecoder::new(frame).map_err(|e| invalid(&e.to_string()))?;
    let bytes = read_exactly(&mut decoder, count)?;
    match decoder.read(&mut [0])? {
        0 => Ok(bytes),
        _ => Err(invalid("it is longer than declared")),
    }
}
