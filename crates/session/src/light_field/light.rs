//! The light that light fields are baked from: the one place that chooses where radiance comes from.

use super::kept_light::{self, LightQuality};
use glam::DVec3;
use lens::Camera;
use progress::{Cancelled, Progress};
use scene::World;
use slf::Transport;
use std::sync::Arc;
use trace::Tracer;

/// Paths and lights of a point of the light field, where irradiance is known: a sample has several points.
const PATHS: u32 = 2;
const LIGHT_SAMPLES: u32 = 16;

/// Lights of a point of a picture that is soon replaced.
const ROUGH_LIGHT_SAMPLES: u32 = 4;

/// The light that leaves the scene in `tracer`, for a camera. The first time for a scene and its world its irradiance is solved for,
/// which `progress` watches; it is kept for every camera.
pub(crate) fn light(
    tracer: &Arc<Tracer>,
    camera: &Camera,
    quality: LightQuality,
    progress: &dyn Progress,
) -> Result<Transport, Cancelled> {
    let light_samples = if quality == LightQuality::Rough { ROUGH_LIGHT_SAMPLES } else { LIGHT_SAMPLES };
    let transport = transport(tracer, camera, PATHS, light_samples);
    if !needs_light(tracer) {
        return Ok(transport);
    }
    let irradiance = kept_light::wait(tracer, &world(tracer, camera), quality, progress)?;
    Ok(transport.with_irradiance(irradiance))
}

/// The same as far as it is known at once: without irradiance, where that is not solved for yet, it is exact and noisy.
pub(crate) fn light_at_once(tracer: &Arc<Tracer>, camera: &Camera) -> Transport {
    let transport = transport(tracer, camera, PATHS, LIGHT_SAMPLES);
    match kept_light::known(tracer, &world(tracer, camera)) {
        Some(irradiance) => transport.with_irradiance(irradiance),
        None => transport,
    }
}

/// Light for the ground truth: whole paths, nothing known. It shades many points a pixel: a path each is enough.
pub(crate) fn light_for_many_points(tracer: &Arc<Tracer>, camera: &Camera) -> Transport {
    transport(tracer, camera, 1, LIGHT_SAMPLES)
}

/// Whether any surface scatters light at all.
fn needs_light(tracer: &Tracer) -> bool {
    let scene = tracer.scene();
    scene.parts.iter().any(|part| !scene.materials[part.material as usize].unlit)
}

fn world(tracer: &Tracer, camera: &Camera) -> World {
    let background = camera.background.map(|background| DVec3::from_array(background).as_vec3());
    World::of_scene(tracer.scene(), background)
}

fn transport(tracer: &Arc<Tracer>, camera: &Camera, paths: u32, light_samples: u32) -> Transport {
    kept_light::unknown(tracer, world(tracer, camera), paths, light_samples)
}
