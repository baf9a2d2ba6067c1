//! Files that are read whole, within a limit.

use crate::CaptureError;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Reads a file that is no larger than `limit` bytes.
pub(crate) fn whole_file(file: &Path, limit: u64) -> Result<Vec<u8>, CaptureError> {
    let unreadable = |source| CaptureError::unreadable(file, source);
    let input = File::open(file).map_err(unreadable)?;
    let size = input.metadata().map_err(unreadable)?.len();
    if size > limit {
        return Err(CaptureError::too_big(file, "has", size, limit));
    }
    let mut bytes = Vec::new();
    // It may grow while it is read.
    input.take(limit).read_to_end(&mut bytes).map_err(unreadable)?;
    Ok(bytes)
}

/// Reads the first bytes of a file, as many as there are.
pub(crate) fn head(file: &Path, length: u64) -> Vec<u8> {
    let mut bytes = Vec::new();
    // Errors are reported when the file is read whole.
    let _ = File::open(file).and_then(|input| input.take(length).read_to_end(&mut bytes));
    bytes
}
