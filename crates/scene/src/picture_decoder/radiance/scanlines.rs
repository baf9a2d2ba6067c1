//! The scanlines of a Radiance picture: pixels of four bytes, uncoded or in one of two run-length codings.
//!
//! * By channel: 2, 2 and the length of the scanline, high byte first; then for each of the four channels pieces of a
//!   count and, up to 128, as many bytes, or beyond, one byte that is repeated count − 128 times.
//! * By pixel (before 1991): a pixel 1, 1, 1, n repeats the one before it n times; directly after another such pixel
//!   n counts 256 times as much.
//!
//! Neither can begin with a pixel that a program would store uncoded, if its largest mantissa is 128 or more, as it
//! should be. Not all programs take care of that.

use super::header::Header;

/// Lengths of scanlines that can be coded by channel.
const CODED_LENGTHS: std::ops::RangeInclusive<u32> = 8..=0x7FFF;

/// Maximum number of bytes of all scanlines: coded by channel, every byte in a piece of its own.
pub(super) fn max_bytes(header: &Header) -> u64 {
    u64::from(header.scanlines).saturating_mul(4 + 8 * u64::from(header.length))
}

/// Decodes all scanlines and passes each pixel to `place`, with its scanline and its place on it.
pub(super) fn decode(
    data: &[u8],
    header: &Header,
    mut place: impl FnMut(usize, usize, [u8; 4]),
) -> Result<(), String> {
    let length = header.length as usize;
    let uncoded = data.as_chunks::<4>();
    let can_be_uncoded = uncoded.1.is_empty()
        && uncoded.0.len() as u64 == u64::from(header.scanlines) * u64::from(header.length);
    match decode_coded(data, header, &mut place) {
        Ok([]) => Ok(()),
        // A pixel was taken for a coding.
        _ if can_be_uncoded => {
            for (k, pixel) in uncoded.0.iter().enumerate() {
                place(k / length, k % length, *pixel);
            }
            Ok(())
        }
        decoded => decoded.map(|_| ()),
    }
}

/// Decodes all scanlines, taking whatever looks like a coding for one; returns the bytes that are left.
fn decode_coded<'a>(
    mut data: &'a [u8],
    header: &Header,
    place: &mut impl FnMut(usize, usize, [u8; 4]),
) -> Result<&'a [u8], String> {
    let mut pixels = vec![[0; 4]; header.length as usize];
    let mark = [2, 2, (header.length >> 8) as u8, header.length as u8];
    for scanline in 0..header.scanlines as usize {
        let by_channel = CODED_LENGTHS.contains(&header.length) && data.starts_with(&mark);
        let decoded = if by_channel {
            decode_by_channel(&data[mark.len()..], &mut pixels)
        } else {
            decode_by_pixel(data, &mut pixels)
        };
        data = decoded.map_err(|what| format!("scanline {} of {} {what}", scanline + 1, header.scanlines))?;
        pixels.iter().enumerate().for_each(|(at, pixel)| place(scanline, at, *pixel));
    }
    Ok(data)
}

/// What is wrong with a scanline, as the continuation of its name.
type Fault = &'static str;
const CUT_OFF: Fault = "is cut off";
const TOO_LONG: Fault = "has pixels beyond its end";

fn decode_by_channel<'a>(mut data: &'a [u8], pixels: &mut [[u8; 4]]) -> Result<&'a [u8], Fault> {
    for channel in 0..4 {
        let mut rest = &mut *pixels;
        while !rest.is_empty() {
            let (count, after) = data.split_first().ok_or(CUT_OFF)?;
            let (count, repeats) = match usize::from(*count) {
                0 => return Err("has a run of no pixel"),
                count @ 1..=128 => (count, false),
                count => (count - 128, true),
            };
            let (values, after) = after.split_at_checked(if repeats { 1 } else { count }).ok_or(CUT_OFF)?;
            let (run, next) = rest.split_at_mut_checked(count).ok_or(TOO_LONG)?;
            for (pixel, value) in run.iter_mut().zip(values.iter().cycle()) {
                pixel[channel] = *value;
            }
            (data, rest) = (after, next);
        }
    }
    Ok(data)
}

fn decode_by_pixel<'a>(mut data: &'a [u8], pixels: &mut [[u8; 4]]) -> Result<&'a [u8], Fault> {
    let mut last = None;
    let mut rest = pixels;
    // How much the next count counts, as a power of 2.
    let mut shift = 0;
    while !rest.is_empty() {
        let (pixel, after) = data.split_first_chunk::<4>().ok_or(CUT_OFF)?;
        let run;
        (run, rest) = if let [1, 1, 1, count] = *pixel {
            let count = usize::from(count).checked_shl(shift).ok_or(TOO_LONG)?;
            shift += 8;
            rest.split_at_mut_checked(count).ok_or(TOO_LONG)?
        } else {
            (last, shift) = (Some(*pixel), 0);
            rest.split_at_mut(1)
        };
        run.fill(last.ok_or("begins with a run")?);
        data = after;
    }
    Ok(data)
}
