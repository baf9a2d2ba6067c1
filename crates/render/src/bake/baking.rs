//! Baking light fields, as coarse as the picture allows.

use crate::error::RenderError;
use focus::Focus;
use graphics_card::Gpu;
use lens::Camera;
use light::{LightQuality, LitScene, Steps};
use salf::{BakeOptions, BakedOn, Salf};
use sight_on_card::CardSight;
use std::sync::Arc;
use trace::SightDevice;

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
    bake_with(lit, camera, &options, LightQuality::Fine, None, steps)
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
    let options = BakeOptions { tolerance_px, packs: false, ..margin };
    bake_with(lit, camera, &options, LightQuality::Fine, None, steps)
}

/// Bakes a light field with explicit options and light quality, on a graphics card if one is given, and reports outliers as a notice.
pub(crate) fn bake_with(
    lit: &Arc<LitScene>,
    camera: &Camera,
    options: &BakeOptions,
    quality: LightQuality,
    bake_on: Option<&Gpu>,
    steps: &dyn Steps,
) -> Result<Salf, RenderError> {
    let light = lit.solve(camera, quality, &*steps.begin("light"))?;
    let sight = bake_on.cloned().map(CardSight::new);
    let device = sight.as_ref().map(|sight| sight as &dyn SightDevice);
    let (salf, outliers) =
        salf::bake_on(device, lit.tracer(), &*light, camera, options, &*steps.begin("baking"))?;
    if let Some(gpu) = bake_on {
        if let Some(reason) = gpu.why_lost() {
            let reason = reason.lines().next().unwrap_or_default();
            let what = "the processor baked the rest of the light field";
            steps.notice(&format!("{} was lost ({reason}): {what}", gpu.name()));
        } else if salf.baked_on == BakedOn::Processor && camera.aperture_radius > 0.0 {
            steps.notice(&format!(
                "the scene does not fit {}: the processor baked the light field",
                gpu.name()
            ));
        }
    }
    if outliers.samples > 0 {
        let (samples, percent) = (outliers.samples, 100.0 * outliers.share());
        steps.notice(&format!(
            "{samples} samples received far more light than their neighbours: {percent:.2} % of all light was redistributed among the neighbours"
        ));
    }
    Ok(salf)
}
