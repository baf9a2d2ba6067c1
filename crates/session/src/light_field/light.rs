//! The light that light fields are baked from: the one place that chooses where radiance comes from.

use super::kept_light::{self, LightQuality};
use super::photographed;
use crate::error::SessionError;
use glam::DVec3;
use lens::Camera;
use progress::Progress;
use scene::World;
use slf::Transport;
use std::sync::Arc;
use trace::{Radiance, Tracer};

/// Light that leaves a scene.
pub(crate) type SceneLight = Arc<dyn Radiance + Send + Sync>;

/// Paths and lights of a point of the light field, where irradiance is known: a sample has several points.
const PATHS: u32 = 2;
const LIGHT_SAMPLES: u32 = 16;

/// Lights of a point of a picture that is soon replaced.
const ROUGH_LIGHT_SAMPLES: u32 = 4;

/// The light that leaves the scene in `tracer`, for a camera: that of its photographs, if it has any. The first time for a scene (and its
/// world) it is found out, which `progress` watches; it is kept for every camera. Rough light of photographs is that of the bare
/// surface as long as theirs is not there.
pub(crate) fn solve_light(
    tracer: &Arc<Tracer>,
    camera: &Camera,
    quality: LightQuality,
    progress: &dyn Progress,
) -> Result<SceneLight, SessionError> {
    if is_photographed(tracer) {
        match (photographed::available_lookup(tracer), quality) {
            (Some(light), _) => return Ok(light),
            (None, LightQuality::Rough) if !photographed::is_on_disk(tracer) => {}
            (None, _) => return photographed::wait_for_lookup(tracer, progress),
        }
    }
    let light_samples = if quality == LightQuality::Rough { ROUGH_LIGHT_SAMPLES } else { LIGHT_SAMPLES };
    let paths = if let LightQuality::Refined { passes } = quality { passes } else { PATHS };
    let transport = transport(tracer, camera, paths, light_samples);
    if !has_lit_surfaces(tracer) {
        return Ok(Arc::new(transport));
    }
    let irradiance = kept_light::wait(tracer, &world(tracer, camera), quality, progress)?;
    Ok(Arc::new(match quality {
        LightQuality::Refined { .. } => transport.with_control_variate(irradiance),
        LightQuality::Rough | LightQuality::Fine => transport.with_irradiance(irradiance),
    }))
}

/// The same as far as it is known at once: without irradiance, where that is not solved for yet, it is exact and noisy.
pub(crate) fn available_light(tracer: &Arc<Tracer>, camera: &Camera) -> SceneLight {
    if is_photographed(tracer)
        && let Some(light) = photographed::available_lookup(tracer)
    {
        return light;
    }
    let transport = transport(tracer, camera, PATHS, LIGHT_SAMPLES);
    Arc::new(match kept_light::available(tracer, &world(tracer, camera)) {
        Some(irradiance) => transport.with_irradiance(irradiance),
        None => transport,
    })
}

/// Light for a first look: of photographs, if theirs was kept from another time; else that of the bare surface, nothing known and
/// nothing begun: exact and noisy.
pub(crate) fn quick_light(tracer: &Arc<Tracer>, camera: &Camera, progress: &dyn Progress) -> SceneLight {
    if is_photographed(tracer)
        && photographed::is_on_disk(tracer)
        && let Ok(light) = photographed::wait_for_lookup(tracer, progress)
    {
        return light;
    }
    Arc::new(transport(tracer, camera, 4 * PATHS, ROUGH_LIGHT_SAMPLES))
}

/// Light for the ground truth: whole paths, nothing known; of photographs what they show. It shades many points a pixel: a path each is
/// enough.
pub(crate) fn ground_truth_light(
    tracer: &Arc<Tracer>,
    camera: &Camera,
    progress: &dyn Progress,
) -> Result<SceneLight, SessionError> {
    if is_photographed(tracer) {
        return photographed::wait_for_lookup(tracer, progress);
    }
    Ok(Arc::new(transport(tracer, camera, 1, LIGHT_SAMPLES)))
}

/// Whether photographs light the scene.
pub(crate) fn is_photographed(tracer: &Tracer) -> bool {
    !tracer.scene().views.is_empty()
}

/// Whether the light of a scene can be refined: there is some, and no photographs tell it.
pub fn can_refine_light(tracer: &Tracer) -> bool {
    !is_photographed(tracer) && has_lit_surfaces(tracer)
}

/// Whether any surface scatters light at all.
fn has_lit_surfaces(tracer: &Tracer) -> bool {
    let scene = tracer.scene();
    scene.parts.iter().any(|part| !scene.materials[part.material as usize].unlit)
}

fn world(tracer: &Tracer, camera: &Camera) -> World {
    let background = camera.background.map(|background| DVec3::from_array(background).as_vec3());
    World::from_scene(tracer.scene(), background)
}

fn transport(tracer: &Arc<Tracer>, camera: &Camera, paths: u32, light_samples: u32) -> Transport {
    kept_light::transport_without_cache(tracer, world(tracer, camera), paths, light_samples)
}
