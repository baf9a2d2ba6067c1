//! Light from photographs: a surface light field whose radiance was photographed.
//!
//! ```text
//! views ─▶ kept_picture ─┐
//!    └──▶ depth_picture ─┴▶ sightings ─▶ gains ─▶ odd ─▶ alignment ─▶ constant ─▶ mirrored ─▶ residuals ─▶ PhotographLight
//!                           (by texel)     └▶ beyond                   └▶ filling             └ directions
//! ```
//!
//! A texel sends what it sends toward all directions (`constant`: a robust mean), what it mirrors of the surroundings (`mirrored`: one
//! picture at infinity for all texels, as in Wood et al. 2000 the mirrored direction is what a lobe stays still in), and what remains
//! toward directions near those of its photographs (`residuals`, interpolated by `directions`). Each part is there as far as photographs
//! that are left out are told better with it. Where directions are far from all photographs, only the first two remain.
//!
//! `budget` decides how fine all is kept, `stored` has it as bytes. `direct` looks up points in the
//! photographs themselves; `reading` reads these, `odd` tells what does not belong in them, `alignment` where in them things really are. `blocks` has numbers that change slowly over the atlas, `sphere` those that go with direction.

mod alignment;
mod beyond;
mod blocks;
mod budget;
mod calibrated;
mod constant;
mod depth_picture;
mod direct;
mod directions;
mod error;
mod filling;
mod gains;
mod kept_picture;
mod median;
mod mirrored;
mod odd;
mod one_view;
mod positive;
mod ramp;
mod reading;
mod residuals;
mod sightings;
mod sphere;
mod stored;
mod texels;
mod texture;
mod told;

pub use direct::DirectPhotographs;
pub use error::PhotographError;
pub use gains::Exposure;
pub use texture::LightTexture;

use alignment::Displacement;
use atlas::Atlas;
use budget::Budget;
use calibrated::Calibrated;
use directions::toward;
use glam::{DVec3, Vec3};
use mirrored::Mirrored;
use odd::Belonging;
use progress::{Cancelled, Progress, Stage};
use reading::Reading;
use residuals::Residuals;
use scene::{LoadOptions, Scene, SurfacePoint, View};
use sightings::Sightings;
use sphere::Sphere;
use std::sync::Arc;
use texels::{TexelGrid, Texels};
use told::{Told, told};
use trace::{Leaving, Radiance, Tracer};

/// How light is made from photographs.
#[derive(Clone, Debug, PartialEq)]
pub struct PhotographOptions {
    /// Limits for each picture.
    pub load: LoadOptions,
    /// What is told of a texel.
    pub model: PhotographModel,
    /// How far poses are believed.
    pub poses: Poses,
    /// Bytes that the work may hold at once, the scene, its hierarchy and the atlas not counted. Photographs and texels are made coarser
    /// where they would not fit.
    pub max_memory: u64,
}

impl Default for PhotographOptions {
    /// 1.6 GiB.
    fn default() -> Self {
        Self {
            load: LoadOptions::default(),
            model: PhotographModel::default(),
            poses: Poses::default(),
            max_memory: 1600 << 20,
        }
    }
}

/// What light from photographs tells of a texel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PhotographModel {
    /// All that the photographs carry.
    #[default]
    Light,
    /// The colour of the one photograph that sees it finest, toward all directions alike: what texturing tools make of a capture, to
    /// compare with.
    OneView,
}

/// How far the poses of photographs, and the surface, are believed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Poses {
    /// To a few pixels: photographs are aligned with each other where that has them agree better.
    #[default]
    Aligned,
    /// As they are given. What texturing tools are compared by, [`PhotographModel::OneView`], always believes that.
    Given,
}

/// Radiance of a surface as photographs of it show it, kept at the texels of an atlas.
pub struct PhotographLight {
    scene: Arc<Scene>,
    grid: TexelGrid,
    exposures: Vec<Exposure>,
    eyes: Vec<DVec3>,
    /// By view, how far it is off.
    displacements: Vec<Displacement>,
    /// By view, what of it belongs.
    belonging: Vec<Belonging>,
    /// By texel: what goes toward all directions alike.
    constant: Vec<Vec3>,
    /// By texel, 1 photographed, 0 filled.
    seen: Vec<f32>,
    /// By texel, how many photographs see it.
    seeing: Vec<u16>,
    residuals: Residuals,
    /// Cells at infinity, and the light from them.
    sphere: Sphere,
    beyond: Vec<Vec3>,
    mirrored: Mirrored,
}

/// Rows of the cells at infinity, 0.35° each: some pixels of a photograph.
const SPHERE_ROWS: usize = 512;

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
        let stage = |name, from, to| Stage::named(progress, name, from, to);
        let sphere = Sphere::of_rows(SPHERE_ROWS);
        let budget = Budget::of(scene, atlas, views, options.max_memory);
        let texels = Texels::of(scene, atlas, budget.texel_scale);
        progress.check()?;
        let reading = Reading { load: &options.load, reduction: budget.reduction, at_once: budget.at_once };
        let mut sightings =
            Sightings::of(scene, &texels, &sphere, views, &reading, &stage("photographs", 0.0, 0.25))?;
        let exposures =
            gains::exposures(&texels, &sightings, &sphere, views, &stage("exposures", 0.25, 0.33))?;
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
        let radiance = Calibrated { texels: &texels, sightings: &sightings, eyes: &eyes };
        let seeing = (0..texels.count()).map(|texel| sightings.range(texel).len() as u16).collect();
        let Told { mut constant, seen, mirrored, residuals } = match options.model {
            PhotographModel::Light => told(&radiance, &Stage::new(progress, 0.4, 0.98))?,
            PhotographModel::OneView => one_view::told(&radiance),
        };
        let beyond = beyond::beyond(&sphere, views, &exposures, &sightings.pictures, &sightings.beyond);
        filling::fill(&texels, &seen, &mut constant);
        progress.report(1.0);
        Ok(Self {
            scene: scene.clone(),
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

    /// How each photograph renders light, by view.
    pub fn exposures(&self) -> &[Exposure] {
        &self.exposures
    }

    /// By photograph, how many pixels it was moved at most to agree with the others; 0 where it is as its camera says.
    pub fn moved_px(&self) -> Vec<f64> {
        self.displacements.iter().map(Displacement::most).collect()
    }

    /// How far a point was photographed: 1 it was, 0 it is filled from around.
    pub fn seen(&self, point: SurfacePoint) -> f32 {
        self.interpolated(point, |texel| self.seen[texel])
    }

    /// How many photographs see a point, at least; glancing and blocked ones not counted.
    pub fn seeing(&self, point: SurfacePoint) -> u16 {
        let around = self.grid.around(point).into_iter().flatten();
        around
            .filter(|(_, share)| *share > 0.0)
            .map(|(texel, _)| self.seeing[texel as usize])
            .min()
            .unwrap_or(0)
    }

    /// What a point sends toward all directions alike.
    pub fn constant(&self, point: SurfacePoint) -> Vec3 {
        self.grid.around(point).map_or(Vec3::ZERO, |around| {
            around.iter().map(|&(texel, share)| self.constant[texel as usize] * share).sum()
        })
    }

    fn interpolated(&self, point: SurfacePoint, of: impl Fn(usize) -> f32) -> f32 {
        let around = self.grid.around(point);
        around.map_or(0.0, |around| around.iter().map(|&(texel, share)| of(texel as usize) * share).sum())
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

impl Radiance for PhotographLight {
    fn leaving(&self, point: SurfacePoint, eye: DVec3) -> Leaving {
        let Some(around) = self.grid.around(point) else { return Leaving::default() };
        let position = point.position(&self.scene);
        let outgoing = toward(position, eye);
        let normal = self.scene.shading_normal(point).as_vec3();
        let (mut sum, mut mirrored, mut carried_share) = (Vec3::ZERO, 0.0, 0.0);
        for (texel, share) in around {
            if share == 0.0 {
                continue;
            }
            let texel = texel as usize;
            let mut light = self.constant[texel];
            for residual in self.residuals.of_texel(texel) {
                let toward = (self.eyes[usize::from(residual.view)] - position).as_vec3();
                let factor = self.residuals.kernel.between(toward, outgoing);
                if factor > 0.0 {
                    light += residual.alpha() * factor;
                }
            }
            sum += light * share;
            let strength = self.mirrored.strength(texel);
            mirrored += strength * share;
            carried_share += self.mirrored.share_of(strength, normal, outgoing) * share;
        }
        let carried =
            if mirrored > 0.0 { self.mirrored.sent(normal, outgoing) * mirrored } else { Vec3::ZERO };
        // What was left over may be below 0 where less is mirrored than was thought.
        let own = sum.max(-carried);
        Leaving { own, carried, carried_share, ..Leaving::default() }
    }

    fn from_infinity(&self, direction: DVec3) -> Vec3 {
        let around = self.sphere.around(direction.as_vec3().normalize_or(Vec3::Y));
        around.iter().map(|&(cell, share)| self.beyond[cell] * share).sum()
    }
}
