//! A rectangle of the picture, checked against the ground truth.

use crate::preview::{Preview, PreviewKind, Quality};
use lens::{Camera, Exposure};
use project::{LinearPicture, ProjectError, compare};
use std::sync::Arc;
use trace::truth::{Estimate, Region};

/// The ground truth of a rectangle of the preview, as far as it is traced.
#[derive(Clone, Debug)]
pub struct Verification {
    /// Which pixels of the preview.
    pub region: Region,
    /// The preview's camera.
    pub camera: Camera,
    /// What is known so far; none before the first pass.
    pub estimate: Option<Arc<Estimate>>,
    /// Rays a pixel that are wanted.
    pub target_samples: u32,
    /// The document's revision that is traced.
    pub(crate) revision: u64,
    /// Counts verifications.
    pub(crate) number: u64,
}

/// How far the preview is from the ground truth in a verified rectangle.
#[derive(Clone, Debug)]
pub struct VerifiedError {
    /// Peak signal-to-noise ratio of the preview against the rays, dB.
    pub psnr: f64,
    /// Mean of preview − truth over the mean of truth.
    pub signed_mean_error: f64,
    /// The PSNR that the rays' own noise would give an exact picture, dB; no more can be told yet.
    pub noise_psnr: f64,
    /// Where they differ: FLIP in false colours, 8-bit sRGB, interleaved, row 0 on top.
    pub map: Vec<u8>,
}

impl Verification {
    /// How far a preview is from what is known; none where the preview shows something else, or is a quick one.
    pub fn error_of(
        &self,
        preview: &Preview,
        exposure: Exposure,
    ) -> Option<Result<VerifiedError, ProjectError>> {
        let estimate = self.estimate.as_ref()?;
        let is_same = preview.kind != PreviewKind::Pinhole
            && preview.quality > Quality::Coarse
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
