//! What is asked of a report.

use project::WorldFile;
use scene::BackFaces;
use session::{CameraChoice, VariantChoice};
use std::path::PathBuf;

/// A scene to measure on.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneRequest {
    /// A scene or project.
    pub file: PathBuf,
    /// The camera; without one the project's, or the scene's first.
    pub camera: Option<CameraChoice>,
    /// A recipe or focus map; without one the project's paint, or a focus made up from the scene's materials.
    pub focus: Option<PathBuf>,
    /// Whether faces that are not double sided are seen from behind; without one as the project says.
    pub back_faces: Option<BackFaces>,
    /// The scene's variant.
    pub variant: VariantChoice,
    /// What lies beyond all surfaces; without one as the project says.
    pub world: Option<WorldFile>,
    /// Whether light that meets microfacets more than once is left out.
    pub single_scattering: bool,
    /// Where light of photographs is looked up.
    pub photo_lookup: scene::PhotoLookup,
}

/// How much is measured.
#[derive(Clone, Debug, PartialEq)]
pub struct ReportOptions {
    /// Size of the pictures, px; without one [`ReportOptions::HEIGHT`] pixels high, as wide as the camera's picture.
    pub size: Option<[u32; 2]>,
    /// Rays a pixel of the reference pictures.
    pub reference_spp: u32,
    /// Whether to measure only a few points of every sweep.
    pub is_quick: bool,
    /// Whether to run the hard cases.
    pub with_hard_cases: bool,
    /// What tells one build of the program from another; measurements of another build do not count.
    pub build: String,
    /// How scenes are unwrapped.
    pub unwrap: atlas::UnwrapOptions,
}

impl ReportOptions {
    /// Height of the pictures unless a size is given, px.
    pub const HEIGHT: u32 = 180;
    /// Rays a pixel of the references unless asked otherwise.
    pub const REFERENCE_SPP: u32 = 1024;
    /// The same for a quick report.
    pub const QUICK_REFERENCE_SPP: u32 = 512;
    /// The same where the engine alone is measured: its pictures are large.
    pub const ENGINE_REFERENCE_SPP: u32 = 256;
    /// Fewest rays a pixel of a reference: two halves are compared.
    pub const MIN_REFERENCE_SPP: u32 = 2;
}
