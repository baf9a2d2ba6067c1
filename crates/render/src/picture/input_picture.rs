//! Rendering what was opened: a scene, a project or a baked light field.

use crate::bake::is_compatible;
use crate::error::RenderError;
use crate::picture::render::{RenderOptions, Rendered, render};
use document::Input;
use focus::Focus;
use lens::Camera;
use light::{LitScene, Steps};
use salf::BakeOptions;
use std::sync::Arc;
use std::time::Instant;

/// Renders an input: a scene, a project, or a light field (if the renderer draws from one).
///
/// # Errors
/// The camera is invalid, or incompatible with the light field; otherwise as [`render`].
pub fn render_input(
    input: &Input,
    camera: &Camera,
    focus: &Focus,
    options: &RenderOptions,
    steps: &dyn Steps,
) -> Result<Rendered, RenderError> {
    let start = Instant::now();
    let lit = lit_scene_of(input, camera)?;
    let prepare_seconds = start.elapsed().as_secs_f64();
    let mut rendered = render_lit_input(input, &lit, camera, focus, options, steps)?;
    rendered.cost.prepare_seconds = prepare_seconds;
    Ok(rendered)
}

/// Renders an input whose lit scene ([`Input::lit_scene`]) is at hand, which serves any number of pictures.
///
/// # Errors
/// As [`render_input`].
pub fn render_lit_input(
    input: &Input,
    lit: &Arc<LitScene>,
    camera: &Camera,
    focus: &Focus,
    options: &RenderOptions,
    steps: &dyn Steps,
) -> Result<Rendered, RenderError> {
    check_camera(input, camera)?;
    let Some(salf) = input.salf.as_ref().filter(|_| options.renderer.draws_light_field()) else {
        return render(lit, camera, focus, options, steps);
    };
    if let Some(difference) = incompatibility(&salf.camera, camera) {
        let what = format!("it was baked {difference} (bake it again for this camera)");
        return Err(RenderError::bad_file(&input.path, what));
    }
    let mut rendered = options.sum_light_field(salf.clone(), lit, camera, focus, steps)?;
    let needed = BakeOptions::for_focus(lit.tracer(), camera, focus).margin_px;
    if needed > salf.margin_px as f64 {
        rendered.warnings.push(format!(
            "{}: paint spreads light from {needed:.0} px outside the frame, but only {} px were baked (bake it with --focus)",
            input.path.display(),
            salf.margin_px
        ));
    }
    Ok(rendered)
}

/// The lit scene of `input`, after checking that `camera` is valid.
pub(crate) fn lit_scene_of(input: &Input, camera: &Camera) -> Result<Arc<LitScene>, RenderError> {
    check_camera(input, camera)?;
    Ok(input.lit_scene()?)
}

fn check_camera(input: &Input, camera: &Camera) -> Result<(), RenderError> {
    camera.validate().map_err(|error| RenderError::bad_file(&input.path, error))
}

/// Why a light field of `baked` cannot show `camera`; `None` if it can.
fn incompatibility(baked: &Camera, camera: &Camera) -> Option<String> {
    if is_compatible(baked, camera) {
        return None;
    }
    Some(if (baked.width, baked.height) != (camera.width, camera.height) {
        format!("for {} × {} px, not {} × {}", baked.width, baked.height, camera.width, camera.height)
    } else if camera.aperture_radius > baked.aperture_radius {
        format!("for an aperture radius of {}, not {}", baked.aperture_radius, camera.aperture_radius)
    } else {
        "for another pose, angle of view, sensor or background".into()
    })
}
