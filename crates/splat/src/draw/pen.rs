//! What nodes are drawn with, and in which form each is drawn.

use crate::aperture::moments::MomentCache;
use crate::aperture::stencil::Stencils;
use crate::canvas::{PIXEL, POSITION_BITS};
use crate::character::shaper::Shaper;
use crate::draw::image::{Image, Light, seed};
use crate::fixed::{ONE, WHOLE, mul_shift};
use crate::lens_in_use::{Detail, Placed};
use crate::node_view::NodeView;
use crate::nodes::{Cells, Nodes, SplatNode};

/// Aperture images of a smaller standard deviation, px, are boxes.
const BOX_DEVIATION_PX: f64 = 0.75;

/// Shapes of less variance are taken as of this share of it: so that products of it fit into 62 bits.
const LARGEST_PER_VARIANCE: f64 = (1 << 28) as f64;

/// x / 2^`times`, toward zero.
#[inline(always)]
fn halved(x: i32, times: u8) -> i32 {
    (x + ((x >> 31) & ((1 << times) - 1))) >> times
}

/// What nodes are drawn with.
pub struct Pen<'a> {
    /// The nodes to draw.
    pub nodes: &'a Nodes,
    /// What cuts and weighs the aperture, if anything does.
    pub shaper: Option<&'a Shaper>,
    /// How the picture sees the nodes; `None`: where they are.
    pub view: Option<NodeView>,
    /// The images of the aperture, by size.
    pub stencils: &'a Stencils,
    /// The aperture moments of partly occluded nodes.
    pub moments: &'a MomentCache,
    /// The lens's aperture radius as a share of the baked one, in 1/16384.
    pub stop: i32,
    /// Its reciprocal, in 1/16384.
    pub per_stop: u32,
    /// √3 standard deviations of the shape along each axis, times 65536: half a box as wide.
    pub half: [u32; 2],
    /// By what the tilt over the baked aperture moves the mean aperture point of the lens.
    pub tilt_shift: [i32; 2],
    /// The mean aperture point of the shape, times 16384.
    pub mean: [i32; 2],
    /// What levels blur too much, as squares of a stencil's radius: by level, (1/4096 px of the level)².
    pub too_blurred: [i64; salf::tree::LEVELS],
    /// 16384 over the mean variance.
    pub per_variance: i64,
    /// Images of partly occluded nodes of a smaller radius, 1/4096 px of their level, are boxes.
    pub box_radius: u32,
    /// The same of highlights, whose rims show.
    pub highlight_box_radius: u32,
    /// Smaller changes of an open node's weight over the aperture, as a share of it in 1/16384, only move its image.
    pub even_tilt: i32,
    /// Changes of a partly occluded node's weight that are not larger do not count.
    pub even_partial_tilt: i32,
    /// Parts of the aperture whose images are boxes.
    pub parts: Vec<BoxPart>,
    /// Even images of a smaller radius, 1/4096 px, are one box; others one a part of the aperture.
    pub one_box_radius: u32,
    /// Images of partly occluded nodes of a smaller radius, 1/4096 px of their level, take of all rows of cells that a pixel row
    /// lies across.
    pub all_rows_radius: u32,
    /// Whether what is drawn is drawn as exactly as it can be.
    pub is_exact: bool,
    /// From which |radius| on, 1/4096 px, stencils follow boxes; at twice that they are alone.
    pub stencil_radius: u32,
    /// 2³² over it.
    pub per_stencil_radius: u32,
}

/// The aperture has at most this many parts whose images are boxes.
pub const MAX_PARTS: usize = 16;

/// A part of the aperture: its share times 2²⁴, mean and variance times 16384, √3 deviations times 65536.
#[derive(Clone, Copy)]
pub struct BoxPart {
    /// The part's share of all light, times 2²⁴.
    pub share: u32,
    /// The part's mean aperture point, times 16384.
    pub mean: [i32; 2],
    /// The part's variance along each axis, times 16384.
    pub variance: [i32; 2],
    /// √3 standard deviations along each axis, times 65536.
    pub half: [u32; 2],
}

/// The cells of a node that sees the whole aperture.
pub const ALL: Cells = [u16::MAX; 16];

/// A form that a node, or a part of its light, is drawn in; shares are times 2²⁴.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// One box, with this share of the light.
    Box(u32),
    /// A box for each part of the aperture, with this share of the light.
    Parts(u32),
    /// The aperture's image, with this share of the light.
    Image(u32),
    /// The same where the weight changes over the aperture.
    Tilted(u32),
    /// The box of the visible part of the aperture.
    PartialBox,
    /// The image of the visible part of the aperture.
    PartialImage,
}

impl<'a> Pen<'a> {
    /// A pen for an aperture's shape and a lens whose aperture radius is `stop` times the baked one's; `moments` are
    /// those of the masks of `nodes`.
    pub fn new(
        nodes: &'a Nodes,
        stencils: &'a Stencils,
        moments: &'a MomentCache,
        stop: f64,
        detail: Detail,
    ) -> Self {
        let shape = &stencils.shape;
        let variance = (shape.variance.x + shape.variance.y) / 2.0;
        let fixed = |x: f64| (x * ONE as f64).round() as i32;
        let half = |variance: f64| ((3.0 * variance).sqrt() * 65536.0).round() as u32;
        // On level ℓ the picture gets the variance σ²r'² + 4^ℓ/12 px² and should get σ²r² + footprint + 1/12.
        let too_blurred = std::array::from_fn(|level| {
            ((1.0 - 0.25f64.powi(level as i32)) / 12.0 / variance * (PIXEL as f64).powi(2)).round() as i64
        });
        let parts = stencils.parts[usize::from(detail == Detail::Exact)].iter().map(|part| BoxPart {
            share: (part.share * WHOLE as f64).round() as u32,
            mean: part.mean.to_array().map(fixed),
            variance: part.variance.to_array().map(fixed),
            half: part.variance.to_array().map(half),
        });
        let deviations =
            |factor: f64| (factor * BOX_DEVIATION_PX / variance.sqrt() * PIXEL as f64).ceil() as u32;
        let stop = fixed(stop);
        // For viewing, one box is sufficient until stencils take over.
        let [stencil_radius, one_box_radius] = match detail {
            Detail::Exact => [deviations(0.5), deviations(0.5)],
            _ => [deviations(0.3), u32::MAX],
        };
        let [even_tilt, even_partial_tilt] = match detail {
            Detail::Exact => [ONE / 40, 0],
            _ => [ONE / 20, ONE / 20],
        };
        let [box_radius, highlight_box_radius] = match detail {
            Detail::Exact => [1.0, 1.0],
            Detail::Fine => [1.5, 1.5],
            Detail::Sketch => [2.0, 2.0],
            Detail::Draft => [2.0, 1.0],
        }
        .map(deviations);
        // Below 3 px, one of three or more rows of cells would represent a pixel row.
        let all_rows_radius = match detail {
            Detail::Exact => u32::MAX,
            Detail::Fine => 3 * PIXEL as u32,
            Detail::Sketch | Detail::Draft => 0,
        };
        Self {
            nodes,
            shaper: None,
            view: None,
            stencils,
            moments,
            stop,
            per_stop: (1 << 28) / stop.max(1) as u32,
            half: shape.variance.to_array().map(half),
            tilt_shift: (shape.variance * stop as f64 / ONE as f64).to_array().map(fixed),
            mean: shape.mean.to_array().map(fixed),
            too_blurred,
            per_variance: (ONE as f64 / variance).round().min(LARGEST_PER_VARIANCE) as i64,
            parts: parts.collect(),
            is_exact: detail == Detail::Exact,
            stencil_radius,
            per_stencil_radius: u32::MAX / stencil_radius,
            box_radius,
            highlight_box_radius,
            all_rows_radius,
            one_box_radius,
            even_tilt,
            even_partial_tilt,
        }
    }

    /// The node with this index, as the picture sees it.
    #[inline(always)]
    pub fn node(&self, index: u32) -> SplatNode {
        let node = &self.nodes.nodes[index as usize];
        self.view.map_or(*node, |view| view.moved(node))
    }

    /// The image of a node that was placed, with this light.
    #[inline(always)]
    pub fn image<'n>(&self, node: &'n SplatNode, light: [f32; 4], placed: Placed) -> Image<'n> {
        Image {
            node,
            level: placed.level,
            center: [node.center[0] >> placed.level, node.center[1] >> placed.level],
            radius: halved(placed.radius, placed.level),
            light: Light::from_floats(light).coarser(placed.level - node.level),
            share: WHOLE,
            dither: seed(node, placed.level, self.nodes.middle),
        }
    }

    /// The visible cells of a partly occluded node, and their share (times 2²⁴) of the light.
    #[inline(always)]
    pub fn visible_part<'n>(&'n self, node: &SplatNode) -> (&'n Cells, u32) {
        match self.nodes.cells(node) {
            Some(cells) => (cells, self.moments.of(self.nodes, node).share),
            None => (&ALL, WHOLE),
        }
    }

    /// The approximate cost of drawing a node that was placed, in ns.
    #[inline(always)]
    pub fn cost(&self, node: &SplatNode, placed: Placed) -> u64 {
        let radius = placed.radius.unsigned_abs() >> placed.level;
        let rows = (radius >> (POSITION_BITS - 1)) + 2;
        let once = match node.is_open() {
            true if !self.is_even(node) && placed.level == 0 => 150 + 30 * rows,
            false if radius >= self.box_radius => 100 + 40 * rows,
            _ => 50 + 10 * rows,
        };
        u64::from(if node.is_bright { 2 * once } else { once })
    }

    /// Calls `visit` with each form in which a node that was placed is drawn.
    #[inline(always)]
    pub fn forms(&self, node: &SplatNode, placed: Placed, mut visit: impl FnMut(Form)) {
        let radius = placed.radius.unsigned_abs();
        if !node.is_open() {
            let box_radius = if node.is_highlight { self.highlight_box_radius } else { self.box_radius };
            let is_box = radius >> placed.level < box_radius;
            return if is_box { visit(Form::PartialBox) } else { visit(Form::PartialImage) };
        }
        let is_even = self.is_even(node);
        let far = match placed.level {
            0 => self.part_drawn_as_stencil(node, radius),
            _ => 1 << 16,
        };
        if far < 1 << 16 {
            let share = WHOLE - (far << 8);
            let is_one = is_even && radius < self.one_box_radius;
            visit(if is_one { Form::Box(share) } else { Form::Parts(share) });
        }
        if far > 0 && is_even {
            visit(Form::Image(far << 8));
        } else if far > 0 {
            let lean = node.tilt[0] as i32 * self.mean[0] + node.tilt[1] as i32 * self.mean[1];
            let weight = (((node.base as i32) << 14) + lean).max(0);
            visit(Form::Tilted(mul_shift(far << 8, weight as u32, 28)));
        }
    }

    /// Whether an open node's weight hardly changes over the aperture.
    #[inline(always)]
    fn is_even(&self, node: &SplatNode) -> bool {
        node.tilt[0].abs() as i32 + (node.tilt[1].abs() as i32) < self.even_tilt
    }

    /// How much of a node's light is drawn as a stencil, times 65536; the rest is boxes. To look at, all of it or nothing, by
    /// chance: one form costs half of two.
    #[inline(always)]
    fn part_drawn_as_stencil(&self, node: &SplatNode, radius: u32) -> u32 {
        let part = self.part_of_stencil(radius);
        if self.is_exact || part.is_multiple_of(1 << 16) {
            return part;
        }
        let chance = seed(node, 0, self.nodes.middle) >> 16;
        u32::from(chance < part) << 16
    }

    /// How much of it is one on average. Where one form follows the other on a surface they mix, for they differ a little.
    #[inline(always)]
    fn part_of_stencil(&self, radius: u32) -> u32 {
        const ONE: u32 = 1 << 16;
        if radius <= self.stencil_radius {
            return 0;
        }
        if radius - self.stencil_radius >= self.stencil_radius {
            return ONE;
        }
        let part = mul_shift(radius - self.stencil_radius, self.per_stencil_radius, 16);
        // Smoothly, or the coverage would show where it begins.
        mul_shift(mul_shift(part, part, 16), 3 * ONE - 2 * part, 16)
    }
}
