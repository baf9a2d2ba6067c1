//! The space of the box hierarchy, in f32, where no rounding makes a ray miss a box that it meets.
//!
//! Local coordinates are (world − centre of the scene)·2ᵏ so that the scene lies in [−1, 1]³: a scene far
//! from the world's origin loses nothing. Three errors separate the f64 ray from an f32 slab test, each
//! met at its source:
//!
//! * Boxes are rounded outward by one ulp, and by [`BOX_PAD`] for the rounding of the f64 triangle test
//!   itself (a few 2⁻⁵³ of the distance to the ray's origin: sufficient for origins up to 10⁶ scene sizes away).
//! * The ray's origin is stored twice per axis, rounded down and up; each plane is measured from the one that
//!   makes the slab longer. An origin outside of the scene is first moved along the ray (in f64) to where the
//!   scene begins.
//! * The reciprocal direction and the product with it are off by at most 4u relative, u = 2⁻²⁴: far ends are
//!   stretched by [`FAR_STRETCH`] ≥ 1 + 8u.

use crate::Ray;
use glam::{DVec3, Vec3, Vec3A};
use obvhs::aabb::Aabb;

/// Added to every side of a box, local units.
const BOX_PAD: f64 = 1.0 / (1u64 << 32) as f64;
/// What the far end of a slab is multiplied by.
pub(crate) const FAR_STRETCH: f32 = 1.0 + 1.0 / (1u32 << 20) as f32;
/// A ray that starts farther than this from the centre is moved to it: more than the √3 of the cube's corner.
const SCENE_RADIUS: f64 = 2.0;
/// Directions that hardly change along an axis (or not at all) count as changing by this share: 1e-18 of the
/// scene's size, far below [`BOX_PAD`], and its reciprocal is finite.
const SMALLEST_SLOPE: f64 = 1e-18;

/// World to local.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalSpace {
    center: DVec3,
    scale: f64,
}

/// A ray in local space, its direction scaled to a largest component of 1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalRay {
    /// The origin that near planes are measured from.
    pub near_origin: Vec3,
    /// The origin that far planes are measured from.
    pub far_origin: Vec3,
    /// 1/direction.
    pub inverse: Vec3,
    /// Which of [low, high] is the near plane, by axis.
    pub near_side: [usize; 3],
    /// The ray's t at the local origin.
    t_start: f64,
    /// Local t for each t of the ray.
    scale: f64,
}

impl LocalSpace {
    /// The space of a scene that lies between two opposite corners (world); a power of two scales it to [−1, 1]³.
    pub fn enclosing(low: DVec3, high: DVec3) -> Self {
        let center = low * 0.5 + high * 0.5;
        let half = ((high - center).max(center - low)).max_element();
        let scale = if half > 0.0 { (-half.log2().ceil()).exp2() } else { 1.0 };
        Self { center, scale }
    }

    /// A world position in this space, in [−1, 1]³ within the scene.
    pub fn position(&self, world: DVec3) -> DVec3 {
        (world - self.center) * self.scale
    }

    /// A difference of two world positions in this space: scaled, not moved.
    pub fn direction(&self, world: DVec3) -> DVec3 {
        world * self.scale
    }

    /// The box in this space around a triangle with these world corners, padded so that rounding does not lose it.
    pub fn bounds(&self, corners: &[DVec3; 3]) -> Aabb {
        let [a, b, c] = corners.map(|corner| self.position(corner));
        let low = a.min(b).min(c) - BOX_PAD;
        let high = a.max(b).max(c) + BOX_PAD;
        Aabb::new(
            Vec3A::from_array(low.to_array().map(round_down)),
            Vec3A::from_array(high.to_array().map(round_up)),
        )
    }

    /// The ray in this space; `None` if it has no finite, non-zero direction or no extent.
    pub fn ray(&self, ray: &Ray) -> Option<LocalRay> {
        let longest = ray.direction.abs().max_element();
        let scale = longest * self.scale;
        let usable = ray.direction.is_finite() && scale > 0.0 && scale.is_finite() && ray.t_min < ray.t_max;
        if !usable {
            return None;
        }
        let direction = ray.direction / longest;
        let origin = self.position(ray.origin);
        let to_scene =
            (-origin.dot(direction) - SCENE_RADIUS * direction.length()) / direction.length_squared();
        let start = to_scene.max(ray.t_min * scale);
        let origin = origin + direction * start;
        if !origin.is_finite() {
            return None;
        }
        let (mut near_origin, mut far_origin) = ([0.0; 3], [0.0; 3]);
        let (mut inverse, mut near_side) = ([0.0; 3], [0; 3]);
        for axis in 0..3 {
            let (below, above) = (round_down(origin[axis]), round_up(origin[axis]));
            let forward = direction[axis] >= 0.0;
            let slope = direction[axis].abs().max(SMALLEST_SLOPE);
            (near_origin[axis], far_origin[axis]) = if forward { (above, below) } else { (below, above) };
            inverse[axis] = if forward { 1.0 / slope } else { -1.0 / slope } as f32;
            near_side[axis] = usize::from(!forward);
        }
        Some(LocalRay {
            near_origin: near_origin.into(),
            far_origin: far_origin.into(),
            inverse: inverse.into(),
            near_side,
            t_start: start / scale,
            scale,
        })
    }
}

impl LocalRay {
    /// The parameter along the local ray of the parameter `t` of the world's, rounded so that it is not nearer.
    #[inline(always)]
    pub fn local_t(&self, t: f64) -> f32 {
        ((t - self.t_start) * self.scale) as f32 * FAR_STRETCH
    }
}

/// An f32 below `x`, by one to two ulp.
fn round_down(x: f64) -> f32 {
    (x as f32).next_down()
}

/// An f32 above `x`, by one to two ulp.
fn round_up(x: f64) -> f32 {
    (x as f32).next_up()
}
