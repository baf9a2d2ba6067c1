//! What a finished picture says of itself: the plan that it was made by, and that nothing of it is missing.
//!
//! ```text
//! plan=<64 hex digits> seal=<64 hex digits> beside=<names of the files of its layers, / between them>
//! ```
//!
//! stands in an EXR as the text attribute `focusBrush.frame`, in a PNG as a text chunk of that name. The seal is the SHA-256 of the whole
//! file with zeros in the seal's own place, and of the files beside it. It is put in when all of them are written, in one step: a
//! picture that has a seal is whole, and was made by that plan.

use crate::ProjectError;
use crate::disk::{extension, read_bytes, write_bytes};
use crate::exr_header;
use crate::scene_path::hex;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

/// The attribute's or chunk's name.
const NAME: &str = "focusBrush.frame";

/// Hex digits of a checksum.
const DIGITS: usize = 64;

/// Seals a picture: `files` are what [`write_picture`](crate::write_picture) wrote, the picture first.
///
/// # Errors
/// It cannot be read or written again, or is neither EXR nor PNG.
pub fn seal_picture(files: &[PathBuf], plan: &[u8; 32]) -> Result<(), ProjectError> {
    let Some((picture, companions)) = files.split_first() else { return Ok(()) };
    let names: Vec<_> = companions.iter().filter_map(|file| file.file_name()?.to_str()).collect();
    let mut text = format!("plan={} seal={}", hex(plan), "0".repeat(DIGITS));
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

/// Whether a picture is there that was made by this plan, and is whole.
pub fn is_finished(picture: &Path, plan: &[u8; 32]) -> bool {
    let Ok(bytes) = read_bytes(picture) else { return false };
    let Some(sealed) = Sealed::parse(&bytes).filter(|sealed| sealed.plan == hex(plan)) else { return false };
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

/// The seal of bytes that have zeros in its place, and of the files beside them.
fn compute_seal(bytes: &[u8], at_seal: usize, companions: &[PathBuf]) -> Result<String, ProjectError> {
    debug_assert!(bytes[at_seal..at_seal + DIGITS].iter().all(|digit| *digit == b'0'));
    let mut hash = Sha256::new();
    hash.update(Sha256::digest(bytes));
    for file in companions {
        hash.update(Sha256::digest(read_bytes(file)?));
    }
    Ok(hex(&hash.finalize()))
}

/// What a picture says of itself.
struct Sealed {
    plan: String,
    /// Where the seal's digits begin.
    at_seal: usize,
    companions: Vec<String>,
}

impl Sealed {
    fn parse(bytes: &[u8]) -> Option<Self> {
        let text = match png_chunk(bytes) {
            Some(chunk) => chunk.text,
            None => exr_header::attribute_value_range(bytes, NAME)?,
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
        // Only files of the same folder are asked for.
        let is_name = |name: &String| Path::new(name).components().count() == 1 && name != "..";
        companions.iter().all(is_name).then(|| Self { plan: plan.into(), at_seal, companions })
    }
}

/// A picture with a text of ours put in.
fn with_text(bytes: &[u8], text: &[u8]) -> Option<Vec<u8>> {
    if !bytes.starts_with(PNG) {
        return exr_header::with_text_attribute(bytes, NAME, text);
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

/// Our text chunk of a PNG.
struct PngChunk {
    /// Name and data, which the checksum is of.
    checked: std::ops::Range<usize>,
    /// The text behind its keyword.
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
