//! Mirror reflections of glossy surfaces: one picture of the surroundings, estimated from all photographs at once.
//!
//! A mirrored object lies far behind the mirror, so its image glides over the surface as the eye moves, and photographs
//! 10° apart cannot be interpolated at the surface. In the mirrored direction they can, because all texels and
//! photographs look into the same surroundings.
//!
//! ```text
//! L(x, ω) = D(x) + s(x)·F(n·ω)·V(x, m)·E(m) + …        m = 2(n·ω)n − ω        F(μ) = 0.04 + 0.96·(1 − μ)⁵
//! ```
//!
//! | symbol | meaning | unit |
//! | --- | --- | --- |
//! | D | constant part of texel x | radiance |
//! | s | mirror strength of the surface around x, ≥ 0 | 1 |
//! | F | Fresnel reflectance of dielectrics (Schlick 1994) | 1 |
//! | V | 0 where the scene occludes the mirrored direction, else 1 | 1 |
//! | E | surroundings at infinity, blurred by the gloss, ≥ 0 | radiance |
//! | n, ω | unit shading normal on the eye's side, direction to the eye | |
//!
//! D and E are estimated in turns ([`Surroundings`]), each as the (weighted, robust) mean of what the other leaves. s
//! is the regression of what one half of the photographs shows on the E of the other half, by blocks of texels: so a
//! matte surface gets no mirrored part, and an object in front of a few photographs is not taken for gloss.

mod surroundings;

use super::calibrated::CalibratedObservations;
use super::directional_regression::direction_to_eye;
use super::reflection::{fresnel, mirror_direction};
use super::robust_averaging::robust_mean;
use crate::photographs::texels::{DirectionGrid, TexelBlocks};
use glam::Vec3;
use progress::{Cancelled, Progress, Stage};
use rayon::prelude::*;
use surroundings::{ReflectionTexel, Surroundings};

/// E and s.
#[derive(Debug, PartialEq)]
pub(crate) struct Mirrored {
    pub sphere: DirectionGrid,
    /// E by cell.
    pub surroundings: Vec<Vec3>,
    /// s by texel, scaled by the share of the block that is modelled as mirrored.
    pub strength: Vec<f32>,
    /// s by block, unscaled.
    pub strength_of_block: Vec<f32>,
}

/// Rows of the grid, 1.4° each: about the sharpest gloss that a mesh's normals allow.
const GRID_ROWS: usize = 128;
/// Upper bound of s: a metal at normal incidence, over F.
const MAX_STRENGTH: f32 = 25.0;

impl Mirrored {
    /// No mirrored part, for this many texels.
    pub fn none(texels: usize) -> Self {
        let sphere = DirectionGrid::with_rows(1);
        Self {
            sphere,
            surroundings: vec![Vec3::ZERO; sphere.count()],
            strength: vec![0.0; texels],
            strength_of_block: Vec::new(),
        }
    }

    /// Fits the mirrored part, given the constant part without it; also returns the constant part beside it.
    ///
    /// # Errors
    /// [`Cancelled`] if `progress` asks to stop.
    pub fn fit(
        calibrated: &CalibratedObservations<'_>,
        constant: &[Vec3],
        progress: &dyn Progress,
    ) -> Result<(Self, Vec<Vec3>), Cancelled> {
        let texels = calibrated.texels;
        let sphere = DirectionGrid::with_rows(GRID_ROWS);
        let solved = Surroundings::solve(calibrated, &sphere, constant, &Stage::new(progress, 0.0, 0.8))?;
        let Surroundings { from_all: surroundings, from_halves: of_halves } = solved;
        let (strength, strength_of_block) = Default::default();
        let mut mirrored = Self { sphere, surroundings, strength, strength_of_block };
        let blocks = TexelBlocks::new(texels.size());
        mirrored.strength_of_block = mirrored.fit_strengths(calibrated, constant, &blocks, &of_halves);
        mirrored.strength = blocks.interpolate_texels(texels, &mirrored.strength_of_block);
        let strength = &mirrored.strength;
        let mut constant = constant.to_vec();
        constant.par_iter_mut().enumerate().filter(|(texel, _)| strength[*texel] > 0.0).for_each_init(
            || (Vec::new(), Vec::new()),
            |(samples, inlier_weights), (texel, constant)| {
                calibrated.collect_samples(texel, samples);
                let from = texels.position(texel);
                let observations = calibrated.observations.of_texel(texel);
                for (sample, observation) in
                    samples.iter_mut().zip(observations).filter(|(_, s)| !s.is_blocked())
                {
                    let outgoing = direction_to_eye(from, calibrated.eye(observation));
                    sample.light -=
                        mirrored.unit_light(texels.shading_normal(texel), outgoing) * strength[texel];
                }
                *constant = robust_mean(samples, inlier_weights).max(Vec3::ZERO);
            },
        );
        Ok((mirrored, constant))
    }

    /// The same with the strength of each texel scaled by its `share`, in [0, 1].
    pub fn scaled(mut self, share: &[f32]) -> Self {
        self.strength.iter_mut().zip(share).for_each(|(strength, share)| *strength *= share);
        self
    }

    /// The strength s of a texel's mirrored part, a factor of Fresnel's reflectance; 0 if it has none.
    pub fn strength(&self, texel: usize) -> f32 {
        self.strength.get(texel).copied().unwrap_or(0.0)
    }

    /// Mirrored radiance of a texel, linear RGB, toward a unit direction, for this unit normal.
    pub fn light(&self, texel: usize, normal: Vec3, outgoing: Vec3) -> Vec3 {
        match self.strength(texel) {
            strength if strength > 0.0 => self.unit_light(normal, outgoing) * strength,
            _ => Vec3::ZERO,
        }
    }

    /// The share of light that is mirrored, in [0, 1], for the strength s, unit normal and unit direction.
    pub fn carried_share(&self, strength: f32, normal: Vec3, outgoing: Vec3) -> f32 {
        (strength * fresnel(normal.dot(outgoing).abs())).min(1.0)
    }

    /// F·E: mirrored radiance, linear RGB, for s = 1 toward a unit direction, for this unit normal.
    pub fn unit_light(&self, normal: Vec3, outgoing: Vec3) -> Vec3 {
        let (direction, share) = mirror_direction(normal, outgoing);
        let around = self.sphere.around(direction);
        around.iter().map(|&(cell, weight)| self.surroundings[cell] * weight).sum::<Vec3>() * share
    }

    /// Fits s by block.
    fn fit_strengths(
        &self,
        calibrated: &CalibratedObservations<'_>,
        constant: &[Vec3],
        blocks: &TexelBlocks,
        halves: &[Vec<Vec3>; 2],
    ) -> Vec<f32> {
        let texels = calibrated.texels;
        // By texel: covariance of observed and mirrored light, and variance of mirrored light, unnormalised.
        let sums: Vec<(usize, f32, f32)> = (0..texels.count())
            .into_par_iter()
            .filter_map(|texel| {
                let point = ReflectionTexel::new(calibrated, &self.sphere, texel, constant[texel])?;
                let (product, square) = point.covariance(halves);
                Some((blocks.block_of(texels, texel), product, square))
            })
            .collect();
        let mut block_sums = vec![(0.0, 0.0); blocks.count()];
        for (block, product, square) in sums {
            block_sums[block].0 += product;
            block_sums[block].1 += square;
        }
        blocks.quotients(&block_sums, [0.0, MAX_STRENGTH])
    }
}
