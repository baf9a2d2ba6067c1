//! Rays that start at the sensor, and what they find is sent back to it.
//!
//! Every pixel of the reach ([`super::reach`]) sends rays through the aperture toward the focus plane, as any
//! thin-lens camera does (Cook, Porter and Carpenter 1984). What a ray hits is then sent on to the sensor
//! with the hit's own defocus κ (what it carries with that of carried light): it lands not where it came from but
//!
//! ```text
//! p + (κ − κ_standard)·U/tanθ
//! ```
//!
//! away, p the position it left the picture at (half-heights), U its aperture point, and adds its radiance to
//! the pixel it lands in, 1/spp of it. The change of variables has no Jacobian of its own (p at fixed U moves
//! with the surface), so energy is conserved, and a standard hit keeps its pixel exactly.
//!
//! Small bright surfaces also send rays of their own ([`super::bright_surfaces`]). Low-discrepancy samples suit the
//! circle of confusion of what a pixel shows ([`super::sheared`], [`super::survey`]).

use super::bright_surfaces::BrightSurfaces;
use super::options::{Sampler, TruthOptions};
use super::reach::Reach;
use super::samples::{self, PixelSample};
use super::sensor::{self, Sensor};
use super::sheared::{Sheared, Spread};
use super::survey::{self, Survey, SurveyHit};
use super::view::{Arrival, Blurs, RayPlace, View};
use crate::random::hash;
use crate::{OutgoingRadiance, Radiance, Ray};
use glam::{DVec2, DVec3, Vec3};
use lens::{ApertureSampler, CharacterOptics};
use progress::{Cancelled, Progress, Stage};
use rayon::prelude::*;
use scene::SurfacePoint;
use std::ops::Range;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The side of a tile, px: the unit of work.
const TILE_PX: i64 = 16;

/// The estimator.
pub(super) struct FromSensor {
    reach: Reach,
    bright: BrightSurfaces,
    aperture: ApertureSampler,
    options: TruthOptions,
    seed: u64,
    /// The survey that assigns sequences to pixels, and the sequences; made in the first pass.
    fitted: OnceLock<(Survey, Sheared)>,
}

/// Separates the seed of the survey's rays from that of the samples.
const SURVEY: u64 = 0x5375_7276;

/// A ray through the aperture, traced.
struct TracedRay {
    /// The surface point, `None` for the background.
    point: Option<SurfacePoint>,
    /// The aperture point in the world.
    eye: DVec3,
    /// The direction from there, in the world.
    direction: DVec3,
    /// Where it comes from and where it crosses the aperture.
    place: RayPlace,
    /// How its light is focused.
    blurs: Blurs,
    /// Where what is its own lands, less where it left: px.
    displacement_px: DVec2,
    /// The same of what it carries.
    carried_displacement_px: DVec2,
}

impl FromSensor {
    /// Prepares the rays from the pixels of `sensor`: how far around them light can land, and which surfaces are too
    /// bright for such rays.
    pub fn new(view: &View, radiance: &dyn Radiance, sensor: &Sensor, options: &TruthOptions) -> Self {
        let reach = Reach::new(view, sensor.window());
        let bright = BrightSurfaces::detect(view, radiance, reach, sensor.window(), options);
        let aperture = ApertureSampler::new(&view.camera.aperture);
        let (options, seed) = (*options, u64::from(options.seed));
        Self { reach, bright, aperture, options, seed, fitted: OnceLock::new() }
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
        let own_rays = if self.bright.is_empty() { 0.0 } else { 0.1 };
        self.bright.expose(view, radiance, sensor, &passed, &Stage::new(progress, 0.0, own_rays))?;
        let mut exposure = Exposure { estimator: self, view, radiance, sensor, shared: Vec::new(), passed };
        let mut survey_end = own_rays;
        if self.options.sampler == Sampler::LowDiscrepancy {
            if self.fitted.get().is_none() {
                survey_end += 0.1;
                let survey = exposure.survey(&Stage::new(progress, own_rays, survey_end))?;
                let of_levels = survey.levels.iter().map(|&level| Spread { level, moved_px: 0.0 });
                let spreads = survey.moved.into_iter().chain(of_levels).collect();
                let sheared = Sheared::new(self.seed, self.options.samples_per_pixel, spreads);
                self.fitted.get_or_init(|| (survey, sheared));
            }
            // In the order of the survey's choices.
            let plain = self.pixel_samples(view, self.seed, &exposure.passed);
            if let Some((survey, sheared)) = self.fitted.get() {
                let radius = view.camera.aperture_radius;
                let mut suited =
                    sheared.samples(&exposure.passed, radius, self.pixel_sample(view)).into_iter();
                let moved = survey.moved.and_then(|_| suited.next()).unwrap_or_else(|| plain.clone());
                exposure.shared = [moved, plain].into_iter().chain(suited).collect();
            }
        }
        exposure.expose(&Stage::new(progress, survey_end, 1.0))
    }

    fn pixel_samples(&self, view: &View, seed: u64, passed: &Range<u32>) -> Vec<PixelSample> {
        let indices = u64::from(passed.start)..u64::from(passed.end);
        samples::points(self.options.sampler, seed, indices).map(self.pixel_sample(view)).collect()
    }

    /// What makes a sample of four numbers.
    fn pixel_sample(&self, view: &View) -> impl Fn([f64; 4]) -> PixelSample {
        let radius = view.camera.aperture_radius;
        move |[x, y, a, b]| PixelSample {
            within_px: DVec2::new(x, y),
            u: self.aperture.sample(a, b) * radius,
        }
    }
}

/// One pass.
struct Exposure<'a> {
    estimator: &'a FromSensor,
    view: &'a View<'a>,
    radiance: &'a dyn Radiance,
    sensor: &'a Sensor,
    /// Low-discrepancy samples by the survey's choice.
    shared: Vec<Vec<PixelSample>>,
    passed: Range<u32>,
}

impl Exposure<'_> {
    /// Sends the rays of all pixels in reach.
    fn expose(&self, progress: &dyn Progress) -> Result<(), Cancelled> {
        let (low, high) = (self.estimator.reach.low, self.estimator.reach.high);
        let [left, top, right, bottom] = [low.x, low.y, high.x, high.y].map(|edge| edge as i64);
        let tiles = |length: i64| (length.max(0) + TILE_PX - 1) / TILE_PX;
        let (columns, rows) = (tiles(right - left), tiles(bottom - top));
        let done = AtomicUsize::new(0);
        (0..columns * rows).into_par_iter().try_for_each(|tile| {
            let (x0, y0) = (left + tile % columns * TILE_PX, top + tile / columns * TILE_PX);
            for y in y0..(y0 + TILE_PX).min(bottom) {
                progress.check()?;
                for x in x0..(x0 + TILE_PX).min(right) {
                    self.expose_pixel(x, y);
                }
            }
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            progress.report(done as f32 / (columns * rows) as f32);
            Ok(())
        })
    }

    /// Sends the rays of one pixel; (0, 0) is the frame's upper left one.
    fn expose_pixel(&self, x: i64, y: i64) {
        let corner = DVec2::new(x as f64, y as f64);
        let own = self.sensor.pixel(corner).filter(|_| self.sensor.is_own_pixel());
        // What stays in this pixel is summed here first.
        let mut stays = sensor::Sum::default();
        let mut land = |at: DVec2, light: Vec3, coverage: DVec3| {
            if own.is_some() && self.sensor.pixel(at) == own {
                stays.add(self.sensor.quantise(light, 1.0, coverage));
            } else {
                self.sensor.expose(at, light, 1.0, coverage);
            }
        };
        let mut expose = |sample: &PixelSample| {
            let from = corner + sample.within_px;
            let traced = self.trace(from, sample.u);
            if let Some(character) = &self.view.character {
                if character.passes(traced.place.chief, traced.place.inverse_depth, sample.u) {
                    self.land_by_colour(&traced, character, &mut land);
                }
                return;
            }
            let to = from + traced.displacement_px;
            let of_carried = from + traced.carried_displacement_px;
            if !self.sensor.covers(to) && !self.sensor.covers(of_carried) {
                return;
            }
            let light = self.light(&traced, sample.u);
            if to == of_carried {
                land(to, light.total(), DVec3::ONE);
                return;
            }
            let carried = f64::from(light.carried_share);
            land(to, light.own, DVec3::splat(1.0 - carried));
            if carried > 0.0 || light.carried != Vec3::ZERO {
                land(of_carried, light.carried, DVec3::splat(carried));
            }
        };
        if self.estimator.options.sampler == Sampler::Independent {
            let seed = hash([self.estimator.seed, x as u64, y as u64]);
            self.estimator.pixel_samples(self.view, seed, &self.passed).iter().for_each(&mut expose);
        } else {
            // Light from outside of the region lands elsewhere.
            let suited = self.estimator.fitted.get().zip(self.sensor.pixel(corner));
            let choice = suited.map_or(survey::MOVED, |((survey, _), pixel)| survey.choices[pixel]);
            self.shared[usize::from(choice)].iter().for_each(&mut expose);
        }
        if let Some(pixel) = own {
            self.sensor.add(pixel, stays);
        }
    }

    /// Calls `land` with where the light of a ray that the lens lets through lands, colour by colour, and how much it covers there.
    fn land_by_colour(
        &self,
        traced: &TracedRay,
        character: &CharacterOptics,
        land: &mut impl FnMut(DVec2, Vec3, DVec3),
    ) {
        let view = self.view;
        let arrivals = |blur| view.arrivals(character, traced.place, blur);
        let Blurs { own, carried } = traced.blurs;
        if !arrivals(own).chain(arrivals(carried)).any(|arrival| self.sensor.covers(arrival.at)) {
            return;
        }
        let light = self.light(traced, traced.place.u);
        let share = f64::from(light.carried_share);
        for Arrival { at, colours } in arrivals(own) {
            land(at, light.own * colours.as_vec3(), colours * (1.0 - share));
        }
        if share > 0.0 || light.carried != Vec3::ZERO {
            for Arrival { at, colours } in arrivals(carried) {
                land(at, light.carried * colours.as_vec3(), colours * share);
            }
        }
    }

    /// Chooses the samples of all pixels of the region.
    fn survey(&self, progress: &dyn Progress) -> Result<Survey, Cancelled> {
        let (view, estimator, region) = (self.view, self.estimator, self.sensor.region());
        let count = survey::rays_per_pixel(&estimator.options);
        let rays = estimator.pixel_samples(view, hash([estimator.seed, SURVEY]), &(0..count));
        let probe = |corner: DVec2, ray: &PixelSample| {
            let traced = self.trace(corner + ray.within_px, ray.u);
            let standard = view.optics.standard_kappa(traced.place.inverse_depth);
            let [radius_px, moved_px] =
                [standard, traced.blurs.own.kappa - standard].map(|kappa| view.optics.splat_radius_px(kappa));
            let stays = traced.blurs.own.is_standard && view.character.is_none();
            let moved_px = if stays { 0.0 } else { moved_px };
            SurveyHit { radius_px, moved_px, light: self.light(&traced, ray.u).total() }
        };
        Survey::run(region, &rays, view.camera.aperture_radius, probe, progress)
    }

    /// Traces the ray that passes the picture at `pixel` and the aperture at `u`.
    fn trace(&self, pixel: DVec2, u: DVec2) -> TracedRay {
        let (view, optics) = (self.view, &self.view.optics);
        let p = view.camera.q_from_pixel(pixel);
        // Toward the point that p shows on the focus plane; of depth 1, so that t is the depth z.
        let slope = p * optics.tan_half_yfov - u * optics.inverse_focus_distance;
        let eye = view.camera.world_from_camera(u.extend(0.0));
        let direction = view.camera.world_direction(slope.extend(1.0));
        let ray = Ray { origin: eye, direction, t_min: 0.0, t_max: f64::INFINITY, skip: None };
        let hit = view.tracer.first_hit(&ray);
        let point = hit.as_ref().map(|hit| hit.point);
        let inverse_depth = hit.map_or(0.0, |hit| 1.0 / hit.t);
        let chief = p - optics.standard_kappa(inverse_depth) * u / optics.tan_half_yfov;
        let place = RayPlace { chief, inverse_depth, u };
        let blurs = view.blurs(point, place);
        let [displacement_px, carried_displacement_px] =
            [blurs.own, blurs.carried].map(|blur| view.displacement_px(blur, inverse_depth, u));
        TracedRay { point, eye, direction, place, blurs, displacement_px, carried_displacement_px }
    }

    /// The radiance that a sample through the aperture point `u` carries.
    fn light(&self, traced: &TracedRay, u: DVec2) -> OutgoingRadiance {
        match traced.point {
            Some(point) => {
                let share = self.estimator.bright.camera_share(self.view, point, u) as f32;
                let light = self.radiance.outgoing(point, traced.eye);
                OutgoingRadiance { own: light.own * share, carried: light.carried * share, ..light }
            }
            None => OutgoingRadiance::from_own(self.radiance.environment(traced.direction)),
        }
    }
}
