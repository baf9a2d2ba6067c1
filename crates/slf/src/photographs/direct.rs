//! Light evaluated in the photographs themselves (seed §3.3.4), without resampling to texels first.
//!
//! What was solved for all photographs together (exposures, mirrored surroundings, cross-validation by blocks) comes
//! from [`PhotographLight`]; the constant part and the residuals of a point are fitted anew for each query, just as for
//! a texel.

use super::error::PhotographError;
use super::fitting::{
    FULL_EVIDENCE, ResidualSample, Sample, Workspace, direction_to_eye, is_reflection_blocked, robust_mean,
};
use super::observations::{LoadedView, ViewLoader, ViewVisibility, border_weight};
use super::texels::{MemoryBudget, TexelBlocks};
use super::{PhotographLight, PhotographOptions};
use glam::{DVec3, Vec3};
use progress::Progress;
use scene::SurfacePoint;
use std::sync::Arc;
use trace::{OutgoingRadiance, Radiance};

/// Radiance of a surface, looked up in the photographs that a [`PhotographLight`] was made from.
pub struct DirectPhotographs {
    light: Arc<PhotographLight>,
    /// By view of the scene.
    loaded_views: Vec<LoadedView>,
}

impl DirectPhotographs {
    /// Loads the photographs that the light was made from, at reduced resolution if they would not fit the memory of
    /// `options`.
    ///
    /// # Errors
    /// [`PhotographError::Picture`] if a photograph or its mask cannot be read; [`PhotographError::Cancelled`] if
    /// `progress` asks to stop.
    pub fn load(
        light: Arc<PhotographLight>,
        options: &PhotographOptions,
        progress: &dyn Progress,
    ) -> Result<Self, PhotographError> {
        let scene = light.tracer.scene();
        let (reduction, at_once) = MemoryBudget::for_direct_lookup(&scene.views, options.max_memory);
        let loader = ViewLoader { load: &options.load, reduction, at_once };
        let loaded_views = loader.load_each(scene, &scene.views, progress, |_, loaded| loaded)?;
        Ok(Self { light, loaded_views })
    }

    /// What the photographs of the better-observed side show of a position, by view.
    fn samples(&self, position: DVec3, normal: Vec3) -> Vec<(usize, Sample)> {
        let views = &self.light.tracer.scene().views;
        let is_front =
            |view_index: usize| normal.dot((views[view_index].position() - position).as_vec3()) >= 0.0;
        let mut visible: Vec<(usize, f32)> = Vec::new();
        for (view_index, (view, loaded)) in views.iter().zip(&self.loaded_views).enumerate() {
            let weight = ViewVisibility { view, loaded }.surface_weight(position, normal);
            if weight >= MIN_WEIGHT {
                visible.push((view_index, weight));
            }
        }
        let balance: f32 = visible
            .iter()
            .map(|&(view_index, weight)| if is_front(view_index) { weight } else { -weight })
            .sum();
        visible.retain(|&(view_index, _)| is_front(view_index) == (balance >= 0.0));
        let sample = |(view_index, weight): (usize, f32)| {
            let (view, picture) = (&views[view_index], &self.loaded_views[view_index].picture);
            let pixel = view.project(position)?;
            let displacement = &self.light.displacements[view_index];
            let place = picture.place(displacement.moved(pixel));
            let picture_sample = picture.at(place);
            let light = picture_sample.light * self.light.exposures[view_index].to_radiance(view, pixel);
            let mut weight = weight * self.light.inlier_maps[view_index].at(pixel);
            if !displacement.is_none() {
                weight *= border_weight(picture, place);
            }
            let weight = weight.max(MIN_WEIGHT);
            Some((view_index, Sample { light, weight, clipped: picture_sample.clipped.clamp(0.0, 1.0) }))
        };
        visible.into_iter().filter_map(sample).collect()
    }
}

/// Weights of texels are quantised to 255ths: anything less is zero.
const MIN_WEIGHT: f32 = 0.5 / 255.0;

impl Radiance for DirectPhotographs {
    fn outgoing(&self, point: SurfacePoint, eye: DVec3) -> OutgoingRadiance {
        let light = &self.light;
        let (residuals, mirrored) = (&light.residuals, &light.mirrored);
        let Some(place) = light.grid.place(point) else { return OutgoingRadiance::default() };
        let scene = light.tracer.scene();
        let position = point.position(scene);
        let outgoing = direction_to_eye(position, eye);
        let normal = scene.shading_normal(point).as_vec3();
        let blocks = TexelBlocks::new([light.grid.width, light.grid.height]);
        let block_value = |values: &[f32]| blocks.at(place, values);
        let area_normal = scene.area_normal(point.triangle).normalize_or_zero().as_vec3();
        let samples = self.samples(position, area_normal);
        let evidence: f32 = samples.iter().map(|(_, sample)| sample.weight).sum();
        if evidence == 0.0 {
            return light.outgoing(point, eye);
        }
        let share = block_value(&residuals.cross_validation.mirrored_share);
        let strength = block_value(&mirrored.strength_of_block);
        let mirrored_strength = strength * share;
        // By sample: direction to its camera, and mirrored radiance there for a strength of 1.
        let reflections: Vec<(Vec3, Vec3)> = samples
            .iter()
            .map(|&(view_index, _)| {
                let direction = direction_to_eye(position, light.eyes[view_index]);
                let is_open = mirrored_strength > 0.0
                    && !is_reflection_blocked(&light.tracer, point, normal, direction);
                (direction, if is_open { mirrored.unit_light(normal, direction) } else { Vec3::ZERO })
            })
            .collect();
        let mut workspace = Workspace::new();
        let mut mean = |strength: f32| {
            workspace.samples.clear();
            workspace.samples.extend(
                samples
                    .iter()
                    .zip(&reflections)
                    .map(|((_, sample), (_, sent))| sample.with_light(sample.light - *sent * strength)),
            );
            robust_mean(&workspace.samples, &mut Vec::new())
        };
        let plain = mean(0.0);
        let mut constant = plain;
        if mirrored_strength > 0.0 {
            constant = constant.lerp(mean(strength).max(Vec3::ZERO), share);
        }
        workspace.residuals.clear();
        for (index, ((_, sample), &(direction, sent))) in samples.iter().zip(&reflections).enumerate() {
            let value = sample.light - constant - sent * mirrored_strength;
            workspace.residuals.push(ResidualSample {
                index,
                direction,
                value,
                weight: sample.weight_against(plain),
            });
        }
        let mut own = light.constant(point).lerp(constant, (evidence / FULL_EVIDENCE).min(1.0));
        let confidence = block_value(&residuals.cross_validation.confidence);
        if confidence > 0.0 {
            workspace.retain_best();
            workspace.solve_robustly(&residuals.kernel, block_value(&residuals.cross_validation.errors));
            for (residual, alpha) in workspace.residuals.iter().zip(&workspace.alpha) {
                own += *alpha * (confidence * residuals.kernel.at(residual.direction.distance(outgoing)));
            }
        }
        let (carried, carried_share) = light.mirrored_light(point, mirrored_strength, normal, outgoing);
        OutgoingRadiance { own: own.max(-carried), carried, carried_share, ..OutgoingRadiance::default() }
    }

    fn environment(&self, direction: DVec3) -> Vec3 {
        self.light.environment(direction)
    }
}
