//! Portable float maps: `Pf` or `PF`, width and height, a scale whose sign is the byte order (negative: little endian), then
//! rows of floats from the bottom up. Of the three channels of `PF` the first is read.

use super::stored::{Numbers, Stored};
use crate::CaptureError;
use crate::files::text::quoted;
use std::path::Path;

/// Reads the numbers of a PFM of at most `max_pixels` pixels.
pub(crate) fn read_pfm(file: &Path, bytes: &[u8], max_pixels: u64) -> Result<Stored, CaptureError> {
    let malformed = |at: usize, what: String| CaptureError::malformed(file, format!("byte {at}"), what);
    let mut at = 0;
    let mut word = || {
        while bytes.get(at).is_some_and(u8::is_ascii_whitespace) {
            at += 1;
        }
        let start = at;
        while bytes.get(at).is_some_and(|byte| !byte.is_ascii_whitespace()) && at - start < 40 {
            at += 1;
        }
        (start, String::from_utf8_lossy(&bytes[start..at]).into_owned(), at)
    };
    let (_, magic, _) = word();
    let channels = match magic.as_str() {
        "Pf" => 1,
        "PF" => 3,
        _ => {
            return Err(malformed(
                0,
                format!("it begins with {}, but a PFM begins with Pf or PF", quoted(&magic)),
            ));
        }
    };
    let mut side = |name: &str| {
        let (start, text, _) = word();
        let side = text.parse::<u32>().ok().filter(|side| *side > 0);
        side.ok_or_else(|| malformed(start, format!("{} is not a {name}", quoted(&text))))
    };
    let (width, height) = (side("width")?, side("height")?);
    let (start, text, end) = word();
    let scale = text.parse::<f32>().ok().filter(|scale| scale.is_finite() && *scale != 0.0);
    let scale = scale.ok_or_else(|| malformed(start, format!("{} is not a scale", quoted(&text))))?;
    let pixels = u64::from(width) * u64::from(height);
    if pixels > max_pixels {
        let what = format!("has {width} × {height} px, more than the limit of {max_pixels} px");
        return Err(CaptureError::TooBig { file: file.into(), what });
    }
    // One white space, then numbers.
    let data = bytes.get(end + 1..).unwrap_or_default();
    let expected = pixels * channels * 4;
    if (data.len() as u64) < expected {
        let what = format!("{width} × {height} px take {expected} bytes, {} are left", data.len());
        return Err(malformed(end, what));
    }
    let from = if scale < 0.0 { f32::from_le_bytes } else { f32::from_be_bytes };
    let row_bytes = width as usize * channels as usize * 4;
    let mut values = Vec::with_capacity(pixels as usize);
    for row in data[..expected as usize].chunks_exact(row_bytes).rev() {
        let pixels = row.chunks_exact(channels as usize * 4);
        values.extend(pixels.map(|pixel| from([pixel[0], pixel[1], pixel[2], pixel[3]])));
    }
    Ok(Stored { width, height, values, numbers: Numbers::Floats })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(bytes: &[u8]) -> Result<Vec<f32>, String> {
        read_pfm(Path::new("a.pfm"), bytes, 100)
            .map(|stored| stored.values)
            .map_err(|error| error.to_string())
    }

    #[test]
    fn both_byte_orders_from_the_bottom_up() {
        let bytes = |scale: &str, to: fn(f32) -> [u8; 4]| {
            [format!("Pf\n2 2\n{scale}\n").as_bytes(), &[3.0, 4.0, 1.0, 2.0].map(to).concat()].concat()
        };
        assert_eq!(read(&bytes("-1.0", f32::to_le_bytes)).unwrap(), [1.0, 2.0, 3.0, 4.0]);
        assert_eq!(read(&bytes("1", f32::to_be_bytes)).unwrap(), [1.0, 2.0, 3.0, 4.0]);
        // The control: the other order is something else.
        assert_ne!(read(&bytes("1", f32::to_le_bytes)).unwrap(), [1.0, 2.0, 3.0, 4.0]);
        let colored =
            [b"PF 1 2 -1\n".to_vec(), [5.0f32, 0.0, 0.0, 6.0, 0.0, 0.0].map(f32::to_le_bytes).concat()]
                .concat();
        assert_eq!(read(&colored).unwrap(), [6.0, 5.0]);
    }

    #[test]
    fn what_is_malformed_names_its_byte() {
        for (bytes, message) in [
            (&b"P5 1 1 255 "[..], "byte 0: it begins with \"P5\""),
            (b"Pf 0 1 -1\n....", "byte 3: \"0\" is not a width"),
            (b"Pf 1 x -1\n....", "byte 5: \"x\" is not a height"),
            (b"Pf 1 1 0\n....", "byte 7: \"0\" is not a scale"),
            (b"Pf 2 1 -1\n....", "byte 9: 2 × 1 px take 8 bytes, 4 are left"),
            (b"Pf 4000000000 4000000000 -1\n", "more than the limit of 100 px"),
            (b"", "byte 0"),
        ] {
            let text = read(bytes).unwrap_err();
            assert!(text.contains(message), "{text}");
        }
    }
}
