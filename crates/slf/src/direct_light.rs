//! Unlit and emissive surfaces, and Lambert under direct light with shadows.

use crate::emitters::Emitters;
use crate::punctual::arrival;
use glam::{DVec3, Vec3};
use scene::{LightKind, SurfacePoint};
use std::f32::consts::FRAC_1_PI;
use std::sync::Arc;
use trace::{Radiance, Tracer};

/// How direct light is gathered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DirectLightOptions {
    /// Shadow rays a shaded point toward emissive surfaces. Their noise is that of the picture where each
    /// surface point is shaded once; where many points fall into a pixel, as in the ground truth, fewer will
    /// do.
    pub emitter_samples: u32,
}

impl Default for DirectLightOptions {
    fn default() -> Self {
        Self { emitter_samples: 32 }
    }
}

/// Radiance of unlit, emissive and diffuse surfaces.
///
/// | surface | radiance |
/// | --- | --- |
/// | unlit | its base colour, on both sides |
/// | emissive | the emitted radiance, on the front; on both sides if double sided |
/// | any but unlit | + albedo/π · Σ irradiance · cosθ, on both sides |
///
/// The sum runs over the punctual lights and the emissive surfaces, each with a shadow ray; ambient light
/// adds albedo × its radiance. Light reflected more than once is not in it, nor is gloss: a metal's base
/// colour, which glTF makes the colour of its reflection, stands in as its albedo, so that metals are not
/// black. cosθ is that of the shading normal, on the side of the surface that faces the eye; light from the
/// other side of the surface itself does not count.
pub struct DirectLight {
    tracer: Arc<Tracer>,
    background: Vec3,
    options: DirectLightOptions,
    emitters: Emitters,
    /// The sum of the ambient lights.
    ambient: Vec3,
    /// Longer than the scene is wide.
    beyond: f64,
}

impl DirectLight {
    /// Prepares the scene in `tracer`; `background` is the radiance where no surface is.
    pub fn new(tracer: Arc<Tracer>, background: Vec3) -> Self {
        Self::with_options(tracer, background, DirectLightOptions::default())
    }

    /// The same, with options.
    pub fn with_options(tracer: Arc<Tracer>, background: Vec3, options: DirectLightOptions) -> Self {
        let scene = tracer.scene();
        let emitters = Emitters::of(scene);
        let ambient = scene.lights.iter().filter(|light| light.kind == LightKind::Ambient);
        let ambient = ambient.map(|light| light.intensity).sum();
        let (low, high) = scene.bounds();
        let beyond = 2.0 * (high - low).length();
        Self { tracer, background, options, emitters, ambient, beyond }
    }

    /// Irradiance at a point, seen by a surface with this geometric and shading normal.
    fn irradiance(&self, point: SurfacePoint, geometric: DVec3, shading: DVec3) -> Vec3 {
        let scene = self.tracer.scene();
        let position = point.position(scene);
        let cosine =
            |from: DVec3| if geometric.dot(from) > 0.0 { shading.dot(from).max(0.0) as f32 } else { 0.0 };
        let lit = |irradiance: Vec3, from: DVec3, source: DVec3| {
            let irradiance = irradiance * cosine(from);
            if irradiance == Vec3::ZERO || self.tracer.occluded(point, source) {
                Vec3::ZERO
            } else {
                irradiance
            }
        };
        let arrivals = scene.lights.iter().filter_map(|light| arrival(light, position, self.beyond));
        let punctual: Vec3 = arrivals.map(|light| lit(light.irradiance, light.from, light.source)).sum();
        if self.emitters.is_empty() || self.options.emitter_samples == 0 {
            return punctual;
        }
        let samples = self.emitters.samples(scene, point, self.options.emitter_samples);
        let emitted: Vec3 = samples.map(|sample| lit(sample.irradiance, sample.from, sample.position)).sum();
        punctual + emitted / self.options.emitter_samples as f32
    }
}

impl Radiance for DirectLight {
    fn toward(&self, point: SurfacePoint, eye: DVec3) -> Vec3 {
        let scene = self.tracer.scene();
        let material = scene.material_of(point.triangle);
        if material.unlit {
            return scene.emitted(point);
        }
        let geometric = scene.area_normal(point.triangle).normalize_or_zero();
        let is_front = geometric.dot(eye - point.position(scene)) >= 0.0;
        let side = if is_front { 1.0 } else { -1.0 };
        let emitted = if is_front || material.double_sided { scene.emitted(point) } else { Vec3::ZERO };
        let albedo = scene.base_color(point).truncate();
        if albedo == Vec3::ZERO {
            return emitted;
        }
        let irradiance = self.irradiance(point, side * geometric, side * scene.shading_normal(point));
        emitted + albedo * (irradiance * FRAC_1_PI + self.ambient)
    }

    fn from_infinity(&self, _direction: DVec3) -> Vec3 {
        self.background
    }
}

#[cfg(test)]
mod tests;
