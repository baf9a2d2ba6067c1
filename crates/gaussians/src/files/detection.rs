//! Telling formats apart by their content.

use super::format::SplatFormat;
use super::{ksplat, raw_splat};
use std::path::Path;

/// The format of a file's bytes, but for [`SplatFormat::Ply`] and [`SplatFormat::CompressedPly`], which their header tells apart. `.splat` has no
/// signature and `.ksplat` a weak one: their numbers must be plausible, unless the name says it.
pub(super) fn detect(bytes: &[u8], file: &Path) -> Option<SplatFormat> {
    let extension = file.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    match bytes {
        [b'p', b'l', b'y', b'\n' | b'\r', ..] => Some(SplatFormat::Ply),
        [0x1f, 0x8b, ..] | [b'N', b'G', b'S', b'P', ..] => Some(SplatFormat::Spz),
        [b'P', b'K', 3, 4, ..] => Some(SplatFormat::Sog),
        [b'g', b'l', b'T', b'F', ..] => Some(SplatFormat::Gltf),
        _ if extension == "ksplat" || ksplat::is_plausible(bytes) => Some(SplatFormat::Ksplat),
        _ if extension == "splat" || raw_splat::is_plausible(bytes) => Some(SplatFormat::Splat),
        _ if bytes.trim_ascii_start().first() == Some(&b'{') => Some(SplatFormat::SogFolder),
        _ => None,
    }
}
