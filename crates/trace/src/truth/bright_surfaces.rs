//! Samples that bright surfaces send to the aperture themselves.
//!
//! A small lamp, far brighter than white, whose circle of confusion covers thousands of pixels, is found by
//! few of the camera's rays, each of which then carries more than a whole pixel's light: grain that no
//! affordable number of rays removes. So each such triangle also sends rays: from points spread evenly over
//! it, to points of the aperture. A ray P → U that is not stopped lands where the optics say. Both kinds of
//! ray can find the same path, so each takes its share of it (the balance heuristic, Veach and Guibas 1995):
//!
//! ```text
//! either ray brings   L · c/(c + s)
//! c = spp·w           camera's rays a unit of the triangle's area, s = n/A its own
//! w(P, U) = |n·(P − U)| / (z³ tan²θ)   the picture's area for it (times (H/2)² in px)
//! ```
//!
//! which adds up to L·c, what the camera's rays alone would bring on average. (Beyond the guard band the camera
//! sends no rays; there the surface's ray brings it all, L·c/s.) Coverage counts the camera's rays alone.

use super::pixel_samples::{self, LONGEST_SEQUENCE};
use super::sample_ray::SampleRays;
use super::sensor::{Sensor, Sum};
use crate::Radiance;
use glam::{DVec2, DVec3};
use lens::ApertureSampler;
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use scene::SurfacePoint;
use std::f64::consts::PI;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Only triangles brighter than white send rays.
const WHITE: f32 = 1.0;
/// They send so many that each brings at most this share of what a camera's ray brings from a white surface.
const SHARE_OF_WHITE: f64 = 0.25;
/// Rays that all triangles send together, at most: a share of the frame's own.
const SHARE_OF_FRAME: f64 = 0.25;

/// The triangles that send rays.
pub(super) struct BrightSurfaces {
    /// Rays that each triangle of the scene sends; empty if none does.
    rays_of: Vec<u32>,
    samples_per_pixel: f64,
    guard_px: f64,
}

impl BrightSurfaces {
    /// Finds them.
    pub fn find(rays: &SampleRays, radiance: &dyn Radiance, samples: u32, guard_px: i64) -> Self {
        let count = rays.tracer.scene().triangles.len() as u32;
        let found =
            Self { rays_of: Vec::new(), samples_per_pixel: f64::from(samples), guard_px: guard_px as f64 };
        let wanted: Vec<f64> =
            (0..count).into_par_iter().map(|triangle| found.rays_wanted(rays, radiance, triangle)).collect();
        let total: f64 = wanted.iter().sum();
        if total == 0.0 {
            return found;
        }
        let frame = f64::from(rays.camera.width) * f64::from(rays.camera.height) * f64::from(samples);
        let share = (SHARE_OF_FRAME * frame / total).min(1.0);
        Self { rays_of: wanted.into_iter().map(|n| (n * share).ceil() as u32).collect(), ..found }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.rays_of.is_empty()
    }

    /// How many rays a triangle should send: so many that each brings little, but not more than spp a pixel
    /// of the circle of confusion.
    fn rays_wanted(&self, rays: &SampleRays, radiance: &dyn Radiance, triangle: u32) -> f64 {
        let scene = rays.tracer.scene();
        let material = scene.material_of(triangle);
        if !material.emits() || material.may_be_transparent() {
            return 0.0;
        }
        let corners = scene.corners(triangle).map(|corner| rays.camera.camera_from_world(corner));
        if corners.iter().any(|corner| corner.z <= 0.0) {
            return 0.0;
        }
        let eye = rays.camera.position();
        // Looked at in its middle and toward each corner.
        let places =
            [(1.0, 1.0), (0.5, 0.5), (2.0, 0.5), (0.5, 2.0)].map(|(b1, b2)| DVec2::new(b1, b2) / 3.0);
        let look = |barycentric| radiance.toward(SurfacePoint { triangle, barycentric }, eye).max_element();
        let brightest = places.into_iter().map(look).fold(0.0, f32::max);
        if brightest <= WHITE {
            return 0.0;
        }
        let middle = SurfacePoint { triangle, barycentric: DVec2::splat(1.0 / 3.0) };
        let position = (corners[0] + corners[1] + corners[2]) / 3.0;
        let radius = |kappa: f64| rays.optics.splat_radius_px(kappa).abs();
        let kappa = rays.optics.kappa(1.0 / position.z, rays.focus.at(middle));
        let circle = PI * radius(kappa).powi(2) + 1.0;
        // Out of view if the whole triangle, with its widest blur, lies beyond one side of the frame.
        let blur = radius(kappa).max(radius(rays.optics.standard_kappa(1.0 / position.z))) + self.guard_px;
        let pixels = corners.map(|corner| rays.camera.pixel_from_q(rays.optics.chief(corner)));
        let (low, high) = pixels.iter().fold((pixels[0], pixels[0]), |(l, h), p| (l.min(*p), h.max(*p)));
        let size = DVec2::new(f64::from(rays.camera.width), f64::from(rays.camera.height));
        if (low - blur).cmpgt(size).any() || (high + blur).cmplt(DVec2::ZERO).any() {
            return 0.0;
        }
        let doubled_area = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let footprint =
            pixels_by_area(rays, doubled_area, position, DVec2::ZERO) * doubled_area.length() / 2.0;
        (f64::from(brightest) / SHARE_OF_WHITE * footprint).min(circle) * self.samples_per_pixel
    }

    /// The share of a path from a point of a triangle to the aperture point `u` that the camera's ray takes.
    pub fn camera_share(&self, rays: &SampleRays, point: SurfacePoint, u: DVec2) -> f64 {
        let count = self.rays_of.get(point.triangle as usize).copied().unwrap_or(0);
        if count == 0 {
            return 1.0;
        }
        let scene = rays.tracer.scene();
        let normal = rays.camera.camera_direction(scene.area_normal(point.triangle));
        let position = rays.camera.camera_from_world(point.position(scene));
        let camera = self.samples_per_pixel * pixels_by_area(rays, normal, position, u);
        camera / (camera + f64::from(count) / (normal.length() / 2.0))
    }

    /// Sends all rays.
    pub fn shine(
        &self,
        rays: &SampleRays,
        radiance: &dyn Radiance,
        sensor: &Sensor,
        seed: u32,
        progress: &dyn Progress,
    ) -> Result<(), Cancelled> {
        let senders = (0..self.rays_of.len() as u32).filter(|&triangle| self.rays_of[triangle as usize] > 0);
        let batches: Vec<(u32, u32)> = senders
            .flat_map(|triangle| {
                let count = self.rays_of[triangle as usize];
                (0..count.div_ceil(LONGEST_SEQUENCE)).map(move |batch| (triangle, batch))
            })
            .collect();
        let aperture = ApertureSampler::new(&rays.camera.aperture);
        let done = AtomicUsize::new(0);
        batches.par_iter().try_for_each(|&(triangle, batch)| {
            progress.check()?;
            let rest = self.rays_of[triangle as usize] - batch * LONGEST_SEQUENCE;
            for [a, b, c, d] in pixel_samples::points(rest.min(LONGEST_SEQUENCE), [seed, triangle, batch]) {
                let point = SurfacePoint { triangle, barycentric: uniform_barycentric(DVec2::new(c, d)) };
                self.send(rays, radiance, sensor, point, aperture.sample(a, b) * rays.camera.aperture_radius);
            }
            progress.report((done.fetch_add(1, Ordering::Relaxed) + 1) as f32 / batches.len() as f32);
            Ok(())
        })
    }

    /// Sends one ray.
    fn send(
        &self,
        rays: &SampleRays,
        radiance: &dyn Radiance,
        sensor: &Sensor,
        point: SurfacePoint,
        u: DVec2,
    ) {
        let (camera, optics, scene) = (rays.camera, &rays.optics, rays.tracer.scene());
        let position = camera.camera_from_world(point.position(scene));
        let inverse_depth = 1.0 / position.z;
        let land = |kappa| camera.pixel_from_q(optics.landing(position, u, kappa));
        let Some(pixel) = sensor.pixel(land(optics.kappa(inverse_depth, rays.focus.at(point)))) else {
            return;
        };
        let eye = camera.world_from_camera(u.extend(0.0));
        if rays.tracer.occluded(point, eye) {
            return;
        }
        let normal = camera.camera_direction(scene.area_normal(point.triangle));
        let w = self.samples_per_pixel * pixels_by_area(rays, normal, position, u);
        let sent = f64::from(self.rays_of[point.triangle as usize]) / (normal.length() / 2.0);
        let found_by_camera = sensor.is_within(land(optics.standard_kappa(inverse_depth)), self.guard_px);
        let weight = w / if found_by_camera { w + sent } else { sent };
        sensor.add(pixel, Sum::of_light(sensor.quantise(radiance.toward(point, eye) * weight as f32)));
    }
}

/// w(P, U): pixels of the picture a unit of area of a surface, for the aperture point `u`. `normal` of any
/// length; camera space.
fn pixels_by_area(rays: &SampleRays, normal: DVec3, position: DVec3, u: DVec2) -> f64 {
    let toward_surface = position - u.extend(0.0);
    let half_height_px = rays.optics.half_height_px / rays.optics.tan_half_yfov;
    normal.normalize_or_zero().dot(toward_surface).abs() / position.z.powi(3) * half_height_px.powi(2)
}

/// The unit square onto the triangle, area for area (Heitz 2019).
fn uniform_barycentric(u: DVec2) -> DVec2 {
    if u.y > u.x { DVec2::new(0.5 * u.x, u.y - 0.5 * u.x) } else { DVec2::new(u.x - 0.5 * u.y, 0.5 * u.y) }
}
