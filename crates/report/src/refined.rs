//! How far the light at once is off, as light that is refined tells it.

use crate::reference::conserved_picture;
use focus::Focus;
use lens::Camera;
use project::{LinearPicture, compare};
use serde::{Deserialize, Serialize};
use session::{LightErrors, LightQuality, RenderOptions, SessionError, Steps, render};
use std::sync::Arc;
use trace::Tracer;

/// The light at once against refined light.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RefinedLight {
    /// Passes of the latter.
    pub passes: u32,
    /// PSNR of the light at once against what passes come to in the end, dB.
    pub at_once_psnr: f64,
    /// PSNR of these passes against that, dB: their noise.
    pub noise_psnr: f64,
    /// How much brighter the light at once is in the mean.
    pub at_once_mean: f64,
    /// Seconds for light field and picture: at once, and refined.
    pub seconds: [f64; 2],
}

impl RefinedLight {
    /// What passes, and a quarter of them, tell of a picture.
    pub fn measure(
        tracer: &Arc<Tracer>,
        camera: &Camera,
        focus: &Focus,
        passes: u32,
        steps: &dyn Steps,
    ) -> Result<Self, SessionError> {
        let draw_with = |light: LightQuality| -> Result<(LinearPicture, f64), SessionError> {
            let options = RenderOptions { light, ..RenderOptions::default() };
            let rendered = render(tracer, camera, focus, &options, steps)?;
            Ok((
                conserved_picture(&rendered.picture),
                rendered.cost.bake_seconds + rendered.cost.picture_seconds,
            ))
        };
        let (at_once, seconds_at_once) = draw_with(LightQuality::Fine)?;
        let (last, _) = draw_with(LightQuality::Refined { passes: passes / 4 })?;
        let (refined, seconds) = draw_with(LightQuality::Refined { passes })?;
        let square = |picture: &LinearPicture| -> Result<_, SessionError> {
            let errors = compare(picture, &refined)?;
            Ok((10f64.powf(-errors.psnr / 10.0), errors.signed_mean_error))
        };
        let (from_last, _) = square(&last)?;
        let (from_standing, at_once_mean) = square(&at_once)?;
        let errors = LightErrors::from_mean_squares(from_last, from_standing);
        Ok(Self {
            passes,
            at_once_psnr: project::psnr(errors.displayed),
            noise_psnr: project::psnr(errors.refined),
            at_once_mean,
            seconds: [seconds_at_once, seconds],
        })
    }

    /// In a sentence.
    pub fn sentence(&self) -> String {
        let Self { passes, at_once_psnr, noise_psnr, at_once_mean, seconds: [at_once, refined] } = *self;
        // What is smaller than the noise is not known.
        let off = if at_once_psnr > noise_psnr {
            "nearer than their noise tells to".into()
        } else {
            format!("{at_once_psnr:.1} dB from")
        };
        format!(
            "The light at once ({at_once:.1} s) is {off} what passes of paths come to in the end, {:+.2} % in the mean; \
             {passes} passes ({refined:.1} s) have {noise_psnr:.1} dB of noise left.",
            100.0 * at_once_mean
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_less_than_the_noise_is_not_told() {
        let light = |at_once_psnr| RefinedLight {
            passes: 64,
            at_once_psnr,
            noise_psnr: 48.0,
            at_once_mean: -0.005,
            seconds: [0.5, 20.0],
        };
        assert!(light(46.9).sentence().contains("is 46.9 dB from"), "{}", light(46.9).sentence());
        let unknown = light(55.0).sentence();
        assert!(!unknown.contains("55") && unknown.contains("-0.50 %"), "{unknown}");
    }
}
