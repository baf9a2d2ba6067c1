//! Drawing a node: the image of the aperture, spread over its footprint.
//!
//! Everything here is integer arithmetic of 32 bits ([`crate::fixed`]), so that any machine, and any graphics card, draws
//! the same bits. A node far out of focus is a stencil of the aperture on its level, one nearly in focus a box of the same
//! mean and variance. Levels blur what is drawn on them (a pixel's box, and the upsampling), and a footprint is itself a
//! blur; stencils are made smaller or larger so that the variance on the picture is that of footprint and aperture together.

pub mod boxes;
pub mod image;
mod image_frame;
mod large;
mod paper;
mod pen;
mod shaped;
pub mod sized_box;
mod small;
pub mod stencilled;
pub mod visible_runs;

pub use image::Image;
pub use large::Large;
pub use paper::Paper;
pub use pen::{ALL, Form, MAX_PARTS, Pen};

use crate::canvas::Word;
use crate::fixed::mul_shift;
use crate::lens_in_use::Placed;
use crate::nodes::SplatNode;

impl Pen<'_> {
    /// Adds (`sign` 1) a node's `light` (see [`SplatNode::light`]) to the levels of a sum, or takes it away (−1): at the
    /// latest when each is [finished](Paper::finish) with that sign.
    #[inline(always)]
    pub fn draw<W: Word>(
        &self,
        node: &SplatNode,
        light: [f32; 4],
        placed: Placed,
        levels: &mut [Paper<W>],
        sign: i32,
    ) {
        if placed.level < node.level {
            return self.draw_split(node, light, placed, levels, sign);
        }
        self.draw_whole(node, light, placed, &mut levels[placed.level as usize], sign);
    }

    /// A sample of a large cell, as samples of smaller ones.
    #[cold]
    fn draw_split<W: Word>(
        &self,
        node: &SplatNode,
        light: [f32; 4],
        placed: Placed,
        levels: &mut [Paper<W>],
        sign: i32,
    ) {
        let paper = &mut levels[placed.level as usize];
        for piece in node.pieces(placed.level) {
            self.draw_whole(&piece, light, placed, paper, sign);
        }
    }

    #[inline(always)]
    fn draw_whole<W: Word>(
        &self,
        node: &SplatNode,
        light: [f32; 4],
        placed: Placed,
        paper: &mut Paper<W>,
        sign: i32,
    ) {
        if let Some(shaper) = self.shaper {
            let shape = shaper.node_shape(node, placed.radius);
            if !shape.is_plain() {
                return self.draw_shaped((shaper, &shape), node, light, placed, paper, sign);
            }
        }
        let image = self.image(node, light, placed);
        self.forms(
            node,
            placed,
            #[inline(always)]
            |form| {
                let mut image = Image { ..image };
                match form {
                    Form::Box(share) => {
                        image.share = share;
                        image.lean(node, self.tilt_shift);
                        image.shift(self.mean);
                        let half_size = [node.half_size[0].into(), node.half_size[1].into()];
                        let half = self.half.map(|half| mul_shift(image.radius.unsigned_abs(), half, 16));
                        self.draw_box(&image, half_size, half, paper, sign);
                    }
                    Form::Parts(share) => {
                        image.share = share;
                        self.draw_parts(&image, placed.depth_share, None, paper, sign);
                    }
                    Form::Image(share) => {
                        image.share = share;
                        image.lean(node, self.tilt_shift);
                        self.draw_image(&mut image, None, paper, sign);
                    }
                    Form::Tilted(share) => self.draw_image(&mut image, Some((&ALL, share)), paper, sign),
                    Form::PartialBox => self.draw_partial_box(&mut image, paper, sign),
                    Form::PartialImage => {
                        self.draw_image(&mut image, Some(self.visible_part(node)), paper, sign);
                    }
                }
            },
        );
    }
}
