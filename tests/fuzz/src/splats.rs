//! Gaussian splats.

use crate::folder::file;
use crate::outcome::read_or_refused;
use gaussians::{CameraList, ReadOptions};
use progress::Unwatched;
use std::path::Path;

/// Reads a file of splats of this name.
fn splats(bytes: &[u8], name: &str) -> Option<gaussians::SplatFile> {
    read_or_refused(gaussians::read(
        bytes,
        Path::new(name),
        &ReadOptions { max_memory: 64 << 20 },
        &Unwatched,
    ))
}

/// PLY, standard or compressed, with a focus for each splat where it has one.
pub fn splat_ply(bytes: &[u8]) {
    if let Some(read) = splats(bytes, "splats.ply") {
        let table = file("splats.ply", bytes);
        read_or_refused(gaussians::read_focus_table(&table, &read.cloud, &Unwatched));
    }
}

/// SPZ.
pub fn spz(bytes: &[u8]) {
    splats(bytes, "splats.spz");
}

/// SOG, as one archive.
pub fn sog(bytes: &[u8]) {
    splats(bytes, "splats.sog");
}

/// KSPLAT; what begins with an even byte also as the plain records of a `.splat`.
pub fn ksplat(bytes: &[u8]) {
    splats(bytes, "splats.ksplat");
    if bytes.first().is_some_and(|first| first % 2 == 0) {
        splats(bytes, "splats.splat");
    }
}

/// `cameras.json` beside a cloud.
pub fn cameras_json(bytes: &[u8]) {
    if let Some(list) = read_or_refused(CameraList::read(&file("cameras.json", bytes))) {
        list.up();
    }
}
