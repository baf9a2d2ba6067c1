//! Which samples a picture spreads widely.

use super::Splatter;
use crate::canvas::PIXEL;
use crate::lens_in_use::NodeFocus;
use glam::Vec2;
use rayon::prelude::*;

/// The image of the aperture that a sample is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WideImage {
    /// The sample's number.
    pub sample: u32,
    /// Its place in the pinhole picture, px.
    pub center_px: Vec2,
    /// The radius of its image, px, however it is defocused.
    pub radius_px: f32,
}

impl Splatter {
    /// The samples whose images have a radius of more than `radius_px`, with the lens and the paint of the last picture.
    pub fn images_wider_than(&self, radius_px: f64) -> Vec<WideImage> {
        let Some(nodes) = &self.nodes else { return Vec::new() };
        let least = radius_px * f64::from(PIXEL);
        let of_block = |block: usize| {
            let (first, paint) = (nodes.blocks[block].start as usize, self.paint.block(block));
            let leaves = nodes.block_nodes(block).iter().enumerate().filter(|(_, node)| node.is_leaf());
            let images = leaves.filter_map(move |(index, node)| {
                let focus = paint.map_or(NodeFocus::STANDARD, |paint| paint[index]);
                let radius = f64::from(self.lens.place(node, &focus).radius).abs();
                let pixels = |place: i32| place as f32 / PIXEL as f32;
                (radius > least).then(|| WideImage {
                    sample: nodes.sample_of_node[first + index],
                    center_px: Vec2::new(pixels(node.center[0]), pixels(node.center[1])),
                    radius_px: (radius / f64::from(PIXEL)) as f32,
                })
            });
            images.collect::<Vec<_>>()
        };
        (0..nodes.blocks.len()).into_par_iter().flat_map_iter(of_block).collect()
    }
}
