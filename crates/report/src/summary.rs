//! What is reported for each scene besides its measurements.

use crate::measurement::reference::ReferenceError;
use crate::studies::left_out_photographs::Photographs;
use crate::studies::light_field_views::Views;
use crate::studies::live_preview::ShownPicture;
use crate::studies::refined_light::RefinedLight;
use lens::Camera;
use render::Modelled;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// A scene of the report.
#[derive(Clone, Debug, Serialize)]
pub struct SceneSummary {
    /// Name.
    pub name: String,
    /// File name.
    pub file: String,
    /// Number of triangles.
    pub triangles: usize,
    /// Number of parts that can be painted separately.
    pub parts: usize,
    /// Number of lights.
    pub lights: usize,
    /// The camera, at the size of the pictures.
    #[serde(skip)]
    pub camera: Camera,
    /// Picture size, px.
    pub size: [u32; 2],
    /// Half the side of the aperture's square, scene units.
    pub aperture_radius: f64,
    /// f-number.
    pub f_number: f64,
    /// Distance to the plane of focus, scene units; `None` for infinity.
    pub focus_distance: Option<f64>,
    /// Source of the lens.
    pub lens: String,
    /// Seconds to build the hierarchy over the triangles, which no measurement includes.
    pub prepare_seconds: f64,
    /// Bytes of the hierarchy.
    pub hierarchy_bytes: usize,
    /// Its focuses.
    pub focuses: Vec<FocusSummary>,
    /// Pictures of the live preview; empty if it was not measured.
    pub live: Vec<ShownPicture>,
    /// Reconstruction of left-out photographs; `None` if there are too few.
    pub photographs: Option<Photographs>,
    /// Measurements of the views of a light field; `None` for other scenes.
    pub views: Option<Views>,
    /// Error of the cached light; `None` if there is no light to compute.
    pub light: Option<RefinedLight>,
    /// What is modelled.
    pub modelled: ModelledScene,
    /// Oddities that do no harm.
    pub warnings: Vec<String>,
}

/// A focus of a scene.
#[derive(Clone, Debug, Serialize)]
pub struct FocusSummary {
    /// Name.
    pub name: String,
    /// What it does, a sentence.
    pub what: String,
    /// Its reference.
    pub reference: Reference,
    /// The reference's picture.
    #[serde(skip)]
    pub picture: PathBuf,
}

/// A reference, as stored.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// Its error.
    pub error: ReferenceError,
    /// The 50th, 90th and 99th percentile of the circle of confusion over the pixels with a surface, px.
    pub circles_px: [f64; 3],
}

/// What is modelled of a scene under the standard lens, and the error of the compact form.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModelledScene {
    /// Texels, samples, bytes.
    pub modelled: Modelled,
    /// Tolerance of the bake, px.
    pub tolerance_px: f64,
    /// PSNR of its picture against that of the finest light field with unpacked samples, dB.
    pub saving_psnr: f64,
    /// Mean FLIP between the two.
    pub saving_flip: f64,
    /// Bytes of the finest light field.
    pub finest_bytes: usize,
}
