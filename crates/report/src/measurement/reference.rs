//! The reference of a picture, with an estimate of its error.
//!
//! Half of the rays are traced with one scramble, half with another. The mean of the two pictures is the
//! reference; their difference gives its error. If A and B are independent estimates of the same mean with
//! variance σ² each,
//!
//! ```text
//! E[(A − B)²] = 2σ²        Var[(A + B)/2] = σ²/2 = E[(A − B)²]/4
//! ```
//!
//! regardless of the distribution of samples within each half. (The ray tracer's own standard error is too
//! large for low-discrepancy samples, which are more evenly distributed together than pass by pass.)

use super::contender::Shot;
use lens::{Exposure, Picture};
use light::Steps;
use project::{LinearPicture, compare};
use render::{RenderOptions, Renderer, render};
use serde::{Deserialize, Serialize};
use session::SessionError;
use trace::truth::TruthOptions;

/// Scrambles of the two halves.
const SEEDS: [u32; 2] = [0x5eed_0001, 0x5eed_0002];

/// The expected error of a reference.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReferenceError {
    /// Rays per pixel.
    pub spp: u32,
    /// Seconds taken.
    pub seconds: f64,
    /// Its expected root mean square error on values clipped to [0, 1].
    pub rmse: f64,
    /// The same as PSNR, dB; 200 without error.
    pub psnr: f64,
}

/// Traces the reference of a picture with `spp` samples per pixel. Returns it with its error.
///
/// # Errors
/// Tracing is cancelled.
pub fn trace_reference(
    shot: Shot<'_>,
    spp: u32,
    steps: &dyn Steps,
) -> Result<(LinearPicture, ReferenceError), SessionError> {
    let start = std::time::Instant::now();
    let half_spp = (spp / 2).max(1);
    let half = |seed| {
        let options = RenderOptions {
            renderer: Renderer::Truth,
            truth: TruthOptions { samples_per_pixel: half_spp, seed, ..TruthOptions::default() },
            ..RenderOptions::default()
        };
        Ok::<_, SessionError>(render(shot.lit, shot.camera, shot.focus, &options, steps)?.picture)
    };
    let [a, b] = [half(SEEDS[0])?, half(SEEDS[1])?].map(|half| conserved_picture(&half));
    let rmse = compare(&a, &b)?.rmse / 2.0;
    let mean = |(a, b): (&[f32; 3], &[f32; 3])| [0, 1, 2].map(|k| (a[k] + b[k]) / 2.0);
    let rgb = a.rgb.iter().zip(&b.rgb).map(mean).collect();
    let error = ReferenceError {
        spp: 2 * half_spp,
        seconds: start.elapsed().as_secs_f64(),
        rmse,
        psnr: numerics::psnr(rmse * rmse),
    };
    Ok((LinearPicture { width: a.width, height: a.height, rgb, ..LinearPicture::default() }, error))
}

/// A picture with the exposure used for error measurements.
pub fn conserved_picture(picture: &Picture) -> LinearPicture {
    LinearPicture::from_picture(picture, Exposure::Conserve)
}
