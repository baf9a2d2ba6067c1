//! Verifying a rectangle of the picture against the ground truth.

use crate::preview::{Preview, Quality};
use lens::{Camera, Exposure};
use project::{LinearPicture, ProjectError, compare};
use std::sync::Arc;
use trace::truth::{Estimate, Region};

/// The ground truth of a rectangle of the preview, as far as it has been traced.
#[derive(Clone, Debug)]
pub struct Verification {
    /// The pixels of the preview.
    pub region: Region,
    /// The preview's camera.
    pub camera: Camera,
    /// The estimate so far; `None` before the first pass.
    pub estimate: Option<Arc<Estimate>>,
    /// Target number of rays per pixel.
    pub target_samples: u32,
    /// Revision of the document that is traced.
    pub(crate) revision: u64,
    /// Number of this verification in the session.
    pub(crate) number: u64,
}

/// How far the preview is from the ground truth in a verified rectangle.
#[derive(Clone, Debug)]
pub struct VerifiedError {
    /// PSNR of the preview against the ground truth, dB.
    pub psnr: f64,
    /// Mean of (preview − truth), divided by the mean of truth.
    pub signed_mean_error: f64,
    /// The PSNR that an exact picture would have because of the ground truth's noise, dB: an upper limit of what can be measured so far.
    pub noise_psnr: f64,
    /// FLIP error map in false colours: 8-bit sRGB, interleaved, top row first.
    pub map: Vec<u8>,
}

impl Verification {
    /// The error of a preview against the estimate. `None` if there is no estimate yet, or the preview shows something else or is coarse.
    ///
    /// # Errors
    /// The pictures cannot be compared.
    pub fn error_of(
        &self,
        preview: &Preview,
        exposure: Exposure,
    ) -> Option<Result<VerifiedError, ProjectError>> {
        let estimate = self.estimate.as_ref()?;
        let is_same = preview.quality > Quality::Coarse
            && preview.picture.size() == [self.camera.width, self.camera.height];
        let shown = if is_same { preview.picture.fetch_region(self.region) } else { None }?;
        let compared = || {
            let truth = LinearPicture::from_picture(&estimate.picture, exposure);
            let splat = LinearPicture::from_picture(&shown, exposure);
            let compared = compare(&splat, &truth)?;
            Ok(VerifiedError {
                psnr: compared.psnr,
                signed_mean_error: compared.signed_mean_error,
                noise_psnr: -20.0 * estimate.expected_rmse(exposure).log10(),
                map: project::false_color_error_map(&splat, &truth)?,
            })
        };
        Some(compared())
    }
}
