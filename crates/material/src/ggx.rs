//! Microfacets after Trowbridge and Reitz (GGX), optionally stretched along the tangent. Directions are in the surface's own axes: z is
//! its normal.

use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Surfaces smoother than this α are mirrors: a lobe narrower than a millionth of a radian is one.
pub const SMOOTHEST: f64 = 1e-6;

/// The roughness along the tangent and across it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ggx {
    /// α along x and y.
    alpha: DVec2,
}

impl Ggx {
    /// From a perceptual roughness and an anisotropy strength, both in [0, 1]: α = roughness²; along the tangent it is mixed with 1 by the
    /// square of the strength (KHR_materials_anisotropy).
    pub fn new(roughness: f64, anisotropy: f64) -> Self {
        let across = roughness * roughness;
        let along = across + (1.0 - across) * anisotropy * anisotropy;
        Self { alpha: DVec2::new(along, across) }
    }

    /// Whether the surface is so smooth that it is a mirror.
    pub fn is_smooth(&self) -> bool {
        self.alpha.min_element() < SMOOTHEST
    }

    /// The α that describes the width of lobes: the geometric mean of those of both axes.
    pub fn mean_alpha(&self) -> f64 {
        (self.alpha.x * self.alpha.y).sqrt()
    }

    /// The distribution of normals D: area of microfacets of normal `h`, 1/sr, per unit of surface.
    pub fn density_of_normals(&self, h: DVec3) -> f64 {
        if h.z <= 0.0 {
            return 0.0;
        }
        let stretched = (h.truncate() / self.alpha).length_squared() + h.z * h.z;
        1.0 / (PI * self.alpha.x * self.alpha.y * stretched * stretched)
    }

    /// Smith's Λ: hidden area over visible area.
    fn lambda(&self, w: DVec3) -> f64 {
        let tan2 = (w.truncate() * self.alpha).length_squared() / (w.z * w.z);
        ((1.0 + tan2).sqrt() - 1.0) / 2.0
    }

    /// Smith's masking G₁ (1967): the share, in [0, 1], of microfacets facing the unit direction `w` that is visible
    /// from it.
    pub fn masking(&self, w: DVec3) -> f64 {
        1.0 / (1.0 + self.lambda(w))
    }

    /// Smith's height-correlated G₂: the share that is visible from `o` and from `i`, both on one side.
    pub fn correlated_masking_shadowing(&self, o: DVec3, i: DVec3) -> f64 {
        1.0 / (1.0 + self.lambda(o) + self.lambda(i))
    }

    /// G₁·G₁, uncorrelated: for directions on opposite sides (Walter et al. 2007), and in glTF's appendix B.
    pub fn uncorrelated_masking_shadowing(&self, o: DVec3, i: DVec3) -> f64 {
        self.masking(o) * self.masking(i)
    }

    /// The density, 1/sr, with which normals `h` are visible from `o` (unit, z > 0): Heitz, 2018.
    pub fn density_of_visible(&self, o: DVec3, h: DVec3) -> f64 {
        self.masking(o) * o.dot(h).max(0.0) * self.density_of_normals(h) / o.z
    }

    /// Samples a normal that is visible from `o` (z > 0), from uniform numbers (Dupuy and Benyoub 2023: a spherical
    /// cap, uniformly).
    pub fn visible_normal(&self, o: DVec3, u: DVec2) -> DVec3 {
        let from = DVec3::new(self.alpha.x * o.x, self.alpha.y * o.y, o.z).normalize();
        let z = 1.0 - u.y * (1.0 + from.z);
        let (sin, cos) = (TAU * u.x).sin_cos();
        let flat = (1.0 - z * z).max(0.0).sqrt();
        let cap = DVec3::new(flat * cos, flat * sin, z) + from;
        DVec3::new(self.alpha.x * cap.x, self.alpha.y * cap.y, cap.z.max(0.0)).normalize_or(DVec3::Z)
    }
}
