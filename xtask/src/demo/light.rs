//! The light of the scene, and the radiance it gives a surface: soft sky, lamps with soft shadows, one
//! bounce, a wet coat.

use super::noise::{hash, smoothstep, spread};
use super::rays::Rays;
use super::surface::{Place, Skin};
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// A glowing ball that lights its surroundings.
#[derive(Clone, Copy)]
pub struct Lamp {
    /// Its centre.
    pub position: Vec3,
    /// Its radius: decides how soft the shadows are.
    pub radius: f32,
    /// Radiant intensity.
    pub intensity: Vec3,
}

/// Appearance of a triangle to rays: mean reflectance and emission.
#[derive(Clone, Copy)]
pub struct Facing {
    /// Reflectance.
    pub albedo: Vec3,
    /// Radiance of its own.
    pub glow: Vec3,
}

/// All light on a surface.
pub struct Lighting<'a> {
    /// The triangles.
    pub rays: &'a Rays,
    /// Their appearance.
    pub facing: &'a [Facing],
    /// The lamps.
    pub lamps: &'a [Lamp],
    /// Position of the camera, for reflections of the wet coat.
    pub eye: Vec3,
    /// Sky rays per texel.
    pub sky_rays: usize,
}

/// The dusk sky in a direction: a last glow low in the west (ahead, to the right), blue above.
pub fn sky(direction: Vec3) -> Vec3 {
    let up = direction.y;
    let west = Vec3::new(0.35, 0.0, -0.94);
    let toward = (direction.dot(west) * 0.5 + 0.5).clamp(0.0, 1.0);
    let zenith = Vec3::new(0.032, 0.066, 0.180);
    let blue = Vec3::new(0.085, 0.165, 0.350);
    let rose = Vec3::new(0.42, 0.20, 0.20);
    let ember = Vec3::new(0.95, 0.42, 0.14);
    let base = blue.lerp(zenith, smoothstep(0.02, 0.65, up));
    let dusk = toward.powi(3);
    let base = base.lerp(rose, dusk * (1.0 - smoothstep(0.02, 0.34, up)) * 0.85);
    base.lerp(ember, dusk * dusk * (1.0 - smoothstep(0.0, 0.17, up)) * 0.85)
}

impl Lighting<'_> {
    /// The outgoing radiance of a point.
    pub fn radiance(&self, place: &Place, skin: &Skin, thin: bool, seed: i32) -> Vec3 {
        let toward_eye = (self.eye - place.position).normalize_or(Vec3::Y);
        let mut normal = skin.normal;
        let mut geometric = place.normal;
        if thin && geometric.dot(toward_eye) < 0.0 {
            (normal, geometric) = (-normal, -geometric);
        }
        let jitter = Vec2::new(hash(seed, 1, 0), hash(seed, 2, 0));
        let mut front = self.irradiance(place.position, normal, geometric, jitter);
        if skin.translucency > 0.0 {
            let back = self.irradiance(place.position, -normal, -geometric, jitter);
            front = front * (1.0 - skin.translucency) + back * skin.translucency;
        }
        let mut radiance = skin.glow + skin.albedo * front / PI;
        if skin.wetness > 0.0 {
            radiance +=
                self.coat(place.position, normal, geometric, toward_eye, skin.ripple, jitter) * skin.wetness;
        }
        radiance
    }

    fn irradiance(&self, position: Vec3, normal: Vec3, geometric: Vec3, jitter: Vec2) -> Vec3 {
        let origin = position + geometric * 4e-4;
        let mut sum = Vec3::ZERO;
        for k in 0..self.sky_rays {
            let direction = hemisphere(normal, (spread(k) + jitter).fract());
            if direction.dot(geometric) > 0.0 {
                sum += self.incoming_radiance(origin, direction, false);
            }
        }
        sum *= PI / self.sky_rays as f32;
        for lamp in self.lamps {
            sum += self.lamp_irradiance(lamp, origin, normal, geometric, jitter);
        }
        sum
    }

    fn lamp_irradiance(
        &self,
        lamp: &Lamp,
        origin: Vec3,
        normal: Vec3,
        geometric: Vec3,
        jitter: Vec2,
    ) -> Vec3 {
        let to = lamp.position - origin;
        let distance2 = to.length_squared();
        let unshadowed = lamp.intensity * (normal.dot(to.normalize()).max(0.0) / distance2);
        // Light below the precision of an 8-bit picture gets no shadow rays.
        if geometric.dot(to) <= 0.0 || unshadowed.max_element() < 2e-3 {
            return Vec3::ZERO;
        }
        let count = if unshadowed.max_element() > 0.1 { 12 } else { 3 };
        let mut open = 0;
        for k in 0..count {
            let target = lamp.position + ball_direction((spread(k) + jitter).fract()) * lamp.radius;
            let to = target - origin;
            let distance = to.length();
            // Lamps stand inside their glass: stop short of it.
            open += usize::from(!self.rays.blocked(origin, to / distance, distance - lamp.radius * 2.5));
        }
        unshadowed * (open as f32 / count as f32)
    }

    /// The light reflected toward the eye by a coat of water.
    fn coat(
        &self,
        position: Vec3,
        normal: Vec3,
        geometric: Vec3,
        toward_eye: Vec3,
        ripple: f32,
        jitter: Vec2,
    ) -> Vec3 {
        let origin = position + geometric * 4e-4;
        let count = self.sky_rays;
        let mut sum = Vec3::ZERO;
        for k in 0..count {
            let s = (spread(k) + jitter).fract();
            // Stretched upright, as on rippled water.
            let tilt = ((1.0 - s.x).ln() * -ripple).sqrt();
            let (sin, cos) = (s.y * TAU).sin_cos();
            let half = (normal + Vec3::new(cos * tilt * 0.7, 0.0, sin * tilt * 1.3)).normalize_or(normal);
            let cosine = half.dot(toward_eye).max(0.0);
            let direction = half * (2.0 * cosine) - toward_eye;
            if direction.dot(geometric) <= 0.0 {
                continue;
            }
            let fresnel = 0.03 + 0.97 * (1.0 - cosine).powi(5);
            // A lone bright bulb in the lobe would be a speck: clamp the contribution of one ray.
            sum += self.incoming_radiance(origin, direction, true).min(Vec3::splat(2.5)) * fresnel;
        }
        sum / count as f32
    }

    fn incoming_radiance(&self, origin: Vec3, direction: Vec3, with_glow: bool) -> Vec3 {
        match self.rays.first(origin, direction, f32::INFINITY) {
            None => sky(direction),
            Some(hit) => {
                let facing = self.facing[hit as usize];
                let bounced = facing.albedo * 0.12;
                // Lamps are summed separately: light brighter than the sky is left to them.
                let counted = with_glow || facing.glow.max_element() <= 1.2;
                if counted { bounced + facing.glow } else { bounced }
            }
        }
    }
}

/// A cosine-weighted direction about a normal.
fn hemisphere(normal: Vec3, s: Vec2) -> Vec3 {
    let (radius, angle) = (s.x.sqrt(), s.y * TAU);
    let (a, b) = normal.any_orthonormal_pair();
    a * (radius * angle.cos()) + b * (radius * angle.sin()) + normal * (1.0 - s.x).max(0.0).sqrt()
}

/// A uniform direction.
fn ball_direction(s: Vec2) -> Vec3 {
    let (z, angle) = (2.0 * s.x - 1.0, s.y * TAU);
    let around = (1.0 - z * z).max(0.0).sqrt();
    Vec3::new(around * angle.cos(), around * angle.sin(), z)
}
