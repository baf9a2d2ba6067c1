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
//! c = w(P, U)         camera's rays a unit of the triangle's area, s = n/A its own, both by sample of a pixel
//! ```
//!
//! which adds up to L·c, what the camera's rays alone would bring on average. (Out of reach the camera sends no
//! rays; there the surface's ray brings it all, L·c/s.) Coverage counts the camera's rays alone.

use super::kappa_bounds::uniform_barycentric;
use super::options::{Sampler, TruthOptions};
use super::reach::Reach;
use super::samples;
use super::sensor::Sensor;
use super::view::{Arrival, Blurs, RayPlace, View};
use crate::Radiance;
use crate::random::{hash, unit};
use glam::{DVec2, DVec3};
use lens::ApertureSampler;
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use scene::SurfacePoint;
use std::f64::consts::PI;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Only triangles brighter than white send rays.
const WHITE: f32 = 1.0;
/// They send so many that each brings at most this share of what a camera's ray brings from a white surface.
const SHARE_OF_WHITE: f64 = 0.25;
/// Rays that all triangles send together, at most: a share of the frame's own.
const SHARE_OF_FRAME: f64 = 0.25;

/// The triangles that send rays.
pub(super) struct BrightSurfaces {
    /// Rays that each triangle of the scene sends for each sample of a pixel; empty if none does.
    rates: Vec<f64>,
    /// Those that do.
    senders: Vec<u32>,
    reach: Reach,
    sampler: Sampler,
    seed: u64,
}

impl BrightSurfaces {
    /// Finds the surfaces that are too bright for the sensor's own samples. `window` is where light counts: its least
    /// and greatest corner, px.
    pub fn detect(
        view: &View,
        radiance: &dyn Radiance,
        reach: Reach,
        window: [DVec2; 2],
        options: &TruthOptions,
    ) -> Self {
        let triangles = 0..view.tracer.scene().triangles.len() as u32;
        let target_rates: Vec<f64> = triangles
            .into_par_iter()
            .map(|triangle| target_rate(view, radiance, reach, window, triangle))
            .collect();
        let total: f64 = target_rates.iter().sum();
        let senders: Vec<u32> =
            (0..target_rates.len() as u32).filter(|&k| target_rates[k as usize] > 0.0).collect();
        let pixels = (window[1] - window[0]).element_product();
        let share = (SHARE_OF_FRAME * pixels / total).min(1.0);
        let rates =
            if senders.is_empty() { Vec::new() } else { target_rates.iter().map(|n| n * share).collect() };
        Self { rates, senders, reach, sampler: options.sampler, seed: u64::from(options.seed) }
    }

    /// Whether no surface is that bright.
    pub fn is_empty(&self) -> bool {
        self.senders.is_empty()
    }

    /// The share of a path from a point of a triangle to the aperture point `u` that the camera's ray takes.
    pub fn camera_share(&self, view: &View, point: SurfacePoint, u: DVec2) -> f64 {
        let rate = self.rates.get(point.triangle as usize).copied().unwrap_or(0.0);
        if rate == 0.0 {
            return 1.0;
        }
        let scene = view.tracer.scene();
        let normal = view.camera.camera_direction(scene.area_normal(point.triangle));
        let position = view.camera.camera_from_world(point.position(scene));
        let camera = view.optics.pixels_by_area(normal.normalize_or_zero(), position, u);
        camera / (camera + rate / (normal.length() / 2.0))
    }

    /// Sends the rays of one pass, for the samples `passed` of each pixel, and adds their light to `sensor`.
    ///
    /// # Errors
    /// [`Cancelled`] if `progress` asks to stop.
    pub fn expose(
        &self,
        view: &View,
        radiance: &dyn Radiance,
        sensor: &Sensor,
        passed: &Range<u32>,
        progress: &dyn Progress,
    ) -> Result<(), Cancelled> {
        let aperture = ApertureSampler::new(&view.camera.aperture);
        let done = AtomicUsize::new(0);
        self.senders.par_iter().try_for_each(|&triangle| {
            progress.check()?;
            let seed = hash([self.seed, u64::from(triangle)]);
            let indices = samples::indices(self.rates[triangle as usize], unit(seed), passed);
            for [a, b, c, d] in samples::points(self.sampler, seed, indices) {
                let point = SurfacePoint { triangle, barycentric: uniform_barycentric(DVec2::new(c, d)) };
                let u = aperture.sample(a, b) * view.camera.aperture_radius;
                self.send(view, radiance, sensor, point, u);
            }
            progress.report((done.fetch_add(1, Ordering::Relaxed) + 1) as f32 / self.senders.len() as f32);
            Ok(())
        })
    }

    /// Sends one ray.
    fn send(&self, view: &View, radiance: &dyn Radiance, sensor: &Sensor, point: SurfacePoint, u: DVec2) {
        let (camera, optics, scene) = (view.camera, &view.optics, view.tracer.scene());
        let position = camera.camera_from_world(point.position(scene));
        let inverse_depth = 1.0 / position.z;
        let place = RayPlace { chief: optics.chief(position), inverse_depth, u };
        let Blurs { own, carried } = view.blurs(Some(point), place);
        let [to, of_carried] = [own, carried].map(|blur| view.landing_px(position, u, blur.kappa));
        let from = view.landing_px(position, u, optics.standard_kappa(inverse_depth));
        let is_seen = match &view.character {
            None => sensor.covers(to) || sensor.covers(of_carried),
            Some(character) => character.passes(place.chief, inverse_depth, u),
        };
        if !is_seen {
            return;
        }
        let eye = camera.world_from_camera(u.extend(0.0));
        if view.tracer.is_hidden_from(point, eye) {
            return;
        }
        let normal = camera.camera_direction(scene.area_normal(point.triangle));
        let w = optics.pixels_by_area(normal.normalize_or_zero(), position, u);
        let sent = self.rates[point.triangle as usize] / (normal.length() / 2.0);
        let weight = w / if self.reach.contains(from) { w + sent } else { sent };
        let light = radiance.outgoing(point, eye);
        if let Some(character) = &view.character {
            for (blur, light) in [(own, light.own), (carried, light.carried)] {
                for Arrival { at, colours } in view.arrivals(character, place, blur) {
                    sensor.expose(at, light * colours.as_vec3(), weight, DVec3::ZERO);
                }
            }
            return;
        }
        sensor.expose(to, light.own, weight, DVec3::ZERO);
        if light.carried != glam::Vec3::ZERO {
            sensor.expose(of_carried, light.carried, weight, DVec3::ZERO);
        }
    }
}

/// How many rays a triangle should send for each sample of a pixel: so many that each brings little, but not
/// more than one a pixel of the circle of confusion.
fn target_rate(view: &View, radiance: &dyn Radiance, reach: Reach, window: [DVec2; 2], triangle: u32) -> f64 {
    let scene = view.tracer.scene();
    let material = scene.material_of(triangle);
    if !material.is_emitter() || material.may_be_transparent() {
        return 0.0;
    }
    let corners = scene.corners(triangle).map(|corner| view.camera.camera_from_world(corner));
    if corners.iter().any(|corner| corner.z <= 0.0) {
        return 0.0;
    }
    let eye = view.camera.position();
    // Looked at in its middle and toward each corner.
    let places = [(1.0, 1.0), (0.5, 0.5), (2.0, 0.5), (0.5, 2.0)].map(|(b1, b2)| DVec2::new(b1, b2) / 3.0);
    let brightness_at =
        |barycentric| radiance.total_outgoing(SurfacePoint { triangle, barycentric }, eye).max_element();
    let brightest = places.into_iter().map(brightness_at).fold(0.0, f32::max);
    if brightest <= WHITE {
        return 0.0;
    }
    let middle = SurfacePoint { triangle, barycentric: DVec2::splat(1.0 / 3.0) };
    let position = (corners[0] + corners[1] + corners[2]) / 3.0;
    let inverse_depth = 1.0 / position.z;
    let place = RayPlace { chief: view.optics.chief(position), inverse_depth, u: DVec2::ZERO };
    let radius = view.radius_px(view.blurs(Some(middle), place).own.kappa);
    let circle = PI * radius.powi(2) + 1.0;
    // Out of view if the whole triangle, with its widest blur, lies beyond one side of the window.
    let band = (window[0] - reach.low).max(reach.high - window[1]).max_element();
    let fringe = view.radius_px(view.largest_character_kappa(0.0, 0.0)) + view.lateral_px(window);
    let blur = radius.max(view.radius_px(view.optics.standard_kappa(inverse_depth))) + band + fringe;
    let pixels = corners.map(|corner| view.camera.pixel_from_q(view.optics.chief(corner)));
    let (low, high) = pixels.iter().fold((pixels[0], pixels[0]), |(l, h), p| (l.min(*p), h.max(*p)));
    if (low - blur).cmpgt(window[1]).any() || (high + blur).cmplt(window[0]).any() {
        return 0.0;
    }
    let doubled_area = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    let normal = doubled_area.normalize_or_zero();
    let footprint = view.optics.pixels_by_area(normal, position, DVec2::ZERO) * doubled_area.length() / 2.0;
    (f64::from(brightest) / SHARE_OF_WHITE * footprint).min(circle)
}
