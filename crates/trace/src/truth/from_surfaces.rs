//! Rays that start at the surfaces: the second, independent estimator.
//!
//! Points P are spread over every piece of surface that may send light into the picture
//! ([`super::patches`]), each with an aperture point U. What the ray P → U adds, at the place where its own κ
//! sends it, is its share of the model's integral over surface and aperture:
//!
//! ```text
//! L(P→U) · V(P, U) · w(P, U) · A/n        w(P, U) px² by area, n points on the piece's area A
//! ```
//!
//! and the same with L = 1 of coverage. V is whether the ray back from U meets that triangle first: so a
//! point that its own material takes away does not count, and of coincident triangles one does. Infinity is
//! cut into tiles of the picture, each with directions spread over it. No place on the sensor is drawn: it
//! follows. A piece has as many points a sample as it has px² seen from the aperture, more if it is bright,
//! fewer if most of its light lands outside.

use super::kappa_bounds::{FocusBox, uniform_barycentric};
use super::options::{Sampler, TruthOptions};
use super::patches::{Patch, visit_patches};
use super::samples;
use super::sensor::Sensor;
use super::view::{Arrival, Blurs, RayPlace, View};
use crate::random::{hash, unit};
use crate::{Radiance, Ray};
use glam::{DVec2, DVec3};
use lens::ApertureSampler;
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use scene::SurfacePoint;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

/// What rays start from.
struct Source {
    extent: Extent,
    /// Rays for each sample of a pixel.
    rate: f64,
}

enum Extent {
    /// A piece of a triangle: its corners in barycentrics, and its area in square units of length.
    Surface { triangle: u32, barycentric: [DVec2; 3], area: f64 },
    /// A rectangle of the picture of infinity, unblurred: its corner and size, px.
    Infinity { corner: DVec2, size: DVec2 },
}

/// The side of a tile of infinity, px.
const TILE_PX: f64 = 16.0;
/// Pieces whose light mostly lands outside get at least this share of the points they else would.
const MIN_SHARE: f64 = 1e-6;
/// Rays of all sources together for each pixel and sample, at most (surfaces next to the lens want many).
const MAX_RAYS: f64 = 32.0;
/// Pieces brighter than white get points by their radiance, but at most so many times as many.
const MAX_BRIGHTNESS: f64 = 256.0;

/// The estimator.
pub(super) struct FromSurfaces {
    sources: Vec<Source>,
    aperture: ApertureSampler,
    sampler: Sampler,
    seed: u64,
}

impl FromSurfaces {
    /// Cuts the surfaces that can reach the sensor into pieces that send rays.
    pub fn new(view: &View, radiance: &dyn Radiance, sensor: &Sensor, options: &TruthOptions) -> Self {
        let [low, high] = sensor.window();
        let lateral = view.lateral_px([low, high]);
        let window = [low - lateral, high + lateral];
        let triangles = 0..view.tracer.scene().triangles.len() as u32;
        let pieces = triangles.into_par_iter().flat_map_iter(|triangle| {
            let mut sources = Vec::new();
            visit_patches(view, window, triangle, &mut |patch| {
                sources.push(Source::piece(view, radiance, window, patch));
            });
            sources
        });
        let mut sources: Vec<Source> = pieces.collect();
        sources.extend(infinity(view, window));
        let total: f64 = sources.iter().map(|source| source.rate).sum();
        let most = MAX_RAYS * (window[1] - window[0]).element_product();
        let scale = (most / total).min(1.0);
        sources.iter_mut().for_each(|source| source.rate *= scale);
        let aperture = ApertureSampler::new(&view.camera.aperture);
        Self { sources, aperture, sampler: options.sampler, seed: u64::from(options.seed) }
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
        passed: Range<u32>,
        progress: &dyn Progress,
    ) -> Result<(), Cancelled> {
        let first = unit(hash([self.seed]));
        let done = AtomicUsize::new(0);
        self.sources.par_iter().enumerate().try_for_each(|(k, source)| {
            progress.check()?;
            let seed = hash([self.seed, k as u64]);
            // Offsets of neighbours are evenly spread, by steps of the golden ratio.
            let offset = (first + k as f64 * GOLDEN_RATIO).fract();
            for [a, b, c, d] in
                samples::points(self.sampler, seed, samples::indices(source.rate, offset, &passed))
            {
                let u = self.aperture.sample(a, b) * view.camera.aperture_radius;
                source.send(view, radiance, sensor, DVec2::new(c, d), u);
            }
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            progress.report(done as f32 / self.sources.len() as f32);
            Ok(())
        })
    }
}

/// (√5 − 1)/2.
const GOLDEN_RATIO: f64 = 0.618_033_988_749_894_8;

/// The tiles of infinity that light may come from.
fn infinity(view: &View, window: [DVec2; 2]) -> impl Iterator<Item = Source> {
    let radius = FocusBox::of_background(view).background_radius_px(view, window);
    let (low, high) = (window[0] - radius, window[1] + radius);
    let size = high - low;
    let usable = size.is_finite() && size.cmpgt(DVec2::ZERO).all();
    let count = if usable { (size / TILE_PX).ceil() } else { DVec2::ZERO };
    // A sky that is blurred beyond all measure has larger tiles.
    const MAX_SOURCES: f64 = 1024.0;
    let count = count.min(DVec2::splat(MAX_SOURCES));
    let size = size / count;
    (0..count.y as u64).flat_map(move |row| {
        (0..count.x as u64).map(move |column| {
            let corner = low + size * DVec2::new(column as f64, row as f64);
            let share = share_inside([corner - radius, corner + size + radius], window);
            Source { extent: Extent::Infinity { corner, size }, rate: size.element_product() * share }
        })
    })
}

/// The share of a box that lies in the window, but at least [`MIN_SHARE`].
fn share_inside(box_px: [DVec2; 2], window: [DVec2; 2]) -> f64 {
    let inside = box_px[1].min(window[1]) - box_px[0].max(window[0]);
    let share = inside / (box_px[1] - box_px[0]);
    // Flat boxes lie in the window with their whole width of 0.
    let along = |share: f64| if share.is_nan() { 1.0 } else { share.clamp(0.0, 1.0) };
    (along(share.x) * along(share.y)).max(MIN_SHARE)
}

impl Source {
    /// A piece of a triangle.
    fn piece(view: &View, radiance: &dyn Radiance, window: [DVec2; 2], patch: &Patch) -> Self {
        let [a, b, c] = patch.corners;
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let middle = (a + b + c) / 3.0;
        let [nearest, farthest] = patch.depths();
        // The largest w of the piece, about: pieces of one depth have about one z³, others cross the aperture
        // plane.
        let at = DVec3::new(middle.x, middle.y, middle.z.max(farthest / 3.0));
        let rims = [DVec2::ONE, DVec2::NEG_ONE, DVec2::new(1.0, -1.0), DVec2::new(-1.0, 1.0)];
        let w = rims.map(|u| view.optics.pixels_by_area(normal, at, u * view.optics.aperture_radius));
        let pixels = w.into_iter().fold(0.0, f64::max) * patch.area();
        let inverse_depths = [1.0 / farthest, 1.0 / nearest.max(farthest / 3.0)];
        let radius =
            view.radius_px(patch.focus.largest_kappa(view, inverse_depths, patch.farthest_chief(view)));
        let [low, high] = match patch.inverse_depths() {
            Some(_) => patch.sharp_image(view),
            None => [view.camera.pixel_from_q(view.optics.chief(at)); 2],
        };
        let share = share_inside([low - radius, high + radius], window);
        let extent =
            Extent::Surface { triangle: patch.triangle, barycentric: patch.barycentric, area: patch.area() };
        let rate = pixels * share * brightness(view, radiance, patch);
        Self { extent, rate: if rate.is_finite() { rate } else { 0.0 } }
    }

    /// Sends one ray from the place that `v` in [0, 1)² stands for, through the aperture point `u`.
    fn send(&self, view: &View, radiance: &dyn Radiance, sensor: &Sensor, v: DVec2, u: DVec2) {
        let camera = view.camera;
        let eye = camera.world_from_camera(u.extend(0.0));
        match &self.extent {
            Extent::Surface { triangle, barycentric, area } => {
                let within = uniform_barycentric(v);
                let [a, b, c] = barycentric;
                let barycentric = *a * (1.0 - within.x - within.y) + *b * within.x + *c * within.y;
                let point = SurfacePoint { triangle: *triangle, barycentric };
                let world = point.position(view.tracer.scene());
                let position = camera.camera_from_world(world);
                if position.z <= 0.0 {
                    return;
                }
                let place =
                    RayPlace { chief: view.optics.chief(position), inverse_depth: 1.0 / position.z, u };
                let Blurs { own, carried } = view.blurs(Some(point), place);
                let [to, of_carried] = [own, carried].map(|blur| view.landing_px(position, u, blur.kappa));
                let is_visible = match &view.character {
                    None => sensor.covers(to) || sensor.covers(of_carried),
                    Some(character) => character.passes(place.chief, place.inverse_depth, u),
                };
                if !is_visible || !is_met_first(view, *triangle, eye, world - eye) {
                    return;
                }
                let normal = camera.camera_direction(view.tracer.scene().area_normal(*triangle));
                let w = view.optics.pixels_by_area(normal.normalize_or_zero(), position, u);
                let weight = w * area / self.rate;
                let light = radiance.outgoing(point, eye);
                let share = f64::from(light.carried_share);
                if let Some(character) = &view.character {
                    let parts = [(own, light.own, 1.0 - share), (carried, light.carried, share)];
                    for (blur, light, coverage) in parts {
                        for Arrival { at, colours } in view.arrivals(character, place, blur) {
                            sensor.expose(at, light * colours.as_vec3(), weight, coverage * colours);
                        }
                    }
                    return;
                }
                sensor.expose(to, light.own, weight, DVec3::splat(1.0 - share));
                if share > 0.0 || light.carried != glam::Vec3::ZERO {
                    sensor.expose(of_carried, light.carried, weight, DVec3::splat(share));
                }
            }
            Extent::Infinity { corner, size } => {
                let sharp = camera.q_from_pixel(*corner + *size * v);
                let slope = sharp * view.optics.tan_half_yfov;
                let place = RayPlace { chief: sharp, inverse_depth: 0.0, u };
                let own = view.blurs(None, place).own;
                let to = view.landing_px(slope.extend(1.0), u, own.kappa);
                let direction = camera.world_direction(slope.extend(1.0));
                let ray = Ray { origin: eye, direction, t_min: 0.0, t_max: f64::INFINITY, skip: None };
                let is_visible = match &view.character {
                    None => sensor.covers(to),
                    Some(character) => character.passes(sharp, 0.0, u),
                };
                if !is_visible || view.tracer.any_hit(&ray) {
                    return;
                }
                let weight = size.element_product() / self.rate;
                let light = radiance.environment(direction);
                match &view.character {
                    None => sensor.expose(to, light, weight, DVec3::ONE),
                    Some(character) => {
                        for Arrival { at, colours } in view.arrivals(character, place, own) {
                            sensor.expose(at, light * colours.as_vec3(), weight, colours);
                        }
                    }
                }
            }
        }
    }
}

/// Whether a ray from the aperture meets this triangle before any other.
fn is_met_first(view: &View, triangle: u32, eye: DVec3, direction: DVec3) -> bool {
    let ray = Ray { origin: eye, direction, t_min: 0.0, t_max: f64::INFINITY, skip: None };
    view.tracer.first_hit(&ray).is_some_and(|hit| hit.point.triangle == triangle)
}

/// How many times as many points a piece gets for being brighter than white: by looking at its middle and
/// toward its corners. Only surfaces that shine by themselves are looked at: others are seldom so bright.
fn brightness(view: &View, radiance: &dyn Radiance, patch: &Patch) -> f64 {
    if !view.tracer.scene().material_of(patch.triangle).is_emitter() {
        return 1.0;
    }
    let [a, b, c] = patch.barycentric;
    let barycentrics =
        [(a + b + c) / 3.0, (a * 4.0 + b + c) / 6.0, (a + b * 4.0 + c) / 6.0, (a + b + c * 4.0) / 6.0];
    let brightness_at = |barycentric| {
        let point = SurfacePoint { triangle: patch.triangle, barycentric };
        radiance.total_outgoing(point, view.camera.position()).max_element()
    };
    f64::from(barycentrics.map(brightness_at).into_iter().fold(0.0, f32::max)).clamp(1.0, MAX_BRIGHTNESS)
}
