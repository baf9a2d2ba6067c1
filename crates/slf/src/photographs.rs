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
use odd::Belonging;
use places::{Sphere, TexelGrid};
use scene::SurfacePoint;
use std::sync::Arc;
use telling::{Mirrored, Residuals, is_blocked, toward};
use trace::{Leaving, Radiance, Tracer};

/// Radiance of a surface as photographs of it show it, kept at the texels of an atlas.
pub struct PhotographLight {
    tracer: Arc<Tracer>,
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

impl PhotographLight {
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

    /// What a point that mirrors by `strength` mirrors of the surroundings toward a direction, and its share.
    fn mirrored(&self, point: SurfacePoint, strength: f32, normal: Vec3, outgoing: Vec3) -> (Vec3, f32) {
        if strength <= 0.0 || is_blocked(&self.tracer, point, normal, outgoing) {
            return (Vec3::ZERO, 0.0);
        }
        let light = self.mirrored.sent(normal, outgoing) * strength;
        (light, self.mirrored.share_of(strength, normal, outgoing))
    }

    fn interpolated(&self, point: SurfacePoint, of: impl Fn(usize) -> f32) -> f32 {
        let around = self.grid.around(point);
        around.map_or(0.0, |around| around.iter().map(|&(texel, share)| of(texel as usize) * share).sum())
    }
}

impl Radiance for PhotographLight {
    fn leaving(&self, point: SurfacePoint, eye: DVec3) -> Leaving {
        let Some(around) = self.grid.around(point) else { return Leaving::default() };
        let scene = self.tracer.scene();
        let position = point.position(scene);
        let outgoing = toward(position, eye);
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
                let factor = self.residuals.kernel.between(toward, outgoing);
                if factor > 0.0 {
                    light += residual.alpha() * factor;
                }
            }
            sum += light * share;
            strength += self.mirrored.strength(texel) * share;
        }
        let (carried, carried_share) = self.mirrored(point, strength, normal, outgoing);
        // What was left over may be below 0 where less is mirrored than was thought.
        let own = sum.max(-carried);
        Leaving { own, carried, carried_share, ..Leaving::default() }
    }

    fn from_infinity(&self, direction: DVec3) -> Vec3 {
        let around = self.sphere.around(direction.as_vec3().normalize_or(Vec3::Y));
        around.iter().map(|&(cell, share)| self.beyond[cell] * share).sum()
    }
}
