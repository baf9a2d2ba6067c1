//! Emissive surfaces as area lights.

use crate::light_tree::{LightBounds, LightTree};
use glam::{DVec2, DVec3, Vec3};
use numerics::luminance;
use scene::{Scene, SurfacePoint};
use std::collections::HashMap;

/// The emissive triangles that light other surfaces, sampled by how much of their power may arrive ([`LightTree`]).
#[derive(Debug, Default)]
pub(crate) struct Emitters {
    triangles: Vec<Emitter>,
    /// Index into `triangles` by triangle of the scene.
    triangle_indices: HashMap<u32, u32>,
    tree: LightTree,
}

#[derive(Clone, Copy, Debug)]
struct Emitter {
    triangle: u32,
    area: f64,
    /// Unit normal of the counter-clockwise side.
    normal: DVec3,
    both_sides: bool,
}

/// A sampled point on an emitter, as a position receives it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EmitterSample {
    /// World position of the sampled point.
    pub place: DVec3,
    /// Unit direction toward it.
    pub direction: DVec3,
    /// Radiance the point sends toward the position, ignoring occlusion.
    pub radiance: Vec3,
    /// Probability density of the direction, 1/sr.
    pub density: f64,
}

impl Emitters {
    /// Collects the emissive triangles of a scene. Unlit triangles are left out: their radiance is a picture, not
    /// light.
    pub fn from_scene(scene: &Scene) -> Self {
        let (mut triangles, mut lights) = (Vec::new(), Vec::new());
        for part in &scene.parts {
            let material = &scene.materials[part.material as usize];
            if material.unlit || material.emissive == Vec3::ZERO {
                continue;
            }
            for triangle in part.triangles.clone() {
                let area_normal = scene.area_normal(triangle);
                let area = area_normal.length() / 2.0;
                let sides = if material.double_sided { 2.0 } else { 1.0 };
                let power = area * sides * mean_emission(scene, triangle);
                if power > 0.0 && power.is_finite() {
                    let (normal, both_sides) = (area_normal.normalize(), material.double_sided);
                    triangles.push(Emitter { triangle, area, normal, both_sides });
                    let corners = scene.corners(triangle);
                    let low = corners.into_iter().fold(DVec3::INFINITY, DVec3::min);
                    let high = corners.into_iter().fold(DVec3::NEG_INFINITY, DVec3::max);
                    lights.push(LightBounds { low, high, normal, both_sides, power });
                }
            }
        }
        let triangle_indices =
            (0..).zip(&triangles).map(|(place, emitter)| (emitter.triangle, place)).collect();
        Self { triangles, triangle_indices, tree: LightTree::new(&lights) }
    }

    /// Whether the scene has no emitters.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// Samples a point on an emitter from uniform numbers, for light arriving at `position`. `None` if the sampled
    /// point sends nothing there.
    pub fn sample(&self, scene: &Scene, position: DVec3, choice: f64, u: [f64; 2]) -> Option<EmitterSample> {
        let (chosen, share) = self.tree.draw(position, choice)?;
        let emitter = &self.triangles[chosen];
        let barycentric = uniform_barycentric(DVec2::from_array(u));
        let point = SurfacePoint { triangle: emitter.triangle, barycentric };
        let place = point.position(scene);
        let toward = place - position;
        let direction = toward.try_normalize()?;
        let density = share * emitter.density(toward)?;
        Some(EmitterSample { place, direction, radiance: scene.emitted_radiance(point), density })
    }

    /// Density, 1/sr, with which [`Self::sample`] chooses `place` on `triangle` from `position`; 0 if the triangle is
    /// not an emitter.
    pub fn density(&self, triangle: u32, place: DVec3, position: DVec3) -> f64 {
        let Some(&number) = self.triangle_indices.get(&triangle) else { return 0.0 };
        let area_density = self.triangles[number as usize].density(place - position);
        area_density.map_or(0.0, |density| density * self.tree.probability(position, number as usize))
    }
}

impl Emitter {
    /// Reciprocal of the solid angle that the whole emitter would subtend if it lay at `toward`; `None` where that
    /// point sends nothing.
    fn density(&self, toward: DVec3) -> Option<f64> {
        let r2 = toward.length_squared();
        let facing = -toward.dot(self.normal) / r2.sqrt();
        let facing = if self.both_sides { facing.abs() } else { facing };
        (facing > 0.0).then(|| r2 / (self.area * facing))
    }
}

/// Mean luminance emitted by a triangle. A hundredth of its peak is added so that no lit texel gets probability 0
/// merely because the few texels examined here are dark.
fn mean_emission(scene: &Scene, triangle: u32) -> f64 {
    const SIDE: u32 = 8;
    let luminance = |rgb: Vec3| f64::from(luminance(rgb.to_array()));
    let peak = luminance(scene.material_of(triangle).emissive);
    if scene.material_of(triangle).emissive_texture.is_none() {
        return peak;
    }
    let cells = (0..SIDE * SIDE).map(|k| DVec2::new(f64::from(k % SIDE), f64::from(k / SIDE)) + 0.5);
    let points = cells.map(|cell| uniform_barycentric(cell / f64::from(SIDE)));
    let sum: f64 = points
        .map(|barycentric| luminance(scene.emitted_radiance(SurfacePoint { triangle, barycentric })))
        .sum();
    sum / f64::from(SIDE * SIDE) + 0.01 * peak
}

/// Maps the unit square to barycentric coordinates, preserving area (Heitz 2019). The map has no fold, so
/// well-distributed points stay well distributed.
pub(crate) fn uniform_barycentric(u: DVec2) -> DVec2 {
    if u.y > u.x { DVec2::new(0.5 * u.x, u.y - 0.5 * u.x) } else { DVec2::new(u.x - 0.5 * u.y, 0.5 * u.y) }
}
