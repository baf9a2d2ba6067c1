//! The light of a capture's photographs, and which pixels show what was photographed.

use crate::error::RenderError;
use crate::picture::pixel_ray::pixel_ray;
use lens::Camera;
use light::{LitScene, Steps};
use rayon::prelude::*;
use scene::SurfacePoint;
use slf::PhotographLight;
use std::sync::Arc;
use trace::Tracer;

/// The light of a capture's photographs. `None` for a surface that was made from a picture (its texture holds the light) and for scenes
/// without photographs.
///
/// # Errors
/// Photographs cannot be read, or the work was cancelled.
pub fn light_of_photographs(
    lit: &Arc<LitScene>,
    steps: &dyn Steps,
) -> Result<Option<Arc<PhotographLight>>, RenderError> {
    if lit.scene().picture.is_some() {
        return Ok(None);
    }
    let Some(light) = lit.photograph_light(&*steps.begin("light"))? else { return Ok(None) };
    if let Some(sentence) = alignment_message(&light.max_displacements_px()) {
        steps.notice(&sentence);
    }
    Ok(Some(light))
}

/// A message about photographs that were aligned; `None` if there are none.
fn alignment_message(moved_px: &[f64]) -> Option<String> {
    let count = moved_px.iter().filter(|&&px| px > 0.0).count();
    let most = moved_px.iter().copied().fold(0.0, f64::max);
    let all = moved_px.len();
    (count > 0).then(|| {
        format!("{count} of {all} photographs were misaligned by up to {most:.1} px and have been aligned with the others")
    })
}

/// The share of the surface along each pixel's chief ray that was photographed: in the photographs of `light`, or else in the picture that
/// the surface was made from.
pub(crate) fn photographed_shares(
    tracer: &Tracer,
    camera: &Camera,
    light: Option<&PhotographLight>,
) -> Vec<f32> {
    photographed_shares_of_pixels(tracer, camera, light, (0..camera.width * camera.height).collect())
}

/// [`photographed_shares`] of selected pixels.
pub(crate) fn photographed_shares_of_pixels(
    tracer: &Tracer,
    camera: &Camera,
    light: Option<&PhotographLight>,
    pixels: Vec<u32>,
) -> Vec<f32> {
    let share_at = |point: SurfacePoint| match light {
        Some(light) => light.observed_share(point),
        None => tracer.scene().photographed_share(point).unwrap_or(0.0),
    };
    let of_pixel = |number: u32| {
        let hit = tracer.first_hit(&pixel_ray(camera, number));
        hit.map_or(0.0, |hit| share_at(hit.point))
    };
    pixels.into_par_iter().map(of_pixel).collect()
}
