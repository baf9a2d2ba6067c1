//! Files of splats, in every format, told apart by their content.
//!
//! A reader trusts nothing: counts are checked against the bytes that are there before room is made, what is compressed is inflated no
//! further than the count needs, and splats that cannot be drawn are left out and counted.

mod bounded;
mod bytes;
mod cameras_json;
mod detection;
mod format;
mod gltf;
mod ksplat;
mod ply;
mod quaternion;
mod raw_splat;
mod reading;
mod sog;
mod splat_file;
mod spz;

pub use cameras_json::{CameraList, CapturedView};
pub use format::SplatFormat;
pub use gltf::{GltfAttributes, read_gltf_attributes};
pub use ply::{read_focus_table, write_focus_table, write_ply};
pub use splat_file::{ReadOptions, SplatFile};

use crate::error::GaussianError;
use detection::detect;
use progress::Progress;
use reading::Reading;
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

/// Whether a path is that of splats, by its extension; or a folder of SOG, or the list of one.
pub fn may_be_splats(path: &Path) -> bool {
    const EXTENSIONS: [&str; 5] = ["ply", "spz", "sog", "splat", "ksplat"];
    if path.is_dir() {
        return sog::is_list(&path.join("meta.json"));
    }
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    EXTENSIONS.contains(&extension.as_str()) || sog::is_list(path)
}

/// Reads a file of splats, or a folder (or its `meta.json`) of SOG. The format follows from the content.
///
/// # Errors
/// The file cannot be read, has no splats, is malformed, of a version that is not read, or exceeds the limits; or `progress` cancels.
pub fn open(path: &Path, options: &ReadOptions, progress: &dyn Progress) -> Result<SplatFile, GaussianError> {
    let unreadable = |source| GaussianError::unreadable(path, source);
    let reading = Reading::new(path, options, progress);
    if path.is_dir() {
        return sog::read_folder(reading, path);
    }
    let file = File::open(path).map_err(unreadable)?;
    let size = file.metadata().map_err(unreadable)?.len();
    let mut input = BufReader::with_capacity(1 << 20, file);
    if ply::is_ply(input.fill_buf().map_err(unreadable)?) {
        return ply::read(reading, input, size);
    }
    reading.check_memory("the file takes", size)?;
    let mut bytes = Vec::new();
    input.take(size).read_to_end(&mut bytes).map_err(unreadable)?;
    if detect(&bytes, path) == Some(SplatFormat::SogFolder) {
        let folder = path.parent().unwrap_or(Path::new("."));
        return sog::read_folder(reading, folder);
    }
    read_whole(reading, &bytes)
}

/// Reads a file of splats that is in memory; `file` is its name in messages, and decides between formats without a signature.
///
/// # Errors
/// As [`open`]; a `meta.json` of SOG alone has no splats.
pub fn read(
    bytes: &[u8],
    file: &Path,
    options: &ReadOptions,
    progress: &dyn Progress,
) -> Result<SplatFile, GaussianError> {
    let reading = Reading::new(file, options, progress);
    if ply::is_ply(bytes) {
        return ply::read(reading, bytes, bytes.len() as u64);
    }
    read_whole(reading, bytes)
}

fn read_whole(reading: Reading<'_>, bytes: &[u8]) -> Result<SplatFile, GaussianError> {
    match detect(bytes, reading.file()) {
        Some(SplatFormat::Spz) => spz::read(reading, bytes),
        Some(SplatFormat::Sog) => sog::read_archive(reading, bytes),
        Some(SplatFormat::Ksplat) => ksplat::read(reading, bytes),
        Some(SplatFormat::Splat) => raw_splat::read(reading, bytes),
        Some(SplatFormat::SogFolder) => {
            Err(GaussianError::no_splats(reading.file(), "is the list of a SOG scene without its pictures"))
        }
        Some(SplatFormat::Gltf) => Err(GaussianError::no_splats(reading.file(), "is a glTF scene")),
        Some(SplatFormat::Ply | SplatFormat::CompressedPly) | None => {
            Err(GaussianError::no_splats(reading.file(), "is no file of Gaussian splats"))
        }
    }
}
