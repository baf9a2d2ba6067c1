//! What is told of each scene beside its measurements.

use crate::live::ShownPicture;
use crate::photographs::Photographs;
use crate::reference::ReferenceError;
use crate::refined::RefinedLight;
use crate::views::Views;
use lens::Camera;
use serde::{Deserialize, Serialize};
use session::Modelled;
use std::path::PathBuf;

/// A scene of the report.
#[derive(Clone, Debug, Serialize)]
pub struct SceneSummary {
    /// Its name.
    pub name: String,
    /// Its file's name.
    pub file: String,
    /// Triangles.
    pub triangles: usize,
    /// Parts that can be painted apart.
    pub parts: usize,
    /// Lights.
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
    /// Distance to the focus plane, scene units; none for infinity.
    pub focus_distance: Option<f64>,
    /// Where the lens comes from.
    pub lens: String,
    /// Seconds for the hierarchy over the triangles, which no measurement includes.
    pub prepare_seconds: f64,
    /// Bytes of the hierarchy.
    pub hierarchy_bytes: usize,
    /// How it is focused.
    pub focuses: Vec<FocusSummary>,
    /// What the live preview showed of it; empty where it was not watched.
    pub live: Vec<ShownPicture>,
    /// How its photographs tell those that are left out; none where there are too few.
    pub photographs: Option<Photographs>,
    /// What the views of a light field tell; none of others.
    pub views: Option<Views>,
    /// How far its light at once is off; none where no light is found.
    pub light: Option<RefinedLight>,
    /// What was modelled of it.
    pub modelled: ModelledScene,
    /// What is odd but does no harm.
    pub warnings: Vec<String>,
}

/// A focus of a scene.
#[derive(Clone, Debug, Serialize)]
pub struct FocusSummary {
    /// Its name.
    pub name: String,
    /// What it does.
    pub what: String,
    /// Its reference.
    pub reference: Reference,
    /// The reference's picture.
    #[serde(skip)]
    pub picture: PathBuf,
}

/// A reference and the picture it is of, as kept.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// How far off it is.
    pub error: ReferenceError,
    /// The circles of confusion that half, 90 % and 99 % of the pixels with a surface stay below, px.
    pub circles_px: [f64; 3],
}

/// What was modelled of a scene under the standard lens, and what the saving cost.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModelledScene {
    /// Texels, samples, bytes.
    pub modelled: Modelled,
    /// The tolerance that it was baked with, px.
    pub tolerance_px: f64,
    /// PSNR of its picture against that of the finest light field, whose samples are not packed, dB.
    pub saving_psnr: f64,
    /// Mean FLIP between the two.
    pub saving_flip: f64,
    /// Bytes of the finest light field.
    pub finest_bytes: usize,
}
