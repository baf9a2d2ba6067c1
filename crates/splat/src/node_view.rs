//! How nodes are moved for a picture that does not show them where they were baked: a draft of fewer pixels, or the picture of a colour
//! that the lens shows larger.

use crate::canvas::PIXEL;
use crate::character::magnification::Magnification;
use crate::nodes::SplatNode;

/// The smallest half of a footprint's side, 1/4096 px.
const LEAST_HALF: f64 = (PIXEL / 32) as f64;

/// What moves nodes to where a picture shows them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeView {
    /// How large the picture is beside the light field's, if it is a draft.
    pub draft_scale: Option<DraftScale>,
    /// How much larger the picture of the colour that is drawn is, after that.
    pub magnification: Option<Magnification>,
}

/// How large the picture of a draft is beside that of the light field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DraftScale {
    /// How often its sides are halved.
    pub halvings: u8,
    /// How long they are then, as shares of the light field's: rounded up to whole pixels.
    pub sides: [f64; 2],
}

impl NodeView {
    /// A node as the picture shows it.
    #[inline(always)]
    pub fn moved(&self, node: &SplatNode) -> SplatNode {
        let node = self.draft_scale.map_or(*node, |scale| node.in_draft(scale));
        self.magnification.map_or(node, |magnification| magnification.moved(&node))
    }
}

impl SplatNode {
    /// The node in a draft's picture. Its cell is one of a finer level there, and its light that of a pixel of that level; where
    /// there is none, of a part of a pixel.
    #[inline(always)]
    fn in_draft(&self, DraftScale { halvings, sides }: DraftScale) -> Self {
        let center = |axis: usize| (f64::from(self.center[axis]) * sides[axis]).round_ties_even() as i32;
        let half = |axis: usize| {
            let half = f64::from(self.half_size[axis]) * sides[axis];
            half.round_ties_even().max(LEAST_HALF) as u16
        };
        let mut moved = *self;
        moved.center = [center(0), center(1)];
        moved.half_size = [half(0), half(1)];
        moved.level = self.level.saturating_sub(halvings);
        if self.level < halvings {
            let area = 1.0 / (1u32 << (2 * (halvings - self.level))) as f32;
            moved.light = self.light.map(|light| light * area);
        }
        moved
    }
}
