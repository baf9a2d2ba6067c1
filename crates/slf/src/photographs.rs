//! Light from photographs: a surface light field whose radiance was photographed.
//!
//! ```text
//! views ─▶ observations (what each photograph shows of each texel) ─▶ exposures ─▶ transients ─▶ alignment ─▶ fitting ─▶ PhotographLight
//! ```
//!
//! The radiance of a texel has three parts: the same toward all directions (`robust_averaging`: a robust mean);
//! mirrored surroundings (`mirrored`: one picture at infinity for all texels; as in Wood et al. 2000, lobes are
//! stationary in the mirrored direction); and a residual toward directions near those of its photographs (`residuals`,
//! interpolated by `directional_regression`). All of them are in `fitting`. Each part is used to the extent that it
//! improves the prediction of left-out photographs. Far from all photographed directions only the first two remain.
//!
//! `solver` runs these steps. `transients` finds what does not belong to the scene, `alignment` the displacements of
//! photographs. `texels` defines where light is stored and at what resolution; `stored` writes it as bytes, `texture`
//! as a picture. `direct` evaluates points in the photographs themselves.

mod alignment;
mod direct;
mod error;
mod exposures;
mod fitting;
mod observations;
mod options;
mod solver;
mod stored;
mod texels;
mod texture;
mod transients;

pub use direct::DirectPhotographs;
pub use error::PhotographError;
pub use exposures::Exposure;
pub use options::{PhotographModel, PhotographOptions, Poses};
pub use texture::LightTexture;

use alignment::Displacement;
use fitting::{Mirrored, Residuals, direction_to_eye, is_reflection_blocked};
use glam::{DVec3, Vec3};
use scene::SurfacePoint;
use std::sync::Arc;
use texels::{DirectionGrid, TexelGrid};
use trace::{OutgoingRadiance, Radiance, Tracer};
use transients::InlierMap;

/// Radiance of a surface as its photographs show it, stored at the texels of an atlas.
///
/// Made by [`PhotographLight::solve`]; evaluated through [`Radiance`].
pub struct PhotographLight {
    tracer: Arc<Tracer>,
    grid: TexelGrid,
    exposures: Vec<Exposure>,
    eyes: Vec<DVec3>,
    /// By view: displacement of the photograph.
    displacements: Vec<Displacement>,
    /// By view: which pixels show the scene rather than a transient object.
    inlier_maps: Vec<InlierMap>,
    /// By texel: view-independent radiance.
    constant: Vec<Vec3>,
    /// By texel: 1 observed, 0 filled in.
    observed_share: Vec<f32>,
    /// By texel: number of photographs that observe it.
    observation_counts: Vec<u16>,
    residuals: Residuals,
    /// Cells at infinity, and the radiance from them.
    sphere: DirectionGrid,
    background: Vec<Vec3>,
    mirrored: Mirrored,
}

impl PhotographLight {
    /// How each photograph renders light, in the order of the views.
    pub fn exposures(&self) -> &[Exposure] {
        &self.exposures
    }

    /// By photograph: the largest displacement applied to align it with the others, px; 0 if it was left unchanged.
    pub fn max_displacements_px(&self) -> Vec<f64> {
        self.displacements.iter().map(Displacement::max_px).collect()
    }

    /// How far a point was observed, in [0, 1]: 1 fully, 0 not at all (its light is filled in from around).
    pub fn observed_share(&self, point: SurfacePoint) -> f32 {
        self.interpolate(point, |texel| self.observed_share[texel])
    }

    /// Number of photographs that observe a point, at least; grazing and occluded views do not count.
    pub fn observation_count(&self, point: SurfacePoint) -> u16 {
        let around = self.grid.around(point).into_iter().flatten();
        around
            .filter(|(_, share)| *share > 0.0)
            .map(|(texel, _)| self.observation_counts[texel as usize])
            .min()
            .unwrap_or(0)
    }

    /// View-independent radiance of a point, linear RGB.
    pub fn constant(&self, point: SurfacePoint) -> Vec3 {
        self.grid.around(point).map_or(Vec3::ZERO, |around| {
            around.iter().map(|&(texel, share)| self.constant[texel as usize] * share).sum()
        })
    }

    /// Mirrored radiance of a point with mirror strength `strength` toward a direction, and the mirrored share.
    fn mirrored_light(
        &self,
        point: SurfacePoint,
        strength: f32,
        normal: Vec3,
        outgoing: Vec3,
    ) -> (Vec3, f32) {
        if strength <= 0.0 || is_reflection_blocked(&self.tracer, point, normal, outgoing) {
            return (Vec3::ZERO, 0.0);
        }
        let light = self.mirrored.unit_light(normal, outgoing) * strength;
        (light, self.mirrored.carried_share(strength, normal, outgoing))
    }

    fn interpolate(&self, point: SurfacePoint, value: impl Fn(usize) -> f32) -> f32 {
        let around = self.grid.around(point);
        around.map_or(0.0, |around| around.iter().map(|&(texel, share)| value(texel as usize) * share).sum())
    }
}

impl Radiance for PhotographLight {
    fn outgoing(&self, point: SurfacePoint, eye: DVec3) -> OutgoingRadiance {
        let Some(around) = self.grid.around(point) else { return OutgoingRadiance::default() };
        let scene = self.tracer.scene();
        let position = point.position(scene);
        let outgoing = direction_to_eye(position, eye);
        let normal = scene.shading_normal(point).as_vec3();
        let (mut sum, mut strength) = (Vec3::ZERO, 0.0);
        for (texel, share) in around {
            if share == 0.0 {
                continue;
            }
            let texel = texel as usize;
            let mut light = self.constant[texel];
            for residual in self.residuals.of_texel(texel) {
                let toward = (self.eyes[usize::from(residual.view)] - position).as_vec3();
                let factor = self.residuals.kernel.between_directions(toward, outgoing);
                if factor > 0.0 {
                    light += residual.alpha() * factor;
                }
            }
            sum += light * share;
            strength += self.mirrored.strength(texel) * share;
        }
        let (carried, carried_share) = self.mirrored_light(point, strength, normal, outgoing);
        // The residual may be negative where less is mirrored than estimated.
        let own = sum.max(-carried);
        OutgoingRadiance { own, carried, carried_share, ..OutgoingRadiance::default() }
    }

    fn environment(&self, direction: DVec3) -> Vec3 {
        let around = self.sphere.around(direction.as_vec3().normalize_or(Vec3::Y));
        around.iter().map(|&(cell, share)| self.background[cell] * share).sum()
    }
}
