//! The light that light fields are baked from: the one place that chooses where radiance comes from.

use glam::DVec3;
use lens::Camera;
use slf::{DirectLight, DirectLightOptions};
use std::sync::Arc;
use trace::Tracer;

/// The light that leaves the scene in `tracer`, for a camera.
pub(crate) fn light(tracer: &Arc<Tracer>, camera: &Camera) -> DirectLight {
    DirectLight::new(tracer.clone(), DVec3::from_array(camera.background).as_vec3())
}

/// Light for the ground truth, which shades many points a pixel: a few shadow rays each are enough.
pub(crate) fn light_for_many_points(tracer: &Arc<Tracer>, camera: &Camera) -> DirectLight {
    let background = DVec3::from_array(camera.background).as_vec3();
    DirectLight::with_options(tracer.clone(), background, DirectLightOptions { emitter_samples: 2 })
}
