//! The lens that a picture is summed with, and where it places each node.

use crate::aperture::shape::Shape;
use crate::canvas::POSITION_BITS;
use crate::character::magnification::Magnification;
use crate::fixed::ONE;
use crate::node_view::{DraftScale, NodeView};
use crate::nodes::{CONTRASTS, SplatNode, wider_by_contrast};
use lens::{Camera, FocusOffset, Optics};
use salf::tree::LEVELS;
use std::ops::Range;

/// How coarse the sum may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// A node may be drawn as one where its side is at most this share of the diameter of a 16 px circle of confusion
    /// (a smaller share of larger circles, so that the cost per pixel is constant). 0: every sample is drawn, except that the
    /// samples of a sharp pixel are drawn as one.
    pub share_of_circle: f64,
}

impl Tolerance {
    /// As fine as the samples.
    pub const NONE: Self = Self { share_of_circle: 0.0 };

    /// For interactive viewing.
    pub const VIEWING: Self = Self { share_of_circle: 0.375 };

    /// The tolerance by which nodes are up to `px` pixels large where the circle of confusion is 16 px.
    pub fn px(px: f64) -> Self {
        Self { share_of_circle: px / 16.0 }
    }

    /// The diameter of the circle of confusion, px, from which on nodes of `side` px may be drawn.
    fn smallest_circle_px(self, side: f64) -> f64 {
        if self.share_of_circle <= 0.0 {
            return f64::INFINITY;
        }
        // side = share·D below 16 px, share·D·(16/D)^(2/3) above.
        let linear = side / self.share_of_circle;
        if linear <= 16.0 { linear } else { (linear / 16f64.powf(2.0 / 3.0)).powi(3) }
    }
}

impl Default for Tolerance {
    fn default() -> Self {
        Self::NONE
    }
}

/// Focus of a node: the mean of its samples and how far they are from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeFocus {
    /// Mean t and anchor.
    pub t: f32,
    /// See `t`.
    pub anchor: f32,
    /// The largest differences; [`LARGEST_OFFSET`] where painted and unpainted samples mix.
    pub t_apart: f32,
    /// See `t_apart`.
    pub anchor_apart: f32,
}

impl NodeFocus {
    /// Nothing is painted.
    pub const STANDARD: Self = Self { t: 1.0, anchor: 0.0, t_apart: 0.0, anchor_apart: 0.0 };

    /// The focus as nodes have it: in 32-bit floats, with t limited and without subnormal numbers.
    pub fn new(offset: FocusOffset) -> Self {
        let t = (offset.t as f32).clamp(-LARGEST_OFFSET, LARGEST_OFFSET);
        Self { t, anchor: offset.anchor as f32, ..Self::STANDARD }.without_subnormals()
    }

    /// Without numbers so small that a card may take them as 0.
    pub fn without_subnormals(self) -> Self {
        let normal = |x: f32| if x.is_subnormal() { 0.0 } else { x };
        Self {
            t: normal(self.t),
            anchor: normal(self.anchor),
            t_apart: normal(self.t_apart),
            anchor_apart: normal(self.anchor_apart),
        }
    }
}

/// How a node is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Placed {
    /// Signed radius of the lens's aperture image, 1/4096 px.
    pub radius: i32,
    /// How fast its defocus changes with depth, as a share of the unpainted, times 16384: t·(1 − a).
    pub depth_share: i32,
    /// Whether it is unpainted.
    pub is_standard: bool,
    /// The level that it is drawn on, the coarsest that its image is large enough for: a sample of a cell larger than that is
    /// drawn in pieces, a smaller one as coarsely as its neighbours would be if they were one.
    pub level: u8,
}

impl Placed {
    /// The columns (`axis` 0) or rows (1) of a picture of `side` of them that the light of a node drawn so may reach.
    #[inline(always)]
    pub fn reach(self, node: &SplatNode, axis: usize, side: u32) -> Range<u32> {
        let range = self.range(node, axis);
        let within = |place: i32| place.clamp(0, side as i32) as u32;
        within(range.start)..within(range.end)
    }

    /// The columns or rows that its light may reach, whatever the picture's size.
    #[inline(always)]
    pub fn range(self, node: &SplatNode, axis: usize) -> Range<i32> {
        let center = node.center[axis] >> POSITION_BITS;
        let radius = self.radius.abs() >> POSITION_BITS;
        // Coarse levels spread a little further.
        let reach = radius * 33 / 32
            + if axis == 0 { leaning(node, radius) } else { 0 }
            + (node.half_size[axis] as i32 >> (POSITION_BITS - 1))
            + (5 << self.level);
        center - reach..center + reach + 1
    }
}

/// How far beyond an image of `radius` its light may lean along a row: parts of a run do toward where the weight is, by tilt·half²/3 of
/// their weight, where half is half their width.
#[inline(always)]
fn leaning(node: &SplatNode, radius: i32) -> i32 {
    let tilt = i32::from(node.tilt[0]).abs() + i32::from(node.tilt[1]).abs();
    if tilt <= ONE / 8 {
        radius / 16
    } else if i32::from(node.base) == ONE {
        // The weight is nowhere negative: tilt·half is at most the weight.
        radius / 3
    } else {
        // No part leans beyond half its width.
        radius
    }
}

/// Larger aperture images, 1/4096 px, are taken as this large: next to none of their light is in the picture.
pub const LARGEST_RADIUS: f32 = (1u32 << 29) as f32;

/// Defocus that changes faster with depth than the unpainted, by this factor (times 16384), is drawn as if it did not.
pub const LARGEST_DEPTH_SHARE: f32 = ((1u32 << 17) - 1) as f32;

/// Larger offsets, and what lies further apart, are taken as this large, so that no float of 32 bits overflows.
pub const LARGEST_OFFSET: f32 = 1e9;

/// Radii per κ and per depth, 1/4096 px, are taken as this large at most, for the same reason.
const LARGEST_RATE: f64 = 1e15;

/// A lens.
///
/// It places nodes in floats of 32 bits, a product rounded before it is added to, so that a graphics card does it to the bit.
#[derive(Clone, Debug, PartialEq)]
pub struct LensInUse {
    /// The signed radius of the aperture's image, 1/4096 px: of what is infinitely far, …
    pub radius_at_infinity: f32,
    /// … what it loses for each unit of 1/z, which is that for κ = 1, …
    pub radius_per_kappa: f32,
    /// … and for κ = 1/d, which t = 2 brings at the focus distance.
    pub radius_per_offset: f32,
    /// What the colour that is drawn adds, whatever is painted.
    pub colour_radius: f32,
    /// How the field curves, if it does.
    pub field: Option<FieldCurvature>,
    /// How much larger the picture of the colour that is drawn is, where it is.
    pub magnification: Option<Magnification>,
    /// How large the picture is beside the light field's, if it is a draft.
    pub draft_scale: Option<DraftScale>,
    /// How exactly what is drawn is drawn.
    pub detail: Detail,
    /// From which |radius| on, 1/4096 px, nodes may be drawn on each level: by [`Fineness`].
    pub smallest_radius: [[u32; LEVELS]; FINENESSES],
    /// From which on a node may replace those below it: by its contrast.
    pub smallest_joint_radius: [[[u32; LEVELS]; FINENESSES]; CONTRASTS],
}

/// How the field of a lens curves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldCurvature {
    /// What a node's image gains for each squared half-height that it lies from the axis, 1/4096 px.
    pub radius_per_square: f32,
    /// Where the axis is, 1/4096 px.
    pub axis: [f32; 2],
    /// Half-heights for each 1/4096 px.
    pub per_position: f32,
}

/// Beyond this squared distance from the axis, half-heights, no field curves any more (see [`lens::CharacterOptics::curvature_at`]).
const LARGEST_FIELD: f32 = 64.0;

impl FieldCurvature {
    /// |q₀|² of a node.
    #[inline(always)]
    fn square(&self, node: &SplatNode) -> f32 {
        let x = (node.center[0] as f32 - self.axis[0]) * self.per_position;
        let y = (node.center[1] as f32 - self.axis[1]) * self.per_position;
        (x * x + y * y).min(LARGEST_FIELD)
    }
}

/// How exactly nodes are drawn: as coarse as the nodes are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Detail {
    /// As exactly as can be.
    Exact,
    /// Small images of open nodes in fewer parts.
    Fine,
    /// Small images of partly occluded ones as boxes, too.
    Sketch,
    /// The same of few pixels, to be enlarged: highlights of a few pixels are round.
    Draft,
}

impl Detail {
    fn for_tolerance(Tolerance { share_of_circle }: Tolerance) -> Self {
        match share_of_circle {
            share if share < 0.1 => Self::Exact,
            share if share < 0.3 => Self::Fine,
            _ => Self::Sketch,
        }
    }
}

/// The number of finenesses ([`Fineness`]).
pub const FINENESSES: usize = 4;

/// How fine a node is drawn.
#[derive(Clone, Copy)]
enum Fineness {
    Open,
    PartlyOccluded,
    /// The rim of its image is visible.
    Highlight,
    /// Wide sums have one level.
    Bright,
}

impl Fineness {
    /// How much finer than open nodes.
    const FINER: [f64; FINENESSES] = [1.0, 1.25, 4.0, f64::INFINITY];

    #[inline(always)]
    fn classify(node: &SplatNode) -> Self {
        match node {
            SplatNode { is_bright: true, .. } => Self::Bright,
            SplatNode { is_highlight: true, .. } => Self::Highlight,
            _ if node.is_open() => Self::Open,
            _ => Self::PartlyOccluded,
        }
    }
}

/// The aperture images below a drawn node may differ in radius by this share of its side.
pub const FLAT: f32 = 0.3;

/// Or by this share of their radius, where that is more: a soft rim of paint is as steep as it is blurred.
pub const ALIKE: f32 = 0.125;

/// Aperture images of at most this radius, 1/4096 px, leave the samples of a pixel within it: one stands for them all.
pub const SHARP: u32 = 16;

impl LensInUse {
    /// A lens with an aperture of this shape; `tolerance` decides which nodes are drawn and how finely.
    pub fn new(optics: Optics, shape: &Shape, tolerance: Tolerance) -> Self {
        let deviation = (shape.variance.min_element()).sqrt();
        let smallest = |finer: f64, wider: f64| {
            std::array::from_fn(|level| {
                let circle = wider * tolerance.smallest_circle_px(finer * (1 << level) as f64);
                // A disc as wide as the shape: its standard deviation is a quarter of its diameter.
                (circle / (4.0 * deviation) * (1 << POSITION_BITS) as f64).ceil() as u32
            })
        };
        let rate = |kappa: f64| {
            let radius = optics.splat_radius_px(kappa) * (1 << POSITION_BITS) as f64;
            radius.clamp(-LARGEST_RATE, LARGEST_RATE) as f32
        };
        Self {
            radius_at_infinity: rate(optics.standard_kappa(0.0)),
            radius_per_kappa: rate(1.0),
            radius_per_offset: rate(1.0 / optics.image_distance),
            colour_radius: 0.0,
            field: None,
            magnification: None,
            draft_scale: None,
            detail: Detail::for_tolerance(tolerance),
            smallest_radius: Fineness::FINER.map(|finer| smallest(finer, 1.0)),
            smallest_joint_radius: std::array::from_fn(|contrast| {
                Fineness::FINER.map(|finer| smallest(finer, wider_by_contrast(contrast as u8)))
            }),
        }
    }

    /// The same for a colour channel of a camera's lens with its character.
    pub fn with_character(self, camera: &Camera, channel: usize) -> Self {
        let character = camera.character_optics();
        let optics = &character.optics;
        let size = character.magnification()[channel];
        let rate = |kappa: f64| {
            let radius = optics.splat_radius_px(kappa) * size * (1 << POSITION_BITS) as f64;
            radius.clamp(-LARGEST_RATE, LARGEST_RATE) as f32
        };
        let axis = camera.principal_point_px() * (1 << POSITION_BITS) as f64;
        let half_height = optics.half_height_px * size * (1 << POSITION_BITS) as f64;
        let field = FieldCurvature {
            radius_per_square: rate(character.field_curvature()),
            axis: axis.as_vec2().to_array(),
            per_position: (1.0 / half_height) as f32,
        };
        Self {
            radius_at_infinity: rate(optics.standard_kappa(0.0)),
            radius_per_kappa: rate(1.0),
            radius_per_offset: rate(1.0 / optics.image_distance),
            colour_radius: rate(character.colour_defocus()[channel]),
            field: (character.field_curvature() != 0.0).then_some(field),
            magnification: (size != 1.0)
                .then(|| Magnification { lateral: size - 1.0, axis: axis.to_array() }),
            ..self
        }
    }

    /// The same for a draft of this scale: nodes that are smaller than its pixels are not drawn where those of a pixel are alike.
    pub fn for_draft(mut self, scale: DraftScale) -> Self {
        for of_fineness in &mut self.smallest_joint_radius {
            for fineness in [Fineness::Open, Fineness::PartlyOccluded, Fineness::Highlight] {
                of_fineness[fineness as usize][0] = 0;
            }
        }
        let detail = if self.detail == Detail::Sketch { Detail::Draft } else { self.detail };
        Self { draft_scale: Some(scale), detail, ..self }
    }

    /// How its picture sees the nodes; `None`: where they are.
    pub fn view(&self) -> Option<NodeView> {
        let Self { draft_scale, magnification, .. } = *self;
        (draft_scale.is_some() || magnification.is_some()).then_some(NodeView { draft_scale, magnification })
    }

    /// The lens's aperture radius as a share of the baked one (`baked_radius`, scene units), in [0, 1].
    pub fn stop(optics: &Optics, baked_radius: f64) -> f64 {
        if baked_radius > 0.0 { (optics.aperture_radius / baked_radius).min(1.0) } else { 1.0 }
    }

    /// The radius of an unpainted node's image.
    #[inline(always)]
    fn standard_radius(&self, node: &SplatNode) -> f32 {
        let flat = self.radius_at_infinity - self.radius_per_kappa * node.inverse_depth;
        match &self.field {
            None => flat,
            Some(field) => flat + field.radius_per_square * field.square(node),
        }
    }

    /// Where `focus` sends a node: κ = (t − 1)/d + t·(1 − a)·(1/s − 1/z), as the radius of its image.
    #[inline(always)]
    pub fn place(&self, node: &SplatNode, focus: &NodeFocus) -> Placed {
        let is_standard = (focus.t, focus.anchor) == (1.0, 0.0);
        let of_depth = focus.t * (1.0 - focus.anchor);
        let radius = self.radius_per_offset * (focus.t - 1.0) + of_depth * self.standard_radius(node);
        let radius = radius + self.colour_radius;
        let radius = radius.clamp(-LARGEST_RADIUS, LARGEST_RADIUS).round_ties_even() as i32;
        let depth_share = of_depth * ONE as f32;
        let mut level = 0;
        let fineness = Fineness::classify(node);
        while level + 1 < LEVELS as u8 && self.is_far_out(fineness, level + 1, radius) {
            level += 1;
        }
        Placed {
            radius,
            depth_share: depth_share.clamp(-LARGEST_DEPTH_SHARE, LARGEST_DEPTH_SHARE) as i32,
            is_standard,
            level,
        }
    }

    /// Whether an aperture image of this radius, 1/4096 px, is large enough for a level.
    #[inline(always)]
    fn is_far_out(&self, fineness: Fineness, level: u8, radius: i32) -> bool {
        radius.unsigned_abs() >= self.smallest_radius[fineness as usize][level as usize]
    }

    /// Whether a node that was `placed` with this focus may be drawn in place of all nodes below it.
    #[inline(always)]
    pub fn may_merge(&self, node: &SplatNode, focus: &NodeFocus, placed: Placed) -> bool {
        if focus.t_apart >= LARGEST_OFFSET {
            return false;
        }
        let size = placed.radius.unsigned_abs();
        let is_sharp = node.level == 0 && size <= SHARP;
        let of_contrast = &self.smallest_joint_radius[node.contrast as usize];
        let smallest = of_contrast[Fineness::classify(node) as usize][node.level as usize];
        let is_blurred = size >= smallest;
        if !is_sharp && !is_blurred {
            return false;
        }
        let of_depth = focus.t * (1.0 - focus.anchor);
        let mut apart = of_depth.abs() * (self.radius_per_kappa * node.inverse_depth_spread);
        if focus.t_apart > 0.0 || focus.anchor_apart > 0.0 {
            // The partial derivatives of the radius.
            let standard = self.standard_radius(node);
            let by_t = (self.radius_per_offset + (1.0 - focus.anchor) * standard).abs();
            let by_anchor = (focus.t * standard).abs();
            apart += by_t * focus.t_apart + by_anchor * focus.anchor_apart;
        }
        let side = (1 << node.level << POSITION_BITS) as f32;
        if let Some(field) = &self.field {
            let slope = 2.0 * field.radius_per_square * field.square(node).sqrt() * field.per_position;
            apart += (of_depth * slope).abs() * side;
        }
        apart <= if is_blurred { (FLAT * side).max(ALIKE * size as f32) } else { SHARP as f32 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn larger_nodes_ask_for_larger_circles() {
        let tolerance = Tolerance { share_of_circle: 0.25 };
        assert_eq!(tolerance.smallest_circle_px(2.0), 8.0);
        assert_eq!(tolerance.smallest_circle_px(4.0), 16.0);
        assert!((tolerance.smallest_circle_px(8.0) - 128.0).abs() < 1e-9);
        assert_eq!(Tolerance::NONE.smallest_circle_px(2.0), f64::INFINITY);
    }
}
