//! What a glossy surface mirrors: one picture of everything around, found from all photographs at once.
//!
//! What a mirror shows lies far behind it, so that its picture glides over the surface as the eye moves, and photographs of it that are
//! 10° apart cannot be interpolated at the surface. In the mirrored direction they can: all texels and photographs look into the same
//! surroundings.
//!
//! ```text
//! L(x, ω) = D(x) + s(x)·F(n·ω)·V(x, m)·E(m) + …        m = 2(n·ω)n − ω        F(μ) = 0.04 + 0.96·(1 − μ)⁵
//! ```
//!
//! | symbol | meaning | unit |
//! | --- | --- | --- |
//! | D | constant part of texel x | radiance |
//! | s | how glossy the surface is around x, ≥ 0 | 1 |
//! | F | what lacquer, glass and skin mirror (Schlick 1994) | 1 |
//! | V | 0 where the scene itself is in the way, else 1 | 1 |
//! | E | the surroundings as this gloss shows them, at infinity, ≥ 0 | radiance |
//! | n, ω | unit shading normal on the eye's side, direction to the eye | |
//!
//! D and E are found in turns, each the (weighted, robust) mean of what the other leaves. s is the regression of what D leaves on what E
//! tells, over blocks of texels, and 0 where E tells nothing: so a matte surface has no such part.

use super::calibrated::Calibrated;
use super::constant::{Sample, robust_mean};
use super::directions::toward;
use super::reflection::{fresnel, reflection};
use crate::photographs::places::{Blocks, Sphere};
use glam::{DVec3, Vec3};
use progress::{Cancelled, Progress};
use rayon::prelude::*;

/// E and s.
#[derive(Debug, PartialEq)]
pub(crate) struct Mirrored {
    pub sphere: Sphere,
    /// E by cell.
    pub surroundings: Vec<Vec3>,
    /// s by texel.
    pub strength: Vec<f32>,
    /// s by block, all of it whatever share of it is told.
    pub strength_of_block: Vec<f32>,
}

/// Rows of the sphere: 1.4° each, about the sharpest gloss that a mesh's normals leave sharp.
const ROWS: usize = 128;
/// Texels that E is found from.
const ASKED: usize = 50_000;
/// Turns of D and E.
const TURNS: usize = 12;
/// Cells are held at what lies around them as by so much evidence (squared share of light, summed over sightings).
const HOLD: f32 = 0.02;
/// One photograph is no more evidence of a cell than this, however many of its pixels look there.
const MOST_OF_VIEW: f32 = 0.2 * HOLD;
/// No surface mirrors more than this, by F: a metal at normal incidence.
const MOST: f32 = 25.0;

impl Mirrored {
    /// Nothing, of so many texels.
    pub fn none(texels: usize) -> Self {
        let sphere = Sphere::of_rows(1);
        Self {
            sphere,
            surroundings: vec![Vec3::ZERO; sphere.count()],
            strength: vec![0.0; texels],
            strength_of_block: Vec::new(),
        }
    }

    /// Finds what is mirrored, given the constant part without it; also returns the constant part beside it.
    pub fn of(
        radiance: &Calibrated<'_>,
        constant: &[Vec3],
        progress: &dyn Progress,
    ) -> Result<(Self, Vec<Vec3>), Cancelled> {
        let texels = radiance.texels;
        let sphere = Sphere::of_rows(ROWS);
        let step = texels.count().div_ceil(ASKED).max(1);
        let asked: Vec<Asked> = (0..texels.count())
            .into_par_iter()
            .step_by(step)
            .filter_map(|texel| Asked::of(radiance, &sphere, texel, constant[texel]))
            .collect();
        let mut surroundings = vec![Vec3::ZERO; sphere.count()];
        let views = radiance.eyes.len();
        let of = |half: usize| asked.iter().map(|point| point.of_half(half)).collect();
        let halves: [Vec<Vec3>; 2] =
            [found(&sphere, of(0), views, progress)?, found(&sphere, of(1), views, progress)?];
        let surroundings = found(&sphere, asked, views, progress)?;
        let (strength, strength_of_block) = Default::default();
        let mut mirrored = Self { sphere, surroundings, strength, strength_of_block };
        let blocks = Blocks::of(texels.size());
        mirrored.strength_of_block = mirrored.strengths(radiance, constant, &blocks, &halves);
        mirrored.strength = blocks.by_texel(texels, &mirrored.strength_of_block);
        let strength = &mirrored.strength;
        let mut constant = constant.to_vec();
        constant.par_iter_mut().enumerate().filter(|(texel, _)| strength[*texel] > 0.0).for_each_init(
            || (Vec::new(), Vec::new()),
            |(samples, belonging), (texel, constant)| {
                radiance.samples_into(texel, samples);
                let from = texels.position(texel);
                let sightings = radiance.sightings.of_texel(texel);
                for (sample, sighting) in samples.iter_mut().zip(sightings).filter(|(_, s)| !s.is_blocked()) {
                    let outgoing = toward(from, radiance.eye(sighting));
                    sample.light -= mirrored.sent(texels.shading_normal(texel), outgoing) * strength[texel];
                }
                *constant = robust_mean(samples, belonging).max(Vec3::ZERO);
            },
        );
        Ok((mirrored, constant))
    }

    /// The same with less of it: as much of each texel as `share` says, in [0, 1].
    pub fn scaled(mut self, share: &[f32]) -> Self {
        self.strength.iter_mut().zip(share).for_each(|(strength, share)| *strength *= share);
        self
    }

    /// s: how strongly a texel mirrors.
    pub fn strength(&self, texel: usize) -> f32 {
        self.strength.get(texel).copied().unwrap_or(0.0)
    }

    /// What a texel mirrors toward a direction with this normal.
    pub fn at(&self, texel: usize, normal: Vec3, outgoing: Vec3) -> Vec3 {
        match self.strength(texel) {
            strength if strength > 0.0 => self.sent(normal, outgoing) * strength,
            _ => Vec3::ZERO,
        }
    }

    /// How strongly a surface of s mirrors: the share that a mirror at normal incidence would have, [0, 1].
    pub fn share_of(&self, strength: f32, normal: Vec3, outgoing: Vec3) -> f32 {
        (strength * fresnel(normal.dot(outgoing).abs())).min(1.0)
    }

    /// F·E: what a surface of s = 1 mirrors toward a direction with this normal.
    pub fn sent(&self, normal: Vec3, outgoing: Vec3) -> Vec3 {
        let (direction, share) = reflection(normal, outgoing);
        let around = self.sphere.around(direction);
        around.iter().map(|&(cell, weight)| self.surroundings[cell] * weight).sum::<Vec3>() * share
    }

    /// s by block.
    fn strengths(
        &self,
        radiance: &Calibrated<'_>,
        constant: &[Vec3],
        blocks: &Blocks,
        halves: &[Vec<Vec3>; 2],
    ) -> Vec<f32> {
        let texels = radiance.texels;
        // Of what a texel shows and what it should mirror, both less their means: product and square, summed.
        let sums: Vec<(usize, f32, f32)> = (0..texels.count())
            .into_par_iter()
            .filter_map(|texel| {
                let point = Asked::of(radiance, &self.sphere, texel, constant[texel])?;
                let (product, square) = point.covariance(halves);
                Some((blocks.of_texel(texels, texel), product, square))
            })
            .collect();
        let mut joined = vec![(0.0, 0.0); blocks.count()];
        for (block, product, square) in sums {
            joined[block].0 += product;
            joined[block].1 += square;
        }
        blocks.quotients(&joined, [0.0, MOST])
    }
}

/// A texel that E is found from.
struct Asked {
    constant: Vec3,
    seen: Vec<Seen>,
}

#[derive(Clone)]
/// A sample and the cells around its mirrored direction.
struct Seen {
    sample: Sample,
    view: u16,
    is_clipped: bool,
    around: Cells,
    share: f32,
}

/// Four cells and their shares.
type Cells = [(u32, f32); 4];

impl Asked {
    fn of(radiance: &Calibrated<'_>, sphere: &Sphere, texel: usize, constant: Vec3) -> Option<Self> {
        let sightings = radiance.sightings.of_texel(texel);
        if sightings.len() < 3 {
            return None;
        }
        let from: DVec3 = radiance.texels.position(texel);
        let normal = radiance.texels.shading_normal(texel);
        let mut samples = Vec::new();
        radiance.samples_into(texel, &mut samples);
        let seen = samples.iter().zip(sightings).map(|(&sample, sighting)| {
            let (direction, share) = reflection(normal, toward(from, radiance.eye(sighting)));
            let around = sphere.around(direction).map(|(cell, weight)| (cell as u32, weight));
            let share = if sighting.is_blocked() { 0.0 } else { share };
            Seen { sample, view: sighting.view, is_clipped: sighting.clipped() > 0.0, around, share }
        });
        Some(Self { constant, seen: seen.collect() })
    }

    /// The mean of what remains without the surroundings.
    fn without(&self, surroundings: &[Vec3], samples: &mut Vec<Sample>, belonging: &mut Vec<f32>) -> Vec3 {
        samples.clear();
        samples.extend(self.seen.iter().map(|seen| {
            let light = seen.sample.light - seen.mirrored(surroundings);
            seen.sample.with_light(light)
        }));
        robust_mean(samples, belonging).max(Vec3::ZERO)
    }

    /// What is seen by one half of the photographs.
    fn of_half(&self, half: usize) -> Self {
        let seen = self.seen.iter().filter(|seen| half_of(seen.view) == half).cloned().collect();
        Self { constant: self.constant, seen }
    }

    /// Product and square of `strengths`: what each half of the photographs shows, beside what the other half tells.
    fn covariance(&self, halves: &[Vec<Vec3>; 2]) -> (f32, f32) {
        let told: Vec<Vec3> =
            self.seen.iter().map(|seen| seen.mirrored(&halves[1 - half_of(seen.view)])).collect();
        let (mut light, mut mirrored, mut weights) = (Vec3::ZERO, [Vec3::ZERO; 2], [0.0; 2]);
        for (seen, told) in self.seen.iter().zip(&told) {
            let (half, weight) = (half_of(seen.view), seen.sample.counts_at_least());
            light += seen.sample.light * weight;
            mirrored[half] += *told * weight;
            weights[half] += weight;
        }
        light /= weights[0] + weights[1];
        // A half that sees nothing has no mean, and is not asked for it.
        let mirrored = [0, 1].map(|half| mirrored[half] / weights[half].max(f32::MIN_POSITIVE));
        self.seen.iter().zip(&told).fold((0.0, 0.0), |(product, square), (seen, told)| {
            let told = *told - mirrored[half_of(seen.view)];
            let weight = seen.sample.counts_at_least();
            (product + told.dot(seen.sample.light - light) * weight, square + told.length_squared() * weight)
        })
    }
}

impl Seen {
    fn mirrored(&self, surroundings: &[Vec3]) -> Vec3 {
        self.around.iter().map(|&(cell, weight)| surroundings[cell as usize] * weight).sum::<Vec3>()
            * self.share
    }
}

/// Photographs beside each other are of different halves.
fn half_of(view: u16) -> usize {
    usize::from(view) % 2
}

/// E, from what is asked.
fn found(
    sphere: &Sphere,
    mut asked: Vec<Asked>,
    views: usize,
    progress: &dyn Progress,
) -> Result<Vec<Vec3>, Cancelled> {
    let mut by_view = vec![Vec::new(); views];
    for (point, asked) in asked.iter().enumerate() {
        for (number, seen) in asked.seen.iter().enumerate() {
            by_view[usize::from(seen.view)].push((point as u32, number as u32));
        }
    }
    let mut surroundings = vec![Vec3::ZERO; sphere.count()];
    for turn in 0..TURNS {
        progress.check()?;
        progress.report(0.8 * turn as f32 / TURNS as f32);
        surroundings = looked_up(sphere, &asked, &by_view, &surroundings);
        asked.par_iter_mut().for_each_init(
            || (Vec::new(), Vec::new()),
            |(samples, belonging), point| {
                point.constant = point.without(&surroundings, samples, belonging);
            },
        );
    }
    Ok(surroundings)
}

/// E as the constant parts leave it, from what it was.
fn looked_up(sphere: &Sphere, asked: &[Asked], by_view: &[Vec<(u32, u32)>], before: &[Vec3]) -> Vec<Vec3> {
    /// What lies off by this is trusted half, in roots of light.
    const SCALE: f32 = 1.0;
    /// Views that are worked on at once.
    const AT_ONCE: usize = 8;
    let mut sums = vec![(Vec3::ZERO, 0.0f32); sphere.count()];
    for views in by_view.chunks(AT_ONCE) {
        let parts: Vec<Vec<(Vec3, f32)>> = views
            .par_iter()
            .map(|seen| {
                let mut sums = vec![(Vec3::ZERO, 0.0f32); sphere.count()];
                for &(point, number) in seen {
                    let point = &asked[point as usize];
                    let seen = &point.seen[number as usize];
                    let known = seen.mirrored(before);
                    let left = seen.sample.light - point.constant;
                    if seen.is_clipped && known.cmpge(left).all() {
                        continue;
                    }
                    let off = (left - known).length() / (SCALE * (0.05 + point.constant.length()).sqrt());
                    let trust = seen.sample.counts_at_least() * seen.share / (1.0 + off * off);
                    for (cell, weight) in seen.around {
                        let cell = cell as usize;
                        let sum = &mut sums[cell];
                        // Toward the old value: what the other three cells tell is taken away.
                        sum.0 += (left - known + before[cell] * seen.share) * (trust * weight);
                        sum.1 += seen.share * trust * weight;
                    }
                }
                sums
            })
            .collect();
        for part in parts {
            for (sum, (light, weight)) in sums.iter_mut().zip(part) {
                let share = if weight > MOST_OF_VIEW { MOST_OF_VIEW / weight } else { 1.0 };
                sum.0 += light * share;
                sum.1 += weight * share;
            }
        }
    }
    sphere.smoothed(&sums, HOLD).into_iter().map(|light| light.max(Vec3::ZERO)).collect()
}
