//! What is asked of a ray through a lens of character.

use super::edges::Edges;
use super::parameters::Character;
use super::rims::{Rim, RimLimit};
use crate::{Aperture, Optics};
use glam::DVec2;

/// Red, green and blue.
pub const CHANNELS: usize = 3;

/// The channel that the others' focus and size are told from.
pub const GREEN: usize = 1;

/// |q₀|² is taken as this at most: beyond eight half-heights from the axis no field curves any more, and κ·z stays finite.
const LARGEST_FIELD: f64 = 64.0;

/// A lens of character, for inner loops: for each colour channel (red, green, blue) the same ray may have another defocus and
/// another place.
///
/// ```text
/// κ_c = κ(t, a; 1/s + C·|q₀|²) + δ_c        δ_c = 1/(d + Δ_c) − 1/d
/// q_c = (1 + m_c)·((x, y)/z + κ_c·U)/tanθ
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CharacterOptics {
    /// The lens without character.
    pub optics: Optics,
    /// Edges.
    pub edges: Edges,
    field_curvature: f64,
    colour_defocus: [f64; CHANNELS],
    magnification: [f64; CHANNELS],
    rims: [Option<Rim>; 2],
    has_cos4_falloff: bool,
}

impl CharacterOptics {
    /// Reduces a valid `character` of a lens with this aperture.
    pub(crate) fn new(optics: Optics, aperture: &Aperture, character: &Character) -> Self {
        let inverse_d = 1.0 / optics.image_distance;
        // 1/(d + Δ) − 1/d without the difference of near numbers.
        let defocus = |shift: f64| -shift * inverse_d / (optics.image_distance + shift);
        let [red, blue] = character.longitudinal_colour.map(defocus);
        let [larger_red, larger_blue] = character.lateral_colour.map(|ratio| 1.0 + ratio);
        let widest_radius = character.widest_radius.unwrap_or(optics.aperture_radius);
        Self {
            optics,
            edges: Edges::new(
                character.edges,
                aperture,
                optics.aperture_radius,
                widest_radius,
                optics.tan_half_yfov,
            ),
            field_curvature: character.field_curvature,
            colour_defocus: [red, 0.0, blue],
            magnification: [larger_red, 1.0, larger_blue],
            rims: character.rims,
            has_cos4_falloff: character.has_cos4_falloff,
        }
    }

    /// Whether colours are focused unlike: whether the channels have to be told apart.
    pub fn has_fringe(&self) -> bool {
        self.colour_defocus != [0.0; CHANNELS] || self.magnification != [1.0; CHANNELS]
    }

    /// Whether there are rims.
    pub fn has_rims(&self) -> bool {
        self.rims.iter().any(Option::is_some)
    }

    /// The largest |ℓ| of a rim, scene units; 0 without rims.
    pub fn farthest_rim(&self) -> f64 {
        self.rims.iter().flatten().fold(0.0, |most: f64, rim| most.max(rim.distance.abs()))
    }

    /// C, 1/length.
    pub fn field_curvature(&self) -> f64 {
        self.field_curvature
    }

    /// δ of each channel, 1/length.
    pub fn colour_defocus(&self) -> [f64; CHANNELS] {
        self.colour_defocus
    }

    /// 1 + m of each channel.
    pub fn magnification(&self) -> [f64; CHANNELS] {
        self.magnification
    }

    /// The lens as it focuses at q₀ = `chief` (half picture heights from the axis): 1/s is 1/s + C·|q₀|².
    #[inline]
    pub fn at(&self, chief: DVec2) -> Optics {
        let inverse_focus_distance = self.optics.inverse_focus_distance + self.curvature_at(chief);
        Optics { inverse_focus_distance, ..self.optics }
    }

    /// C·|q₀|², 1/length; |q₀| counts as 8 at most.
    #[inline]
    pub fn curvature_at(&self, chief: DVec2) -> f64 {
        self.field_curvature * chief.length_squared().min(LARGEST_FIELD)
    }

    /// The largest |C·|q₀|²| for |q₀| up to `chief`.
    pub fn largest_curvature(&self, chief: f64) -> f64 {
        self.field_curvature.abs() * (chief * chief).min(LARGEST_FIELD)
    }

    /// Whether the ray from a point at `chief` (half-heights from the axis) of depth 1/`inverse_depth` through the aperture point `u`
    /// passes all rims.
    #[inline]
    pub fn passes(&self, chief: DVec2, inverse_depth: f64, u: DVec2) -> bool {
        self.limits(chief * self.optics.tan_half_yfov, inverse_depth).all(|limit| limit.passes(u))
    }

    /// Where light of a point at `chief` lands that goes through the aperture point `u` with the defocus κ_c = `kappa` in this channel,
    /// half-heights from the axis.
    #[inline]
    pub fn landing(&self, chief: DVec2, u: DVec2, kappa: f64, channel: usize) -> DVec2 {
        self.magnification[channel] * (chief + kappa * u / self.optics.tan_half_yfov)
    }

    /// The largest |δ|, 1/length.
    pub fn largest_colour_defocus(&self) -> f64 {
        largest(self.colour_defocus)
    }

    /// The largest |m|.
    pub fn largest_lateral(&self) -> f64 {
        largest(self.magnification.map(|size| size - 1.0))
    }

    /// What the rims let through for a point at `slope` (x, y)/z and 1/z = `inverse_depth`.
    #[inline]
    pub fn limits(&self, slope: DVec2, inverse_depth: f64) -> impl Iterator<Item = RimLimit> + Clone + use<> {
        self.rims.into_iter().flatten().map(move |rim| rim.limit(slope, inverse_depth))
    }

    /// What the rims let through of the aperture where the lens focuses: the rays that land at `q` (half-heights from the axis) if
    /// nothing is painted.
    #[inline]
    pub fn limits_in_focus(&self, q: DVec2) -> impl Iterator<Item = RimLimit> + Clone + use<> {
        self.limits(q * self.optics.tan_half_yfov, self.at(q).inverse_focus_distance)
    }

    /// How much of the light arrives at `q` by its angle to the axis: cos⁴ if the lens has that, else 1.
    pub fn angle_falloff(&self, q: DVec2) -> f64 {
        if !self.has_cos4_falloff {
            return 1.0;
        }
        let tangent = q * self.optics.tan_half_yfov;
        (1.0 + tangent.length_squared()).powi(-2)
    }

    /// Whether [`Self::angle_falloff`] is not 1 everywhere.
    pub fn has_angle_falloff(&self) -> bool {
        self.has_cos4_falloff
    }
}

fn largest(values: [f64; CHANNELS]) -> f64 {
    values.into_iter().fold(0.0, |most: f64, x| most.max(x.abs()))
}
