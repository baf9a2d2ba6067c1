//! Baking light fields, as coarse as the picture allows.

use crate::error::RenderError;
use focus::Focus;
use lens::Camera;
use light::{LightQuality, LitScene, Steps};
use salf::{BakeOptions, Salf};
use std::sync::Arc;

/// Bakes the light field that `camera` needs to show `focus`, as coarse as `tolerance_px` (pixels) allows.
///
/// # Errors
/// The scene's light cannot be solved, or the work was cancelled.
pub fn bake(
    lit: &Arc<LitScene>,
    camera: &Camera,
    focus: &Focus,
    tolerance_px: f64,
    steps: &dyn Steps,
) -> Result<Salf, RenderError> {
    let options = BakeOptions { tolerance_px, ..BakeOptions::for_focus(lit.tracer(), camera, focus) };
    bake_with(lit, camera, &options, LightQuality::Fine, steps)
}

/// Bakes the light field of [`bake`] without packing its samples. Used to measure what packing saves.
///
/// # Errors
/// As [`bake`].
pub fn bake_unpacked(
    lit: &Arc<LitScene>,
    camera: &Camera,
    focus: &Focus,
    tolerance_px: f64,
    steps: &dyn Steps,
) -> Result<Salf, RenderError> {
    let margin = BakeOptions::for_focus(lit.tracer(), camera, focus);
    bake_with(lit, camera, &BakeOptions { tolerance_px, packs: false, ..margin }, LightQuality::Fine, steps)
}

/// Bakes a light field with explicit options and light quality, and reports outliers as a notice.
pub(crate) fn bake_with(
    lit: &Arc<LitScene>,
    camera: &Camera,
    options: &BakeOptions,
    quality: LightQuality,
    steps: &dyn Steps,
) -> Result<Salf, RenderError> {
    let light = lit.solve(camera, quality, &*steps.begin("light"))?;
    let (salf, outliers) =
        salf::bake_with_outliers(lit.tracer(), &*light, camera, options, &*steps.begin("baking"))?;
    if outliers.samples > 0 {
        let (samples, percent) = (outliers.samples, 100.0 * outliers.share());
        steps.notice(&format!(
            "{samples} samples received far more light than their neighbours: {percent:.2} % of all light was redistributed among the neighbours"
        ));
    }
    Ok(salf)
}
