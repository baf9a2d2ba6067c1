//! Options of a report.

use document::{CameraChoice, VariantChoice};
use light::{LightOptions, Resources};
use project::WorldFile;
use scene::BackFaces;
use std::path::PathBuf;

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
    /// Identifies the build of the program; stored measurements of other builds are not reused.
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
