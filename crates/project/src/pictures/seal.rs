//! The seal of a finished picture: the plan that it was made by, and a checksum that proves it complete.
//!
//! ```text
//! plan=<64 hex digits> seal=<64 hex digits> beside=<names of the files of its layers, / between them>
//! ```
//!
//! is stored in an EXR as the text attribute `focusBrush.frame`, in a PNG as a text chunk of that name. The seal is
//! the SHA-256 of the whole file, with zeros in place of the seal itself, and of the companion files. It is inserted,
//! in one step, after all of them are written: a picture that has a seal is complete and was made by that plan.

use crate::ProjectError;
use crate::disk::{extension, read_bytes, write_bytes};
use crate::openexr::header;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

/// Name of the attribute or chunk.
const NAME: &str = "focusBrush.frame";

/// Hex digits of a checksum.
const DIGITS: usize = 64;

/// Seals a picture: `files` are those that [`write_picture`](crate::write_picture) returned, the picture first.
///
/// # Errors
/// It cannot be read or written again, or is neither EXR nor PNG.
pub fn seal_picture(files: &[PathBuf], plan: &[u8; 32]) -> Result<(), ProjectError> {
    let Some((picture, companions)) = files.split_first() else { return Ok(()) };
    let names: Vec<_> = companions.iter().filter_map(|file| file.file_name()?.to_str()).collect();
    let mut text = format!("plan={} seal={}", hex::encode(plan), "0".repeat(DIGITS));
    if !names.is_empty() {
        text += &format!(" beside={}", names.join("/"));
    }
    let unsupported = || ProjectError::content(picture, "cannot be sealed", "name an .exr or .png");
    let bytes = with_text(&read_bytes(picture)?, text.as_bytes()).ok_or_else(unsupported)?;
    let Sealed { at_seal, .. } = Sealed::parse(&bytes).ok_or_else(unsupported)?;
    let seal = compute_seal(&bytes, at_seal, companions)?;
    let mut bytes = bytes;
    bytes[at_seal..at_seal + DIGITS].copy_from_slice(seal.as_bytes());
    if extension(picture) == "png" {
        png_chunk(&bytes).ok_or_else(unsupported)?.update_checksum(&mut bytes);
    }
    write_bytes(picture, &bytes)
}

/// Whether a picture exists that was made by this plan and is complete.
pub fn is_finished(picture: &Path, plan: &[u8; 32]) -> bool {
    let Ok(bytes) = read_bytes(picture) else { return false };
    let Some(sealed) = Sealed::parse(&bytes).filter(|sealed| sealed.plan == hex::encode(plan)) else {
        return false;
    };
    let companions: Vec<_> = sealed.companions.iter().map(|name| picture.with_file_name(name)).collect();
    let digits = &bytes[sealed.at_seal..sealed.at_seal + DIGITS];
    let is_matching = |seal: String| seal.as_bytes() == digits;
    let mut open = bytes.clone();
    open[sealed.at_seal..sealed.at_seal + DIGITS].fill(b'0');
    if let Some(chunk) = png_chunk(&open) {
        chunk.update_checksum(&mut open);
    }
    compute_seal(&open, sealed.at_seal, &companions).is_ok_and(is_matching)
}

/// The seal of bytes that have zeros in its place, and of the companion files.
fn compute_seal(bytes: &[u8], at_seal: usize, companions: &[PathBuf]) -> Result<String, ProjectError> {
    debug_assert!(bytes[at_seal..at_seal + DIGITS].iter().all(|digit| *digit == b'0'));
    let mut hash = Sha256::new();
    hash.update(Sha256::digest(bytes));
    for file in companions {
        hash.update(Sha256::digest(read_bytes(file)?));
    }
    Ok(hex::encode(hash.finalize()))
}

/// The parsed seal of a picture.
struct Sealed {
    plan: String,
    /// Offset of the seal's digits.
    at_seal: usize,
    companions: Vec<String>,
}

impl Sealed {
    fn parse(bytes: &[u8]) -> Option<Self> {
        let text = match png_chunk(bytes) {
            Some(chunk) => chunk.text,
            None => header::attribute_value_range(bytes, NAME)?,
        };
        let at = text.start;
        let text = std::str::from_utf8(bytes.get(text)?).ok()?;
        let rest = text.strip_prefix("plan=")?;
        let (plan, rest) = rest.split_at_checked(DIGITS)?;
        let rest = rest.strip_prefix(" seal=")?;
        let at_seal = at + (text.len() - rest.len());
        let (_, rest) = rest.split_at_checked(DIGITS)?;
        let companions = match rest.strip_prefix(" beside=") {
            Some(names) => names.split('/').map(String::from).collect(),
            None if rest.is_empty() => Vec::new(),
            None => return None,
        };
        // Only files of the same folder are read.
        let is_name = |name: &String| Path::new(name).components().count() == 1 && name != "..";
        companions.iter().all(is_name).then(|| Self { plan: plan.into(), at_seal, companions })
    }
}

/// The picture's bytes with the text inserted.
fn with_text(bytes: &[u8], text: &[u8]) -> Option<Vec<u8>> {
    if !bytes.starts_with(PNG) {
        return header::with_text_attribute(bytes, NAME, text);
    }
    let after_header = PNG.len() + 25;
    let (before, after) = bytes.split_at_checked(after_header)?;
    let data = [NAME.as_bytes(), b"\0", text].concat();
    let length = u32::try_from(data.len()).ok()?.to_be_bytes();
    let named = [b"tEXt", &data[..]].concat();
    let checksum = crc32fast::hash(&named).to_be_bytes();
    Some([before, &length, &named, &checksum, after].concat())
}

const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";

/// The seal's text chunk of a PNG.
struct PngChunk {
    /// Name and data: what the chunk's checksum covers.
    checked: std::ops::Range<usize>,
    /// The text after its keyword.
    text: std::ops::Range<usize>,
}

impl PngChunk {
    fn update_checksum(&self, bytes: &mut [u8]) {
        let checksum = crc32fast::hash(&bytes[self.checked.clone()]).to_be_bytes();
        bytes[self.checked.end..self.checked.end + 4].copy_from_slice(&checksum);
    }
}

fn png_chunk(bytes: &[u8]) -> Option<PngChunk> {
    let mut at = bytes.starts_with(PNG).then_some(PNG.len())?;
    loop {
        let length = u32::from_be_bytes(bytes.get(at..at + 4)?.try_into().ok()?) as usize;
        let checked = at + 4..at.checked_add(8)?.checked_add(length)?;
        bytes.get(checked.end..checked.end + 4)?;
        let start = [b"tEXt", NAME.as_bytes(), b"\0"].concat();
        if bytes[checked.clone()].starts_with(&start) {
            return Some(PngChunk { text: checked.start + start.len()..checked.end, checked });
        }
        at = checked.end + 4;
    }
}
