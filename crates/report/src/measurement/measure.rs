//! A single measurement: a contender draws a setting, and the picture is compared with the reference.

use super::band::OutlineBand;
use super::contender::{Contender, Shot};
use super::memory::PeakMemory;
use super::record::{Record, Series};
use super::reference::{ReferenceError, conserved_picture};
use light::Steps;
use project::{LinearPicture, compare};
use session::SessionError;

/// What the picture of a contender is compared with.
pub struct Comparison<'a> {
    /// The reference.
    pub picture: &'a LinearPicture,
    /// Its own error.
    pub error: ReferenceError,
    /// The 99th percentile of the circle of confusion over the pixels with a surface, px.
    pub coc_px: f64,
    /// The band of pixels near outlines.
    pub band: OutlineBand,
}

/// Names of what is measured.
pub struct MeasurementNames<'a> {
    /// The scene.
    pub scene: &'a str,
    /// The focus.
    pub focus: &'a str,
    /// The series that the measurement belongs to.
    pub series: Series,
}

/// Measures a contender. Returns the record and the picture.
///
/// # Errors
/// Rendering fails or is cancelled, or the pictures cannot be compared.
pub fn measure(
    contender: Contender,
    shot: Shot<'_>,
    comparison: &Comparison<'_>,
    names: &MeasurementNames<'_>,
    steps: &dyn Steps,
) -> Result<(Record, LinearPicture), SessionError> {
    let memory = PeakMemory::watch();
    let drawn = contender.draw(shot, steps)?;
    let peak_bytes = memory.peak_increase_bytes();
    let picture = conserved_picture(&drawn.picture);
    let errors = compare(&picture, comparison.picture)?;
    let record = Record {
        scene: names.scene.into(),
        focus: names.focus.into(),
        renderer: contender.renderer().into(),
        knob: contender.knob_name().into(),
        value: contender.knob_value(),
        seconds: drawn.bake_seconds.unwrap_or(0.0) + drawn.picture_seconds,
        bytes: drawn.bytes as u64,
        rmse: errors.rmse,
        relmse: errors.rel_mse,
        psnr: errors.psnr,
        flip: errors.flip,
        mean_error: errors.signed_mean_error,
        band_psnr: comparison.band.psnr(&picture.rgb, &comparison.picture.rgb),
        reference_psnr: comparison.error.psnr,
        series: names.series,
        width: shot.camera.width,
        height: shot.camera.height,
        aperture_radius: shot.camera.aperture_radius,
        coc_px: comparison.coc_px,
        triangles: shot.lit.scene().triangles.len() as u64,
        threads: rayon::current_num_threads() as u32,
        backend: "cpu".into(),
        bake_seconds: drawn.bake_seconds,
        picture_seconds: drawn.picture_seconds,
        repeats: drawn.repeats,
        peak_bytes,
        samples: drawn.samples.map(|samples| samples as u64),
        rmse_unclipped: errors.rmse_unclipped,
        reference_rmse: comparison.error.rmse,
    };
    Ok((record, picture))
}
