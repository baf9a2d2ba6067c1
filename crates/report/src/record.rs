//! One measurement, as written to `report.json` and `report.csv`.

use serde::{Deserialize, Serialize};

/// What a measurement is part of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Series {
    /// A renderer's knob is turned, all else equal.
    Knob,
    /// The aperture is opened and closed: cost against circle of confusion.
    Aperture,
    /// The picture grows.
    PictureSize,
    /// Every triangle is cut in four, the picture staying the same: cost against scene size.
    SceneSize,
}

impl Series {
    /// All of them.
    pub const ALL: [Series; 4] = [Series::Knob, Series::Aperture, Series::PictureSize, Series::SceneSize];
}

/// A renderer's picture measured against a reference. Pictures are compared under the exposure "conserve"; `rmse`, `psnr`
/// and `flip` on linear values clipped to [0, 1], `relmse` and `mean_error` not clipped.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// The scene's name.
    pub scene: String,
    /// The focus' name.
    pub focus: String,
    /// What drew the picture.
    pub renderer: String,
    /// What of it was turned; empty where it has no knob.
    pub knob: String,
    /// To what.
    pub value: f64,
    /// Wall-clock seconds for the picture, from a scene that is ready for rays: with the bake, where there is one.
    pub seconds: f64,
    /// Bytes that the renderer keeps to draw the next picture: the light field's samples, the hierarchy over the triangles,
    /// or the pinhole views.
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
    /// PSNR of the reference itself against the exact picture, by its own error estimate, dB: what is measured as better is
    /// not.
    pub reference_psnr: f64,
    /// PSNR of the pixels at most 6 px from an outline, dB; null where there is none.
    pub band_psnr: Option<f64>,

    /// What it is part of.
    pub series: Series,
    /// Columns, px.
    pub width: u32,
    /// Rows, px.
    pub height: u32,
    /// Half the side of the aperture's square, scene units.
    pub aperture_radius: f64,
    /// The circle of confusion that 99 % of the pixels with a surface stay below, px.
    pub coc_px: f64,
    /// Triangles of the scene.
    pub triangles: u64,
    /// Threads that worked.
    pub threads: u32,
    /// Where it ran.
    pub backend: String,
    /// Of `seconds`, those of the bake; none where nothing is baked.
    pub bake_seconds: Option<f64>,
    /// Of `seconds`, those that another focus, f-stop or focus distance takes again: all but the bake.
    pub picture_seconds: f64,
    /// How often the picture was drawn; `picture_seconds` is the median.
    pub repeats: u32,
    /// Memory that the process took more at its peak than before, bytes, where the system tells.
    pub peak_bytes: Option<u64>,
    /// Samples of the light field.
    pub samples: Option<u64>,
    /// Root of the mean square error, not clipped.
    pub rmse_unclipped: f64,
    /// What of `rmse` is to be expected from the reference's own error.
    pub reference_rmse: f64,
}
