//! Lateral colour: the picture of a colour is larger or smaller about the axis.

use crate::nodes::SplatNode;

/// How much larger a colour's picture is than green's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Magnification {
    /// m: everything lies 1 + m times as far from the axis.
    pub lateral: f64,
    /// Where the axis is, 1/4096 px.
    pub axis: [f64; 2],
}

impl Magnification {
    /// A node where, and of the size, that the colour shows it. Its light is that of as many more pixels, so that a whole surface
    /// covers its pixels once: see [`Self::density`].
    #[inline(always)]
    pub fn moved(&self, node: &SplatNode) -> SplatNode {
        let size = 1.0 + self.lateral;
        let away = |at: i32, axis: f64| at + ((f64::from(at) - axis) * self.lateral).round_ties_even() as i32;
        let area = (size * size) as f32;
        let mut moved = *node;
        moved.center = [away(node.center[0], self.axis[0]), away(node.center[1], self.axis[1])];
        moved.half_size =
            node.half_size.map(|half| (f64::from(half) * size).round_ties_even().min(65535.0) as u16);
        moved.light = node.light.map(|light| light * area);
        moved
    }

    /// What a larger picture's light is spread to: 1/(1 + m)².
    pub fn density(&self) -> f32 {
        (1.0 + self.lateral).powi(-2) as f32
    }
}
