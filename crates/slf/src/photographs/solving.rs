//! Light found from photographs, step by step.

use super::alignment::{self, Displacement};
use super::exposures::{Exposure, exposures};
use super::odd::{self, Belonging};
use super::places::{Budget, Sphere, Texels};
use super::seeing::{Reading, Sightings};
use super::telling::{Calibrated, Told, beyond, fill, is_blocked, one_view, told, toward};
use super::{PhotographError, PhotographLight, PhotographModel, PhotographOptions, Poses};
use atlas::Atlas;
use glam::DVec3;
use progress::{Cancelled, Progress, Stage};
use scene::View;
use std::sync::Arc;
use trace::Tracer;

/// Rows of the cells at infinity, 0.35° each: some pixels of a photograph.
const SPHERE_ROWS: usize = 512;

impl PhotographLight {
    /// Makes the light of the scene in `tracer` from views of it, kept at the texels of an atlas of it. Deterministic: the same bits for
    /// any number of threads.
    ///
    /// # Errors
    /// There are no photographs, one cannot be read, or `progress` says to stop.
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
        let sphere = Sphere::of_rows(SPHERE_ROWS);
        let budget = Budget::of(scene, atlas, views, options.max_memory);
        let texels = Texels::of(scene, atlas, budget.texel_scale);
        progress.check()?;
        let reading = Reading { load: &options.load, reduction: budget.reduction, at_once: budget.at_once };
        let mut sightings =
            Sightings::of(scene, &texels, &sphere, views, &reading, &stage("photographs", 0.0, 0.25))?;
        let exposures = exposures(&texels, &sightings, &sphere, views, &stage("exposures", 0.25, 0.33))?;
        let eyes: Vec<DVec3> = views.iter().map(View::position).collect();
        let most = views.iter().zip(&exposures).map(|(view, exposure)| exposure.most_to_radiance(view));
        sightings.scale(&texels, views, most.fold(1.0, f32::max), |number, pixel| {
            exposures[number].to_radiance(&views[number], pixel)
        });
        let (displacements, belonging) = match options.model {
            PhotographModel::Light => {
                let places = Places { texels: &texels, views, exposures: &exposures, eyes: &eyes };
                places.told(&mut sightings, options.poses, &Stage::new(progress, 0.33, 0.4))?
            }
            PhotographModel::OneView => {
                (views.iter().map(Displacement::none).collect(), views.iter().map(Belonging::whole).collect())
            }
        };
        progress.check()?;
        if !belonging.iter().all(Belonging::is_whole) {
            sightings.weigh(&texels, views, |number, pixel| belonging[number].at(pixel));
        }
        if options.model == PhotographModel::Light {
            sightings.block(|texel, view| {
                let outgoing = toward(texels.position(texel), eyes[view]);
                !progress.cancelled()
                    && is_blocked(tracer, texels.point(texel), texels.shading_normal(texel), outgoing)
            });
            progress.check()?;
        }
        let radiance = Calibrated { texels: &texels, sightings: &sightings, eyes: &eyes };
        let seeing = (0..texels.count()).map(|texel| sightings.range(texel).len() as u16).collect();
        let Told { mut constant, seen, mirrored, residuals } = match options.model {
            PhotographModel::Light => told(&radiance, &Stage::new(progress, 0.4, 0.98))?,
            PhotographModel::OneView => one_view(&radiance),
        };
        let beyond = beyond(&sphere, views, &exposures, &sightings.pictures, &sightings.beyond);
        fill(&texels, &seen, &mut constant);
        progress.report(1.0);
        Ok(Self {
            tracer: tracer.clone(),
            grid: texels.grid,
            exposures,
            eyes,
            displacements,
            belonging,
            constant,
            seen,
            seeing,
            residuals,
            mirrored,
            sphere,
            beyond,
        })
    }
}

/// What it takes to tell what is where in photographs.
struct Places<'a> {
    texels: &'a Texels,
    views: &'a [View],
    exposures: &'a [Exposure],
    eyes: &'a [DVec3],
}

impl Places<'_> {
    /// How far each photograph is off, and what of it belongs. The sightings are of the photographs as they are afterwards.
    fn told(
        &self,
        sightings: &mut Sightings,
        poses: Poses,
        progress: &dyn Progress,
    ) -> Result<(Vec<Displacement>, Vec<Belonging>), Cancelled> {
        let Self { texels, views, exposures, eyes } = *self;
        let belonging = |sightings: &Sightings, progress: &dyn Progress| {
            odd::belonging(&Calibrated { texels, sightings, eyes }, views, progress)
        };
        let before = belonging(sightings, &Stage::named(progress, "strangers", 0.0, 0.3))?;
        if poses == Poses::Given {
            return Ok((views.iter().map(Displacement::none).collect(), before));
        }
        let aligning = Stage::named(progress, "alignment", 0.3, 1.0);
        let radiance = Calibrated { texels, sightings, eyes };
        let displacements =
            alignment::displacements(&radiance, views, exposures, &before, &Stage::new(&aligning, 0.0, 0.7))?;
        if displacements.iter().all(Displacement::is_none) {
            return Ok((displacements, before));
        }
        sightings.look_again(texels, views, |number, pixel| {
            let displacement = &displacements[number];
            let factor = || exposures[number].to_radiance(&views[number], pixel);
            (!displacement.is_none()).then(|| (displacement.moved(pixel), factor()))
        });
        let after = belonging(sightings, &Stage::new(&aligning, 0.8, 1.0))?;
        Ok((displacements, after))
    }
}
