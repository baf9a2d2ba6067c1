//! Pictures, and skies.

use crate::folder::file;
use crate::outcome::read_or_refused;
use crate::scenes::limits;
use project::WorldFile;
use scene::{Photograph, Scene};
use std::path::Path;

/// Reads a picture as one to compare with, and as a photograph.
pub fn picture(bytes: &[u8]) {
    read_or_refused(project::read_picture(&file("picture.png", bytes)));
    read_or_refused(Photograph::decode(bytes, Path::new("photograph"), 1, &limits()));
}

/// Reads an OpenEXR picture.
pub fn openexr(bytes: &[u8]) {
    read_or_refused(project::read_picture(&file("picture.exr", bytes)));
}

/// Reads a Radiance HDR picture as the light around a scene.
pub fn radiance(bytes: &[u8]) {
    let sky = file("sky.hdr", bytes);
    read_or_refused(WorldFile::from_environment_file(&sky).load(&Scene::default()));
}
