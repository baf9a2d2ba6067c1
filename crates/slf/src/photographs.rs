//! Light from photographs: a surface light field whose radiance was photographed.
//!
//! ```text
//! views ─▶ kept_picture ─┐
//!    └──▶ depth_picture ─┴▶ sightings ─▶ gains ─▶ constant ─▶ directions ─▶ PhotographLight
//!                                                    │
//!                                                    └▶ filling (what no photograph sees)
//! ```

mod constant;
mod depth_picture;
mod directions;
mod filling;
mod gains;
mod kept_picture;
mod sightings;
mod sphere;
mod texels;

pub use gains::Exposure;

use atlas::Atlas;
use constant::{Sample, robust_mean};
use directions::{Kernel, Known, MOST, Regression, toward};
use glam::{DVec3, Vec3};
use progress::{Cancelled, Progress, Stage};
use rayon::prelude::*;
use scene::{LoadOptions, PictureError, Scene, SurfacePoint, View};
use sightings::{Reading, Sightings};
use sphere::Sphere;
use std::sync::Arc;
use texels::Texels;
use trace::{Leaving, Radiance, Tracer};

/// How light is made from photographs.
#[derive(Clone, Debug, PartialEq)]
pub struct PhotographOptions {
    /// Limits for each picture.
    pub load: LoadOptions,
    /// Bytes that the work may hold at once, the scene, its hierarchy and the atlas not counted. Photographs and texels are made coarser
    /// where they would not fit.
    pub max_memory: u64,
}

impl Default for PhotographOptions {
    /// 1.6 GiB.
    fn default() -> Self {
        Self { load: LoadOptions::default(), max_memory: 1600 << 20 }
    }
}

/// Why there is no light from photographs.
#[derive(Debug, thiserror::Error)]
pub enum PhotographError {
    /// A photograph or its mask cannot be had.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// There are none.
    #[error("there are no photographs (give a capture with at least one)")]
    None,
    /// More than can be told apart.
    #[error("there are {count} photographs, at most {} can be used (leave some out)", u16::MAX)]
    TooMany {
        /// How many.
        count: usize,
    },
    /// It was stopped.
    #[error("cancelled")]
    Cancelled,
}

impl From<Cancelled> for PhotographError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

/// Radiance of a surface as photographs of it show it, kept at the texels of an atlas.
pub struct PhotographLight {
    scene: Arc<Scene>,
    texels: Texels,
    exposures: Vec<Exposure>,
    eyes: Vec<DVec3>,
    /// By texel: what goes toward all directions alike.
    constant: Vec<Vec3>,
    /// By texel, 1 photographed, 0 filled.
    seen: Vec<f32>,
    /// `residuals[start[t]..start[t + 1]]` are of texel t.
    start: Vec<u32>,
    residuals: Vec<Residual>,
    kernel: Kernel,
}

/// α of a photograph and texel.
#[derive(Clone, Copy, Debug, Default)]
struct Residual {
    view: u16,
    alpha: [i16; 3],
}

/// α is kept by steps of this; larger ones than 16 do not occur.
const ALPHA_STEP: f32 = 1.0 / 2048.0;

impl PhotographLight {
    /// Makes the light of the scene in `tracer` from views of it, kept at the texels of an atlas of it. Deterministic: the same bits for
    /// any number of threads.
    ///
    /// # Errors
    /// There are no photographs, one cannot be read, or `progress` says to stop.
    pub fn solve(
        tracer: &Tracer,
        atlas: &Atlas,
        views: &[View],
        options: &PhotographOptions,
        progress: &dyn Progress,
    ) -> Result<Self, PhotographError> {
        if views.is_empty() {
            return Err(PhotographError::None);
        }
        if views.len() > usize::from(u16::MAX) {
            return Err(PhotographError::TooMany { count: views.len() });
        }
        let scene = tracer.scene();
        let sphere = Sphere::of_rows(256);
        let reduction = 1;
        let clock = std::time::Instant::now();
        let texels = Texels::of(scene, atlas, 1.0);
        let reading = Reading { load: &options.load, reduction, at_once: 4, sphere: &sphere };
        let sightings =
            Sightings::of(scene, &texels, views, &reading, &Stage::new(progress, 0.0, 0.5))?;
        progress.check()?;
        eprintln!("{} texels {} sightings {:.2}s", texels.count(), sightings.count(), clock.elapsed().as_secs_f64());
        let exposures = gains::exposures(&texels, &sightings, views);
        progress.check()?;
        eprintln!("gains {:.2}s", clock.elapsed().as_secs_f64());
        let eyes: Vec<DVec3> = views.iter().map(View::position).collect();
        let radiance = Calibrated { texels: &texels, sightings: &sightings, views, exposures: &exposures };
        let (mut constant, seen): (Vec<Vec3>, Vec<f32>) = (0..texels.count())
            .into_par_iter()
            .map_init(Vec::new, |belonging, texel| {
                let samples = radiance.samples(texel);
                let evidence: f32 = samples.iter().map(|sample| sample.weight).sum();
                (robust_mean(&samples, belonging), (evidence / 0.25).min(1.0))
            })
            .unzip();
        eprintln!("constant {:.2}s", clock.elapsed().as_secs_f64());
        let kernel = Kernel { reach: 0.9, noise: 0.3 };
        let residuals = residuals(&radiance, &eyes, &constant, &kernel);
        eprintln!("residual {:.2}s", clock.elapsed().as_secs_f64());
        filling::fill(&texels, &seen, &mut constant);
        eprintln!("filled {:.2}s", clock.elapsed().as_secs_f64());
        let start = (0..=texels.count()).map(|t| if t == 0 { 0 } else { sightings.range(t - 1).end as u32 }).collect();
        progress.report(1.0);
        Ok(Self { scene: scene.clone(), texels, exposures, eyes, constant, seen, start, residuals, kernel })
    }

    /// How each photograph renders light, by view.
    pub fn exposures(&self) -> &[Exposure] {
        &self.exposures
    }

    /// How far a point was photographed: 1 it was, 0 it is filled from around.
    pub fn seen(&self, point: SurfacePoint) -> f32 {
        self.interpolated(point, |texel| self.seen[texel])
    }

    /// What a point sends toward all directions alike.
    pub fn constant(&self, point: SurfacePoint) -> Vec3 {
        self.texels.around(point).map_or(Vec3::ZERO, |around| {
            around.iter().map(|&(texel, share)| self.constant[texel as usize] * share).sum()
        })
    }

    fn interpolated(&self, point: SurfacePoint, of: impl Fn(usize) -> f32) -> f32 {
        let around = self.texels.around(point);
        around.map_or(0.0, |around| around.iter().map(|&(texel, share)| of(texel as usize) * share).sum())
    }
}

impl Radiance for PhotographLight {
    fn leaving(&self, point: SurfacePoint, eye: DVec3) -> Leaving {
        let Some(around) = self.texels.around(point) else { return Leaving::default() };
        let position = point.position(&self.scene);
        let outgoing = toward(position, eye);
        let mut sum = Vec3::ZERO;
        for (texel, share) in around {
            if share == 0.0 {
                continue;
            }
            let texel = texel as usize;
            let mut light = self.constant[texel];
            for residual in &self.residuals[self.start[texel] as usize..self.start[texel + 1] as usize] {
                let direction = toward(position, self.eyes[usize::from(residual.view)]);
                let factor = self.kernel.at(direction.distance(outgoing));
                if factor > 0.0 {
                    light += Vec3::from_array(residual.alpha.map(f32::from)) * (ALPHA_STEP * factor);
                }
            }
            sum += light * share;
        }
        Leaving::own(sum.max(Vec3::ZERO))
    }

    fn from_infinity(&self, _direction: DVec3) -> Vec3 {
        Vec3::ZERO
    }
}

/// Sightings with their exposures undone.
struct Calibrated<'a> {
    texels: &'a Texels,
    sightings: &'a Sightings,
    views: &'a [View],
    exposures: &'a [Exposure],
}

impl Calibrated<'_> {
    /// What photographs show of a texel, by view.
    fn samples(&self, texel: usize) -> Vec<Sample> {
        let position = self.texels.position(texel);
        let sample = |sighting: &sightings::Sighting| {
            let number = usize::from(sighting.view);
            let view = &self.views[number];
            let pixel = view.project(position).unwrap_or_default();
            let light = self.sightings.light(sighting) * self.exposures[number].to_radiance(view, pixel);
            Sample { light, weight: sighting.weight() * (1.0 - 0.95 * sighting.clipped()) }
        };
        self.sightings.of_texel(texel).iter().map(sample).collect()
    }
}

fn residuals(radiance: &Calibrated<'_>, eyes: &[DVec3], constant: &[Vec3], kernel: &Kernel) -> Vec<Residual> {
    let texels = radiance.texels;
    let mut all = vec![Residual::default(); radiance.sightings.count()];
    let mut rest = all.as_mut_slice();
    let mut slots = Vec::with_capacity(texels.count());
    for texel in 0..texels.count() {
        let (own, after) = rest.split_at_mut(radiance.sightings.range(texel).len());
        slots.push(own);
        rest = after;
    }
    slots.into_par_iter().enumerate().for_each_init(
        || (Regression::new(), Vec::new(), Vec::new()),
        |(regression, known, alpha), (texel, slots)| {
            let position = texels.position(texel);
            known.clear();
            for (sighting, sample) in radiance.sightings.of_texel(texel).iter().zip(radiance.samples(texel)) {
                let direction = toward(position, eyes[usize::from(sighting.view)]);
                known.push(Known { direction, residual: sample.light - constant[texel], weight: sample.weight });
            }
            known.truncate(MOST);
            regression.solve(kernel, known, alpha);
            for ((slot, sighting), alpha) in
                slots.iter_mut().zip(radiance.sightings.of_texel(texel)).zip(&*alpha)
            {
                let kept = (*alpha / ALPHA_STEP).round().clamp(Vec3::splat(-32767.0), Vec3::splat(32767.0));
                *slot = Residual { view: sighting.view, alpha: kept.to_array().map(|v| v as i16) };
            }
        },
    );
    all
}
