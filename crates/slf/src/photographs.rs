//! Light from photographs: a surface light field whose radiance was photographed.
//!
//! ```text
//! views ─▶ seeing (who sees which texel) ─▶ exposures ─▶ odd ─▶ alignment ─▶ telling ─▶ PhotographLight
//! ```
//!
//! A texel sends what it sends toward all directions (`constant`: a robust mean), what it mirrors of the surroundings (`mirrored`: one
//! picture at infinity for all texels, as in Wood et al. 2000 the mirrored direction is what a lobe stays still in), and what remains
//! toward directions near those of its photographs (`residuals`, interpolated by `directions`; all in `telling`). Each part is there as far
//! as photographs that are left out are told better with it. Where directions are far from all photographs, only the first two remain.
//!
//! `solving` goes this way. `odd` tells what does not belong in photographs, `alignment` where in them things really are. `places` are what light
//! is kept at, and how finely; `stored` has it as bytes, `texture` as a picture. `direct` looks up points in the photographs themselves.

mod alignment;
mod direct;
mod error;
mod exposures;
mod numbers;
mod odd;
mod options;
mod places;
mod seeing;
mod solving;
mod stored;
mod telling;
mod texture;

pub use direct::DirectPhotographs;
pub use error::PhotographError;
pub use exposures::Exposure;
pub use options::{PhotographModel, PhotographOptions, Poses};
pub use texture::LightTexture;

use alignment::Displacement;
use glam::{DVec3, Vec3};
use odd::InlierMap;
use places::{DirectionGrid, TexelGrid};
use scene::SurfacePoint;
use std::sync::Arc;
use telling::{Mirrored, Residuals, direction_to_eye, is_reflection_blocked};
use trace::{OutgoingRadiance, Radiance, Tracer};

/// Radiance of a surface as photographs of it show it, kept at the texels of an atlas.
pub struct PhotographLight {
    tracer: Arc<Tracer>,
    grid: TexelGrid,
    exposures: Vec<Exposure>,
    eyes: Vec<DVec3>,
    /// By view, how far it is off.
    displacements: Vec<Displacement>,
    /// By view, what of it belongs.
    inlier_maps: Vec<InlierMap>,
    /// By texel: what goes toward all directions alike.
    constant: Vec<Vec3>,
    /// By texel, 1 photographed, 0 filled.
    observed_share: Vec<f32>,
    /// By texel, how many photographs see it.
    observation_counts: Vec<u16>,
    residuals: Residuals,
    /// Cells at infinity, and the light from them.
    sphere: DirectionGrid,
    background: Vec<Vec3>,
    mirrored: Mirrored,
}

impl PhotographLight {
    /// How each photograph renders light, by view.
    pub fn exposures(&self) -> &[Exposure] {
        &self.exposures
    }

    /// By photograph, how many pixels it was moved at most to agree with the others; 0 where it is as its camera says.
    pub fn max_displacements_px(&self) -> Vec<f64> {
        self.displacements.iter().map(Displacement::max_px).collect()
    }

    /// How far a point was photographed: 1 it was, 0 it is filled from around.
    pub fn observed_share(&self, point: SurfacePoint) -> f32 {
        self.interpolate(point, |texel| self.observed_share[texel])
    }

    /// How many photographs see a point, at least; glancing and blocked ones not counted.
    pub fn observation_count(&self, point: SurfacePoint) -> u16 {
        let around = self.grid.around(point).into_iter().flatten();
        around
            .filter(|(_, share)| *share > 0.0)
            .map(|(texel, _)| self.observation_counts[texel as usize])
            .min()
            .unwrap_or(0)
    }

    /// What a point sends toward all directions alike.
    pub fn constant(&self, point: SurfacePoint) -> Vec3 {
        self.grid.around(point).map_or(Vec3::ZERO, |around| {
            around.iter().map(|&(texel, share)| self.constant[texel as usize] * share).sum()
        })
    }

    /// What a point that mirrors by `strength` mirrors of the surroundings toward a direction, and its share.
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
        // What was left over may be below 0 where less is mirrored than was thought.
        let own = sum.max(-carried);
        OutgoingRadiance { own, carried, carried_share, ..OutgoingRadiance::default() }
    }

    fn environment(&self, direction: DVec3) -> Vec3 {
        let around = self.sphere.around(direction.as_vec3().normalize_or(Vec3::Y));
        around.iter().map(|&(cell, share)| self.background[cell] * share).sum()
    }
}
