//! One measurement: a contender draws a setting and is compared with the reference.

use crate::band::Band;
use crate::contender::{Contender, Shot};
use crate::memory::PeakMemory;
use crate::record::{Record, Series};
use crate::reference::{ReferenceError, conserved};
use project::{LinearPicture, compare};
use session::{SessionError, Steps};

/// What a contender's picture is compared with.
pub struct Against<'a> {
    /// The reference.
    pub picture: &'a LinearPicture,
    /// How far off it is.
    pub error: ReferenceError,
    /// The circle of confusion that 99 % of the pixels with a surface stay below, px.
    pub coc_px: f64,
    /// The pixels beside outlines.
    pub band: Band,
}

/// Names of what is measured.
pub struct Named<'a> {
    /// The scene.
    pub scene: &'a str,
    /// The focus.
    pub focus: &'a str,
    /// What it is part of.
    pub series: Series,
}

/// Measures a contender. Returns its picture too.
pub fn measure(
    contender: Contender,
    shot: Shot<'_>,
    against: &Against<'_>,
    named: &Named<'_>,
    steps: &dyn Steps,
) -> Result<(Record, LinearPicture), SessionError> {
    let memory = PeakMemory::watch();
    let drawn = contender.draw(shot, steps)?;
    let peak_bytes = memory.taken();
    let picture = conserved(&drawn.picture);
    let found = compare(&picture, against.picture)?;
    let record = Record {
        scene: named.scene.into(),
        focus: named.focus.into(),
        renderer: contender.renderer().into(),
        knob: contender.knob().into(),
        value: contender.value(),
        seconds: drawn.bake_seconds.unwrap_or(0.0) + drawn.picture_seconds,
        bytes: drawn.bytes as u64,
        rmse: found.rmse,
        relmse: found.rel_mse,
        psnr: found.psnr,
        flip: found.flip,
        mean_error: found.signed_mean_error,
        band_psnr: against.band.psnr(&picture.rgb, &against.picture.rgb),
        reference_psnr: against.error.psnr,
        series: named.series,
        width: shot.camera.width,
        height: shot.camera.height,
        aperture_radius: shot.camera.aperture_radius,
        coc_px: against.coc_px,
        triangles: shot.tracer.scene().triangles.len() as u64,
        threads: rayon::current_num_threads() as u32,
        backend: "cpu".into(),
        bake_seconds: drawn.bake_seconds,
        picture_seconds: drawn.picture_seconds,
        repeats: drawn.repeats,
        peak_bytes,
        samples: drawn.samples.map(|samples| samples as u64),
        rmse_unclipped: found.rmse_unclipped,
        reference_rmse: against.error.rmse,
    };
    Ok((record, picture))
}
