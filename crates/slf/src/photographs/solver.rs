//! The steps from photographs to light.

use super::alignment::{self, Displacement};
use super::exposures::{Exposure, solve_exposures};
use super::fitting::{
    CalibratedObservations, RadianceModel, direction_to_eye, fill_unobserved, fit_background,
    fit_radiance_model, fit_single_view, is_reflection_blocked,
};
use super::observations::{Observations, ViewLoader};
use super::texels::{DirectionGrid, MemoryBudget, Texels};
use super::transients::{self, InlierMap};
use super::{PhotographError, PhotographLight, PhotographModel, PhotographOptions, Poses};
use atlas::Atlas;
use glam::DVec3;
use progress::{Cancelled, Progress, Stage};
use scene::View;
use std::sync::Arc;
use trace::Tracer;

/// Rows of the background grid, 0.35° each: a few pixels of a photograph.
const SPHERE_ROWS: usize = 512;

impl PhotographLight {
    /// Makes the light of the scene in `tracer` from views of it, stored at the texels of an atlas of it.
    /// Deterministic: the same bits for any number of threads.
    ///
    /// # Errors
    /// [`PhotographError::None`] if there are no photographs, [`PhotographError::TooMany`] if there are more than can
    /// be numbered, [`PhotographError::Picture`] if one cannot be read, [`PhotographError::Cancelled`] if `progress`
    /// asks to stop.
    pub fn solve(
        tracer: &Arc<Tracer>,
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
        let stage = |name, from, to| Stage::named(progress, name, from, to);
        let sphere = DirectionGrid::with_rows(SPHERE_ROWS);
        let budget = MemoryBudget::for_texels(scene, atlas, views, options.max_memory);
        let texels = Texels::new(scene, atlas, budget.texel_scale);
        progress.check()?;
        let loader = ViewLoader { load: &options.load, reduction: budget.reduction, at_once: budget.at_once };
        let mut observations =
            Observations::new(scene, &texels, &sphere, views, &loader, &stage("photographs", 0.0, 0.25))?;
        let exposures =
            solve_exposures(&texels, &observations, &sphere, views, &stage("exposures", 0.25, 0.33))?;
        let eyes: Vec<DVec3> = views.iter().map(View::position).collect();
        let max_factors = views.iter().zip(&exposures).map(|(view, exposure)| exposure.max_to_radiance(view));
        observations.scale_light(&texels, views, max_factors.fold(1.0, f32::max), |view_index, pixel| {
            exposures[view_index].to_radiance(&views[view_index], pixel)
        });
        let (displacements, inlier_maps) = match options.model {
            PhotographModel::Light => {
                let alignment = Alignment { texels: &texels, views, exposures: &exposures, eyes: &eyes };
                alignment.solve(&mut observations, options.poses, &Stage::new(progress, 0.33, 0.4))?
            }
            PhotographModel::OneView => (
                views.iter().map(Displacement::none).collect(),
                views.iter().map(InlierMap::all_inliers).collect(),
            ),
        };
        progress.check()?;
        if !inlier_maps.iter().all(InlierMap::is_all_inliers) {
            observations.reweight(&texels, views, |view_index, pixel| inlier_maps[view_index].at(pixel));
        }
        if options.model == PhotographModel::Light {
            observations.mark_blocked(|texel, view| {
                let outgoing = direction_to_eye(texels.position(texel), eyes[view]);
                !progress.cancelled()
                    && is_reflection_blocked(
                        tracer,
                        texels.point(texel),
                        texels.shading_normal(texel),
                        outgoing,
                    )
            });
            progress.check()?;
        }
        let calibrated = CalibratedObservations { texels: &texels, observations: &observations, eyes: &eyes };
        let observation_counts =
            (0..texels.count()).map(|texel| observations.range(texel).len() as u16).collect();
        let RadianceModel { mut constant, observed_share, mirrored, residuals } = match options.model {
            PhotographModel::Light => fit_radiance_model(&calibrated, &Stage::new(progress, 0.4, 0.98))?,
            PhotographModel::OneView => fit_single_view(&calibrated),
        };
        let background = fit_background(
            &sphere,
            views,
            &exposures,
            &observations.pictures,
            &observations.background_weights,
        );
        fill_unobserved(&texels, &observed_share, &mut constant);
        progress.report(1.0);
        Ok(Self {
            tracer: tracer.clone(),
            grid: texels.grid,
            exposures,
            eyes,
            displacements,
            inlier_maps,
            constant,
            observed_share,
            observation_counts,
            residuals,
            mirrored,
            sphere,
            background,
        })
    }
}

/// Inputs of the alignment.
struct Alignment<'a> {
    texels: &'a Texels,
    views: &'a [View],
    exposures: &'a [Exposure],
    eyes: &'a [DVec3],
}

impl Alignment<'_> {
    /// Finds the displacement and the inlier map of each photograph. Afterwards the observations are those of the
    /// displaced photographs.
    fn solve(
        &self,
        observations: &mut Observations,
        poses: Poses,
        progress: &dyn Progress,
    ) -> Result<(Vec<Displacement>, Vec<InlierMap>), Cancelled> {
        let Self { texels, views, exposures, eyes } = *self;
        let detect = |observations: &Observations, progress: &dyn Progress| {
            transients::detect_transients(
                &CalibratedObservations { texels, observations, eyes },
                views,
                progress,
            )
        };
        let initial_inliers = detect(observations, &Stage::named(progress, "transients", 0.0, 0.3))?;
        if poses == Poses::AsCalibrated {
            return Ok((views.iter().map(Displacement::none).collect(), initial_inliers));
        }
        let alignment_stage = Stage::named(progress, "alignment", 0.3, 1.0);
        let calibrated = CalibratedObservations { texels, observations, eyes };
        let displacements = alignment::align_photographs(
            &calibrated,
            views,
            exposures,
            &initial_inliers,
            &Stage::new(&alignment_stage, 0.0, 0.7),
        )?;
        if displacements.iter().all(Displacement::is_none) {
            return Ok((displacements, initial_inliers));
        }
        observations.resample(texels, views, |view_index, pixel| {
            let displacement = &displacements[view_index];
            let factor = || exposures[view_index].to_radiance(&views[view_index], pixel);
            (!displacement.is_none()).then(|| (displacement.moved(pixel), factor()))
        });
        let aligned_inliers = detect(observations, &Stage::new(&alignment_stage, 0.8, 1.0))?;
        Ok((displacements, aligned_inliers))
    }
}
