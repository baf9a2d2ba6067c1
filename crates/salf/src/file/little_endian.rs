//! Numbers and texts in a `.salf` file.

use super::SalfFileError;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

/// More than any path takes.
const LONGEST_TEXT: u32 = 1 << 16;
/// Room made for samples before they are read: a wrong count must not take the memory.
pub const FIRST_CAPACITY: u64 = 1 << 20;

/// The next N bytes.
///
/// # Errors
/// `from` cannot be read, or ends too early.
pub fn bytes<const N: usize>(from: &mut impl Read) -> Result<[u8; N], SalfFileError> {
    let mut buffer = [0; N];
    from.read_exact(&mut buffer).map_err(|error| match error.kind() {
        io::ErrorKind::UnexpectedEof => SalfFileError::CutShort,
        _ => SalfFileError::Io(error),
    })?;
    Ok(buffer)
}

/// Writes a text: its length in bytes (u32), then the bytes.
///
/// # Errors
/// Errors of `to`.
pub fn write_text(to: &mut impl Write, text: &[u8]) -> io::Result<()> {
    to.write_all(&(text.len() as u32).to_le_bytes())?;
    to.write_all(text)
}

/// Writes a path as a text, with slashes on every system: that of Windows is then the same as of others.
///
/// # Errors
/// Errors of `to`.
pub fn write_path(to: &mut impl Write, path: &Path) -> io::Result<()> {
    let bytes = path.as_os_str().as_encoded_bytes();
    // Paths that begin with two backslashes and a question mark know no slashes; none is relative.
    if cfg!(windows) && !bytes.starts_with(br"\\?\") {
        let slashes: Vec<u8> = bytes.iter().map(|&byte| if byte == b'\\' { b'/' } else { byte }).collect();
        return write_text(to, &slashes);
    }
    write_text(to, bytes)
}

/// Reads a text as [`write_text`] writes it.
///
/// # Errors
/// `from` cannot be read or ends too early, or the text is not UTF-8.
pub fn read_text(from: &mut impl Read) -> Result<String, SalfFileError> {
    String::from_utf8(read_text_bytes(from)?)
        .map_err(|_| SalfFileError::Damaged("a text that is not UTF-8".into()))
}

/// Reads a path: a text of any bytes.
///
/// # Errors
/// `from` cannot be read, or ends too early.
#[cfg(unix)]
pub fn read_path(from: &mut impl Read) -> Result<PathBuf, SalfFileError> {
    use std::os::unix::ffi::OsStringExt;
    Ok(std::ffi::OsString::from_vec(read_text_bytes(from)?).into())
}

/// Reads a path: a text.
///
/// # Errors
/// `from` cannot be read or ends too early, or the text is not UTF-8.
#[cfg(not(unix))]
pub fn read_path(from: &mut impl Read) -> Result<PathBuf, SalfFileError> {
    read_text(from).map(PathBuf::from)
}

fn read_text_bytes(from: &mut impl Read) -> Result<Vec<u8>, SalfFileError> {
    let length = u32::from_le_bytes(bytes(from)?);
    if length > LONGEST_TEXT {
        return Err(SalfFileError::Damaged(format!("a text of {length} bytes")));
    }
    let mut text = vec![0; length as usize];
    from.read_exact(&mut text).map_err(|_| SalfFileError::CutShort)?;
    Ok(text)
}

/// Writes numbers of 64 bits.
///
/// # Errors
/// Errors of `to`.
pub fn write_f64s(to: &mut impl Write, values: &[f64]) -> io::Result<()> {
    values.iter().try_for_each(|value| to.write_all(&value.to_le_bytes()))
}

/// Reads N numbers of 64 bits, whatever they are.
///
/// # Errors
/// `from` cannot be read, or ends too early.
pub fn read_f64s<const N: usize>(from: &mut impl Read) -> Result<[f64; N], SalfFileError> {
    let mut values = [0.0; N];
    for value in &mut values {
        *value = f64::from_le_bytes(bytes(from)?);
    }
    Ok(values)
}

/// Writes numbers of 32 bits.
///
/// # Errors
/// Errors of `to`.
pub fn write_f32s(to: &mut impl Write, values: &[f32]) -> io::Result<()> {
    values.iter().try_for_each(|value| to.write_all(&value.to_le_bytes()))
}

/// Reads N numbers of 32 bits, whatever they are.
///
/// # Errors
/// `from` cannot be read, or ends too early.
pub fn read_f32s<const N: usize>(from: &mut impl Read) -> Result<[f32; N], SalfFileError> {
    let mut values = [0.0; N];
    for value in &mut values {
        *value = f32::from_le_bytes(bytes(from)?);
    }
    Ok(values)
}
