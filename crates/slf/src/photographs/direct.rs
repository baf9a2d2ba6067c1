//! Light looked up in the photographs themselves (seed §3.3.4): nothing is resampled to texels first.
//!
//! What was solved for all photographs together (exposures, what is mirrored, what leaving out told by blocks) is that of
//! [`PhotographLight`]; constant part and residuals of a point are found anew each time it is asked, as those of a texel are.

use super::error::PhotographError;
use super::places::{Blocks, Budget};
use super::seeing::{Look, ReadView, Reading, from_border};
use super::telling::{Known, SEEN, Sample, Work, is_blocked, robust_mean, toward};
use super::{PhotographLight, PhotographOptions};
use glam::{DVec3, Vec3};
use progress::Progress;
use scene::SurfacePoint;
use std::sync::Arc;
use trace::{Leaving, Radiance};

/// Radiance of a surface, looked up in the photographs that light was made from.
pub struct DirectPhotographs {
    light: Arc<PhotographLight>,
    /// By view of the scene.
    read: Vec<ReadView>,
}

impl DirectPhotographs {
    /// Reads the photographs that the light was made from. Reduced where they would not fit the memory of `options`.
    ///
    /// # Errors
    /// One cannot be read, or `progress` says to stop.
    pub fn of(
        light: Arc<PhotographLight>,
        options: &PhotographOptions,
        progress: &dyn Progress,
    ) -> Result<Self, PhotographError> {
        let scene = light.tracer.scene();
        let (reduction, at_once) = Budget::of_pictures(&scene.views, options.max_memory);
        let reading = Reading { load: &options.load, reduction, at_once };
        let read = reading.each(scene, &scene.views, progress, |_, read| read)?;
        Ok(Self { light, read })
    }

    /// What photographs show of a place, and from where: those that see the side that is seen better.
    fn samples(&self, position: DVec3, normal: Vec3) -> Vec<(usize, Sample)> {
        let views = &self.light.tracer.scene().views;
        let is_front = |number: usize| normal.dot((views[number].position() - position).as_vec3()) >= 0.0;
        let mut seen: Vec<(usize, f32)> = Vec::new();
        for (number, (view, read)) in views.iter().zip(&self.read).enumerate() {
            let weight = Look { view, read }.at_surface(position, normal);
            if weight >= LEAST_WEIGHT {
                seen.push((number, weight));
            }
        }
        let balance: f32 = seen.iter().map(|&(n, weight)| if is_front(n) { weight } else { -weight }).sum();
        seen.retain(|&(number, _)| is_front(number) == (balance >= 0.0));
        let sample = |(number, weight): (usize, f32)| {
            let (view, picture) = (&views[number], &self.read[number].picture);
            let pixel = view.project(position)?;
            let displacement = &self.light.displacements[number];
            let place = picture.place(displacement.moved(pixel));
            let shown = picture.at(place);
            let light = shown.light * self.light.exposures[number].to_radiance(view, pixel);
            let mut weight = weight * self.light.belonging[number].at(pixel);
            if !displacement.is_none() {
                weight *= from_border(picture, place);
            }
            let weight = weight.max(LEAST_WEIGHT);
            Some((number, Sample { light, weight, clipped: shown.clipped.clamp(0.0, 1.0) }))
        };
        seen.into_iter().filter_map(sample).collect()
    }
}

/// Texels have their weights in 255ths: less is none.
const LEAST_WEIGHT: f32 = 0.5 / 255.0;

impl Radiance for DirectPhotographs {
    fn leaving(&self, point: SurfacePoint, eye: DVec3) -> Leaving {
        let light = &self.light;
        let (residuals, mirrored) = (&light.residuals, &light.mirrored);
        let Some(place) = light.grid.place(point) else { return Leaving::default() };
        let scene = light.tracer.scene();
        let position = point.position(scene);
        let outgoing = toward(position, eye);
        let normal = scene.shading_normal(point).as_vec3();
        let blocks = Blocks::of([light.grid.width, light.grid.height]);
        let believed = |values: &[f32]| blocks.at(place, values);
        let area_normal = scene.area_normal(point.triangle).normalize_or_zero().as_vec3();
        let samples = self.samples(position, area_normal);
        let evidence: f32 = samples.iter().map(|(_, sample)| sample.weight).sum();
        if evidence == 0.0 {
            return light.leaving(point, eye);
        }
        let share = believed(&residuals.believed.share);
        let strength = believed(&mirrored.strength_of_block);
        let told = strength * share;
        // Of each sample: from where, and what is mirrored there by a strength of 1.
        let looks: Vec<(Vec3, Vec3)> = samples
            .iter()
            .map(|&(number, _)| {
                let direction = toward(position, light.eyes[number]);
                let is_open = told > 0.0 && !is_blocked(&light.tracer, point, normal, direction);
                (direction, if is_open { mirrored.sent(normal, direction) } else { Vec3::ZERO })
            })
            .collect();
        let mut work = Work::new();
        let mut mean = |strength: f32| {
            work.samples.clear();
            work.samples.extend(
                samples
                    .iter()
                    .zip(&looks)
                    .map(|((_, sample), (_, sent))| sample.with_light(sample.light - *sent * strength)),
            );
            robust_mean(&work.samples, &mut Vec::new())
        };
        let plain = mean(0.0);
        let mut constant = plain;
        if told > 0.0 {
            constant = constant.lerp(mean(strength).max(Vec3::ZERO), share);
        }
        work.known.clear();
        for (place, ((_, sample), &(direction, sent))) in samples.iter().zip(&looks).enumerate() {
            let residual = sample.light - constant - sent * told;
            work.known.push(Known { place, direction, residual, weight: sample.counts(plain) });
        }
        let mut own = light.constant(point).lerp(constant, (evidence / SEEN).min(1.0));
        let belief = believed(&residuals.believed.belief);
        if belief > 0.0 {
            work.keep_best();
            work.solve_without_odd(&residuals.kernel, believed(&residuals.believed.errors));
            for (known, alpha) in work.known.iter().zip(&work.alpha) {
                own += *alpha * (belief * residuals.kernel.at(known.direction.distance(outgoing)));
            }
        }
        let (carried, carried_share) = light.mirrored(point, told, normal, outgoing);
        Leaving { own: own.max(-carried), carried, carried_share, ..Leaving::default() }
    }

    fn from_infinity(&self, direction: DVec3) -> Vec3 {
        self.light.from_infinity(direction)
    }
}
