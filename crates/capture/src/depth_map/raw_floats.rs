//! Floats without a header, whose size another file specifies: `depth.bin` of the older HCI light fields.

use crate::CaptureError;
use crate::files::whole_file::whole_file;
use std::path::Path;

/// Reads the little-endian floats of a file, which must be of `size`, row 0 on top.
pub(crate) fn raw_floats(file: &Path, size: [u32; 2], limit: u64) -> Result<Vec<f32>, CaptureError> {
    let bytes = whole_file(file, limit)?;
    let expected = u64::from(size[0]) * u64::from(size[1]) * 4;
    if bytes.len() as u64 != expected {
        let [width, height] = size;
        let what = format!("{width} × {height} px take {expected} bytes, the file has {}", bytes.len());
        return Err(CaptureError::malformed(file, format!("byte {}", bytes.len()), what));
    }
    let (floats, _) = bytes.as_chunks::<4>();
    Ok(floats.iter().map(|float| f32::from_le_bytes(*float)).collect())
}
