//! Emissive surfaces as area lights.

use crate::point_random::draw;
use glam::{DVec2, DVec3, Vec3};
use scene::{Scene, SurfacePoint};

/// The triangles that light others, chosen in proportion to the power they send.
#[derive(Debug, Default)]
pub(crate) struct Emitters {
    triangles: Vec<Emitter>,
    /// Running sums of their shares; the last is 1.
    cumulative: Vec<f64>,
}

#[derive(Clone, Copy, Debug)]
struct Emitter {
    triangle: u32,
    area: f64,
    /// Unit, on its counter-clockwise side.
    normal: DVec3,
    both_sides: bool,
    /// Its probability.
    share: f64,
}

/// A place on an emitter, seen from a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EmitterSample {
    /// The place.
    pub position: DVec3,
    /// Unit direction toward it.
    pub from: DVec3,
    /// Irradiance on a surface that faces it, were nothing in between; the mean over samples is that of all
    /// emitters.
    pub irradiance: Vec3,
}

/// 1/g and 1/g² of the golden ratio's generalisation g³ = g + 1: steps of a low-discrepancy sequence (Roberts
/// 2018).
const STEPS: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3];

impl Emitters {
    /// The emissive triangles of a scene. Unlit ones are not: their radiance is a picture, not light.
    pub fn of(scene: &Scene) -> Self {
        let mut triangles = Vec::new();
        let mut sums = Vec::new();
        let mut sum = 0.0;
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
                    sum += power;
                    sums.push(sum);
                    let normal = area_normal.normalize();
                    let both_sides = material.double_sided;
                    triangles.push(Emitter { triangle, area, normal, both_sides, share: power });
                }
            }
        }
        triangles.iter_mut().for_each(|emitter| emitter.share /= sum);
        Self { triangles, cumulative: sums.into_iter().map(|running| running / sum).collect() }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// `count` places on the emitters for a surface point, stratified over all emitters' power and well
    /// spread on each. Deterministic: the same for the same point. Places that send nothing to the point are
    /// left out, so divide by `count`.
    pub fn samples<'a>(
        &'a self,
        scene: &'a Scene,
        point: SurfacePoint,
        count: u32,
    ) -> impl Iterator<Item = EmitterSample> + 'a {
        let position = point.position(scene);
        let [select, a, b] = draw(point);
        (0..count).filter_map(move |k| {
            let u = (f64::from(k) + select) / f64::from(count);
            let chosen = self.cumulative.partition_point(|&end| end <= u).min(self.triangles.len() - 1);
            let emitter = &self.triangles[chosen];
            let place =
                DVec2::new((a + f64::from(k) * STEPS[0]).fract(), (b + f64::from(k) * STEPS[1]).fract());
            let place = SurfacePoint { triangle: emitter.triangle, barycentric: uniform_barycentric(place) };
            let target = place.position(scene);
            let toward = target - position;
            let from = toward.normalize_or_zero();
            let facing = -from.dot(emitter.normal);
            let facing = if emitter.both_sides { facing.abs() } else { facing };
            if facing <= 0.0 || emitter.triangle == point.triangle {
                return None;
            }
            // L·cosθ'/r² dA over its probability density, share/area.
            let weight = facing / toward.length_squared() * emitter.area / emitter.share;
            Some(EmitterSample { position: target, from, irradiance: scene.emitted(place) * weight as f32 })
        })
    }
}

/// The mean luminance that a triangle emits. A hundredth of its peak is added, so that no lit texel has
/// probability 0 just because the few texels looked at here are dark.
fn mean_emission(scene: &Scene, triangle: u32) -> f64 {
    const SIDE: u32 = 8;
    let luminance = |rgb: Vec3| f64::from(rgb.dot(Vec3::new(0.2126, 0.7152, 0.0722)));
    let peak = luminance(scene.material_of(triangle).emissive);
    if scene.material_of(triangle).emissive_texture.is_none() {
        return peak;
    }
    let cells = (0..SIDE * SIDE).map(|k| DVec2::new(f64::from(k % SIDE), f64::from(k / SIDE)) + 0.5);
    let points = cells.map(|cell| uniform_barycentric(cell / f64::from(SIDE)));
    let sum: f64 =
        points.map(|barycentric| luminance(scene.emitted(SurfacePoint { triangle, barycentric }))).sum();
    sum / f64::from(SIDE * SIDE) + 0.01 * peak
}

/// The unit square onto the triangle, area for area (Heitz 2019): no fold, so spread points stay spread.
fn uniform_barycentric(u: DVec2) -> DVec2 {
    if u.y > u.x { DVec2::new(0.5 * u.x, u.y - 0.5 * u.x) } else { DVec2::new(u.x - 0.5 * u.y, 0.5 * u.y) }
}
