//! Options of a report.

use document::{CameraChoice, InputKind, VariantChoice};
use light::{LightOptions, Resources};
use project::WorldFile;
use scene::BackFaces;
use session::SessionError;
use sha2::{Digest, Sha256};
use std::io::Read;
use std::path::{Path, PathBuf};

/// A scene to measure on.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneRequest {
    /// A scene or project.
    pub file: PathBuf,
    /// The camera; default: the project's, or the scene's first.
    pub camera: Option<CameraChoice>,
    /// A recipe or focus map; default: the project's paint, or a generic focus by material.
    pub focus: Option<PathBuf>,
    /// Whether single-sided faces are visible from behind; default: as in the project.
    pub back_faces: Option<BackFaces>,
    /// The material variant.
    pub variant: VariantChoice,
    /// The world; default: the project's.
    pub world: Option<WorldFile>,
    /// How light is modelled.
    pub light: LightOptions,
}

impl SceneRequest {
    /// Refuses a file that is no scene, before anything is measured.
    ///
    /// # Errors
    /// There is no such file, or it is of another kind.
    pub fn check(&self) -> Result<(), SessionError> {
        if !self.file.exists() {
            return Err(SessionError::bad_file(&self.file, "no such file (check the path)"));
        }
        InputKind::from_path(&self.file)?;
        Ok(())
    }
}

/// Scope and settings of the measurements.
#[derive(Clone, Debug)]
pub struct ReportOptions {
    /// Size of the pictures, px; default: [`ReportOptions::HEIGHT`] pixels high with the camera's aspect ratio.
    pub size: Option<[u32; 2]>,
    /// Rays per pixel of the reference pictures.
    pub reference_spp: u32,
    /// Whether to measure only a few points of every sweep.
    pub is_quick: bool,
    /// Whether to run the hard cases.
    pub with_hard_cases: bool,
    /// Identifies the build of the program ([`build_checksum`]); stored measurements of other builds are not reused.
    pub build: String,
    /// How scenes are unwrapped.
    pub unwrap: atlas::UnwrapOptions,
    /// What work on scenes may use.
    pub resources: Resources,
}

impl ReportOptions {
    /// Default height of the pictures, px.
    pub const HEIGHT: u32 = 180;
    /// Default rays per pixel of the references.
    pub const REFERENCE_SPP: u32 = 1024;
    /// Default for a quick report.
    pub const QUICK_REFERENCE_SPP: u32 = 512;
    /// Default for a report on the engine alone, whose pictures are large.
    pub const ENGINE_REFERENCE_SPP: u32 = 256;
    /// Minimum rays per pixel of a reference, which consists of two halves.
    pub const MIN_REFERENCE_SPP: u32 = 2;
}

/// Identifies a build by its program, or the library that measures: the SHA-256 checksum of the file, as hexadecimal digits.
///
/// # Errors
/// The file cannot be read.
pub fn build_checksum(file: &Path) -> std::io::Result<String> {
    let mut file = std::fs::File::open(file)?;
    let mut sum = Sha256::new();
    let mut block = vec![0; 1 << 20];
    loop {
        let length = file.read(&mut block)?;
        if length == 0 {
            return Ok(hex::encode(sum.finalize()));
        }
        sum.update(&block[..length]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_build_is_known_by_its_bytes() {
        let folder = tempfile::tempdir().unwrap();
        let checksum = |bytes: &[u8]| {
            let file = folder.path().join("program");
            std::fs::write(&file, bytes).unwrap();
            build_checksum(&file).unwrap()
        };
        // The example of FIPS 180-2.
        let known = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(checksum(b"abc"), known);
        assert_ne!(checksum(&vec![0; 1 << 20]), checksum(&vec![0; (1 << 20) + 1]), "longer than a block");
        assert!(build_checksum(&folder.path().join("none")).is_err());
    }
}
