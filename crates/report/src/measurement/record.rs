//! A measurement, as written to `report.json` and `report.csv`.

use serde::{Deserialize, Serialize};

/// The series that a measurement belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Series {
    /// Varies a renderer's knob, all else equal.
    Knob,
    /// Varies the aperture: cost against circle of confusion.
    Aperture,
    /// Varies the size of the picture.
    PictureSize,
    /// Subdivides every triangle into four without changing the picture: cost against scene size.
    SceneSize,
}

impl Series {
    /// All of them.
    pub const ALL: [Series; 4] = [Series::Knob, Series::Aperture, Series::PictureSize, Series::SceneSize];
}

/// A renderer's picture measured against a reference. Pictures are compared under the exposure "conserve";
/// `rmse`, `psnr` and `flip` on linear values clipped to [0, 1], `relmse` and `mean_error` not clipped.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// The scene's name.
    pub scene: String,
    /// Name of the focus.
    pub focus: String,
    /// The renderer.
    pub renderer: String,
    /// Name of its knob; empty if it has none.
    pub knob: String,
    /// Value of the knob.
    pub value: f64,
    /// Wall-clock seconds for the picture, including the bake if there is one, but not the ray hierarchy of
    /// the scene.
    pub seconds: f64,
    /// Memory kept for the next picture, bytes: the samples of the light field, the hierarchy over the
    /// triangles, or the pinhole views.
    pub bytes: u64,
    /// Root of the mean square error.
    pub rmse: f64,
    /// Mean of the square error over the square of the reference + 0.01.
    pub relmse: f64,
    /// Peak signal-to-noise ratio, dB; 200 for equal pictures.
    pub psnr: f64,
    /// Mean FLIP, in [0, 1].
    pub flip: f64,
    /// Mean of picture − reference over the mean of the reference.
    pub mean_error: f64,
    /// PSNR of the reference itself by its own error estimate, dB: a higher measured PSNR is not meaningful.
    pub reference_psnr: f64,
    /// PSNR of the pixels within 6 px of an outline, dB; null without outlines.
    pub band_psnr: Option<f64>,

    /// The series it belongs to.
    pub series: Series,
    /// Width, px.
    pub width: u32,
    /// Height, px.
    pub height: u32,
    /// Half the side of the aperture's square, scene units.
    pub aperture_radius: f64,
    /// The 99th percentile of the circle of confusion over the pixels with a surface, px.
    pub coc_px: f64,
    /// Triangles of the scene.
    pub triangles: u64,
    /// Number of threads.
    pub threads: u32,
    /// Device it ran on.
    pub backend: String,
    /// The part of `seconds` spent baking; `None` if nothing is baked.
    pub bake_seconds: Option<f64>,
    /// The part of `seconds` that another focus, f-stop or focus distance takes again: all but the bake.
    pub picture_seconds: f64,
    /// How often the picture was drawn; `picture_seconds` is the median.
    pub repeats: u32,
    /// Peak increase of the process's memory, bytes, if available.
    pub peak_bytes: Option<u64>,
    /// Samples of the light field.
    pub samples: Option<u64>,
    /// Root of the mean square error, not clipped.
    pub rmse_unclipped: f64,
    /// The part of `rmse` expected from the reference's own error.
    pub reference_rmse: f64,
}
