//! The error of the cached light, measured against refined light.

use crate::measurement::reference::conserved_picture;
use focus::Focus;
use lens::Camera;
use light::LitScene;
use light::{LightErrors, LightQuality, Steps};
use project::{LinearPicture, compare};
use render::{RenderOptions, render};
use serde::{Deserialize, Serialize};
use session::SessionError;
use std::sync::Arc;

/// The cached light against refined light.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RefinedLight {
    /// Number of passes of the refined light.
    pub passes: u32,
    /// PSNR of the cached light against the limit of the passes, dB.
    pub at_once_psnr: f64,
    /// PSNR of the refined light against that limit, dB: its noise.
    pub noise_psnr: f64,
    /// Relative mean difference of the cached light.
    pub at_once_mean: f64,
    /// Seconds for light field and picture: with cached light, and refined.
    pub seconds: [f64; 2],
}

impl RefinedLight {
    /// Measures a picture with cached light, with `passes` passes and with a quarter of them.
    ///
    /// # Errors
    /// Rendering fails or is cancelled.
    pub fn measure(
        lit: &Arc<LitScene>,
        camera: &Camera,
        focus: &Focus,
        passes: u32,
        steps: &dyn Steps,
    ) -> Result<Self, SessionError> {
        let draw_with = |light: LightQuality| -> Result<(LinearPicture, f64), SessionError> {
            let options = RenderOptions { light, ..RenderOptions::default() };
            let rendered = render(lit, camera, focus, &options, steps)?;
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
            Ok((numerics::mean_square_of_psnr(errors.psnr), errors.signed_mean_error))
        };
        let (from_last, _) = square(&last)?;
        let (from_standing, at_once_mean) = square(&at_once)?;
        let errors = LightErrors::from_mean_squares(from_last, from_standing);
        Ok(Self {
            passes,
            at_once_psnr: numerics::psnr(errors.displayed),
            noise_psnr: numerics::psnr(errors.refined),
            at_once_mean,
            seconds: [seconds_at_once, seconds],
        })
    }

    /// A sentence that describes the result.
    pub fn sentence(&self) -> String {
        let Self { passes, at_once_psnr, noise_psnr, at_once_mean, seconds: [at_once, refined] } = *self;
        // Differences smaller than the noise are not significant.
        let off = if at_once_psnr > noise_psnr {
            "closer than the noise to".into()
        } else {
            format!("{at_once_psnr:.1} dB from")
        };
        format!(
            "The cached light ({at_once:.1} s) is {off} the limit of the refinement passes, {:+.2} % in the mean; \
             {passes} passes ({refined:.1} s) leave noise at {noise_psnr:.1} dB.",
            100.0 * at_once_mean
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_below_the_noise_are_not_reported() {
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
