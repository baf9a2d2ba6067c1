//! Light fields, baked as coarse as a picture allows.

use crate::error::RenderError;
use focus::Focus;
use lens::Camera;
use light::{LightQuality, LitScene, Steps};
use salf::{BakeOptions, Salf};
use std::sync::Arc;

/// Bakes the light field that `camera` needs to show `focus`, as coarse as `tolerance_px` allows.
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

/// The same light field with samples as they were found, not packed: what the saving is measured against.
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

/// The same with these options, and light as well as that.
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
            "{samples} samples found far more light than those around them: {percent:.2} % of all light was spread among these"
        ));
    }
    Ok(salf)
}
