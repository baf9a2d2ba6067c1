//! The brush: what a dab does to the texels under it.

use crate::painting::symmetry::are_world_axes;
use crate::{Curve, Symmetry, WORLD_AXES};
use lens::FocusOffset;
use numerics::smooth_fraction;
use serde::{Deserialize, Serialize};

/// How a brush paints.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Brush {
    /// Radius of a dab's sphere, world units, > 0.
    pub radius: f64,
    /// Fraction of the radius within which a dab has its full strength, in [0, 1]; beyond it the strength fades
    /// smoothly.
    pub hardness: f64,
    /// A drawn falloff: the fraction of a dab's strength, in [0, 1], over the distance as a fraction of the radius.
    /// If present, `hardness` is ignored.
    pub drawn_falloff: Option<Curve>,
    /// Maximum effect of a stroke (or, in modes where dabs accumulate, of a dab), in [0, 1].
    pub strength: f64,
    /// Fraction of `strength` that a single dab applies, in (0, 1]: below 1 a stroke builds up where dabs overlap.
    pub flow: f64,
    /// Distance between dabs as a fraction of the radius, in [0.01, 10].
    pub spacing: f64,
    /// What it does.
    pub mode: BrushMode,
    /// The value that is set; for adding and subtracting, its t − 1, anchor and gloss are what a full dab adds.
    #[serde(with = "FocusOffsetFields")]
    pub target: FocusOffset,
    /// Offset from each painted point to the point that cloning copies the focus from; world units.
    pub clone_offset: [f64; 3],
    /// Which of the three numbers the brush changes.
    pub channels: Channels,
    /// Range to which adding and subtracting clamp t: lowest, highest.
    pub offset_limits: [f64; 2],
    /// Largest angle, in degrees, between the normal under the pen and that of a painted texel: 90 keeps paint from
    /// going through a thin wall; 180 paints all sides.
    pub normal_limit_degrees: f64,
    /// Whether every dab is also painted mirrored: left and right (x), up and down (y), front and back (z), about
    /// `mirror_center`. Several axes together give all combinations.
    pub mirror: [bool; 3],
    /// How many times every dab is painted around the vertical axis through `mirror_center`, in [1, 64]; 1 means no
    /// repetition.
    pub radial: u32,
    /// Centre of mirroring and rotation, world space.
    pub mirror_center: [f64; 3],
    /// Axes of mirroring and rotation: orthogonal unit directions in world space.
    #[serde(skip_serializing_if = "are_world_axes")]
    pub mirror_axes: [[f64; 3]; 3],
    /// Whether centre and axes are taken from the object under the pen at the start of each stroke or fill.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub mirror_by_object: bool,
    /// How much a light pen weakens a dab: 0 not at all, 1 down to nothing.
    pub pressure_to_strength: f64,
    /// How much a light pen shrinks a dab: 0 not at all, 1 down to nothing.
    pub pressure_to_radius: f64,
}

/// What a brush does to the texels under it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum BrushMode {
    /// Moves them to the target. Dabs of one stroke do not accumulate: the strength is a ceiling.
    #[default]
    Set,
    /// Adds t − 1, anchor and gloss of the target; dabs accumulate.
    Add,
    /// Subtracts t − 1, anchor and gloss of the target; dabs accumulate.
    Subtract,
    /// Evens out differences; dabs accumulate.
    Smooth,
    /// Makes ramps steeper, up to a step; dabs accumulate.
    Sharpen,
    /// Copies the values that lay `clone_offset` away when the stroke began. Otherwise as [`Self::Set`].
    Clone,
    /// Moves them back to the standard lens; on a map with a mask, erases the mask. Otherwise as [`Self::Set`].
    Reset,
}

/// Which of a texel's numbers are changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Channels {
    /// Only t.
    T,
    /// Only the anchor.
    Anchor,
    /// Only gloss: how far glossy light obeys t and the anchor.
    Gloss,
    /// All three.
    #[default]
    #[serde(rename = "both")]
    All,
    /// None of them, only the layer's mask.
    Mask,
}

impl Channels {
    /// Whether t, the anchor, gloss and the mask are changed. Painting a layer always paints its mask as well.
    pub fn write_flags(self) -> [bool; 4] {
        let [t, anchor, gloss] =
            [Self::T, Self::Anchor, Self::Gloss].map(|own| self == own || self == Self::All);
        [t, anchor, gloss, true]
    }
}

/// What the pen reports besides its position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PenSample {
    /// Pressure in [0, 1]; a mouse counts as 1.
    pub pressure: f64,
}

impl Default for PenSample {
    fn default() -> Self {
        Self { pressure: 1.0 }
    }
}

impl Default for Brush {
    /// A brush that paints sharp focus with a soft edge.
    fn default() -> Self {
        Self {
            radius: 0.1,
            hardness: 0.5,
            drawn_falloff: None,
            strength: 1.0,
            flow: 1.0,
            spacing: 0.25,
            mode: BrushMode::Set,
            target: FocusOffset::SHARP,
            clone_offset: [0.0; 3],
            channels: Channels::All,
            offset_limits: [0.0, 2.0],
            normal_limit_degrees: 90.0,
            mirror: [false; 3],
            radial: 1,
            mirror_center: [0.0; 3],
            mirror_axes: WORLD_AXES,
            mirror_by_object: false,
            pressure_to_strength: 1.0,
            pressure_to_radius: 0.0,
        }
    }
}

impl Brush {
    /// What is wrong with the first invalid setting, as a sentence for the user; `None` if all are valid.
    pub fn problem(&self) -> Option<&'static str> {
        let unit = 0.0..=1.0;
        let [low, high] = self.offset_limits;
        match () {
            _ if !(self.radius > 0.0 && self.radius.is_finite()) => Some("radius must be above 0 and finite"),
            _ if !unit.contains(&self.hardness) => Some("hardness must be in [0, 1]"),
            _ if self.drawn_falloff.as_ref().is_some_and(|curve| !is_falloff(curve)) => {
                Some("drawn_falloff must be a curve within [0, 1]")
            }
            _ if !unit.contains(&self.strength) => Some("strength must be in [0, 1]"),
            _ if !(self.flow > 0.0 && self.flow <= 1.0) => Some("flow must be above 0 and at most 1"),
            _ if !(0.01..=10.0).contains(&self.spacing) => Some("spacing must be in [0.01, 10]"),
            _ if !self.target.is_valid() => Some("target needs a finite t, an anchor and a gloss in [0, 1]"),
            _ if !(low <= high && low.is_finite() && high.is_finite()) => {
                Some("offset_limits must be finite, the lower one first")
            }
            _ if !(0.0..=180.0).contains(&self.normal_limit_degrees) => {
                Some("normal_limit_degrees must be in [0, 180]")
            }
            _ if !self.clone_offset.iter().all(|x| x.is_finite()) => Some("clone_offset must be finite"),
            _ if !self.symmetry().is_valid() => Some(
                "mirror_center must be finite, mirror_axes at right angles and of length 1, radial in [1, 64]",
            ),
            _ if !unit.contains(&self.pressure_to_strength) => Some("pressure_to_strength must be in [0, 1]"),
            _ if !unit.contains(&self.pressure_to_radius) => Some("pressure_to_radius must be in [0, 1]"),
            _ => None,
        }
    }

    /// The stroke's name in the undo list.
    pub fn stroke_name(&self) -> &'static str {
        match self.mode {
            BrushMode::Set => "Brush stroke",
            BrushMode::Add => "Add stroke",
            BrushMode::Subtract => "Subtract stroke",
            BrushMode::Smooth => "Smooth stroke",
            BrushMode::Sharpen => "Sharpen stroke",
            BrushMode::Clone => "Clone stroke",
            BrushMode::Reset => "Reset stroke",
        }
    }

    /// Fraction of a dab's strength at `distance` (a fraction of the radius): from the drawn falloff, or 1 up to the
    /// hardness and from there smoothly (3s² − 2s³) down to 0 at the rim. 0 beyond the rim.
    pub fn falloff(&self, distance: f64) -> f64 {
        if distance > 1.0 {
            0.0
        } else if let Some(curve) = &self.drawn_falloff {
            curve.evaluate(distance)
        } else if distance <= self.hardness {
            1.0
        } else {
            smooth_fraction((1.0 - distance) / (1.0 - self.hardness))
        }
    }

    /// The symmetry with which every dab, fill and gradient is repeated.
    pub fn symmetry(&self) -> Symmetry {
        Symmetry {
            mirror: self.mirror,
            radial: self.radial,
            center: self.mirror_center,
            axes: self.mirror_axes,
        }
    }

    /// Whether it changes gloss, which older versions of the program do not support.
    pub fn paints_gloss(&self) -> bool {
        self.target.gloss != 0.0 || self.channels == Channels::Gloss
    }

    /// Whether it uses axes other than the world's, which older versions of the program do not support.
    pub fn has_custom_axes(&self) -> bool {
        self.mirror_by_object || !self.symmetry().has_world_axes()
    }

    /// The radius of a dab, scene units, at the pen's pressure.
    pub fn radius_at(&self, pen: PenSample) -> f64 {
        self.radius * pressure_response(self.pressure_to_radius, pen)
    }

    /// The strength of a dab, in [0, 1], at the pen's pressure.
    pub fn strength_at(&self, pen: PenSample) -> f64 {
        self.strength * pressure_response(self.pressure_to_strength, pen)
    }
}

/// Whether a curve's values stay within [0, 1]; a curve never overshoots its points.
fn is_falloff(curve: &Curve) -> bool {
    curve.is_valid() && curve.points().iter().all(|[_, share]| (0.0..=1.0).contains(share))
}

/// 1 at full pressure, 1 − `share` at none.
fn pressure_response(share: f64, pen: PenSample) -> f64 {
    1.0 - share * (1.0 - pen.pressure.clamp(0.0, 1.0))
}

/// Serialised form of [`FocusOffset`].
#[derive(Serialize, Deserialize)]
#[serde(remote = "FocusOffset", deny_unknown_fields)]
pub struct FocusOffsetFields {
    /// The focus offset.
    t: f64,
    /// Its anchor, in [0, 1].
    anchor: f64,
    /// How far gloss obeys it, in [0, 1].
    #[serde(default, skip_serializing_if = "is_zero")]
    gloss: f64,
}

fn is_zero(number: &f64) -> bool {
    *number == 0.0
}
