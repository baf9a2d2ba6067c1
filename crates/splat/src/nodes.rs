//! The light field's hierarchy in the integers of the sum.

use crate::canvas::{PIXEL, POSITION_BITS};
use crate::fixed::ONE;
use crate::resolve::Quanta;
use rayon::prelude::*;
use salf::Salf;
use salf::tree::{Block, LEVELS, Node, each_block};
use std::ops::Range;

/// Brighter samples stay alone in the hierarchy.
pub const HIGHLIGHT: f32 = 4.0;

/// Samples whose radiance times footprint density is above this are summed in wide integers.
pub const BRIGHT: f32 = 16.0;

/// The brightest sample that can be summed, as radiance times footprint density.
pub const BRIGHTEST: f32 = (1u32 << 22) as f32;

/// How many quanta make a pixel of radiance 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scale {
    /// For ordinary samples, in 32 bits: 2 to this.
    pub dim_bits: i32,
    /// For bright ones, in 64.
    pub bright_bits: i32,
}

impl Scale {
    /// The finest: a pixel may be covered 32 times.
    pub const FINEST: Self = Self { dim_bits: 22, bright_bits: 16 };
    /// Bits that are given up when a pixel is covered more often.
    const STEP: i32 = 8;

    /// What a quantum of a node's light weighs among those of other nodes: of levels and sums of their own.
    fn weight_of_quantum(self, node: &SplatNode) -> f32 {
        let bits = if node.is_bright { self.bright_bits } else { self.dim_bits };
        4f32.powi(node.level.into()) * (-bits as f32).exp2()
    }

    /// How integers become numbers, of ordinary samples and of bright ones, where no radiance is above `brightest`.
    pub fn quanta(self, brightest: f64) -> [Quanta; 2] {
        let dim = Quanta::new(self.dim_bits, 32, brightest.min(BRIGHT.into()));
        [dim, Quanta::new(self.bright_bits, 64, brightest)]
    }

    /// The next coarser scale, for light that converges more; `None` where there is none.
    pub fn coarser(self) -> Option<Self> {
        let dim_bits = self.dim_bits - Self::STEP;
        (dim_bits > 0).then_some(Self { dim_bits, ..self })
    }
}

/// The step of a pixel's sum of ordinary samples, for radiance 1: each splat is rounded to it, up or down, in every pixel.
pub const QUANTUM: f64 = 1.0 / (1u32 << Scale::FINEST.dim_bits) as f64;

/// A node as the splat uses it. Positions are in 1/4096 px, shares of 1 in 1/16384.
#[derive(Clone, Copy, Debug)]
pub struct SplatNode {
    /// Mean position in the pinhole picture.
    pub center: [i32; 2],
    /// Half the sides of its footprint.
    pub half_size: [u16; 2],
    /// Its cell has a side of 2 to this, px: its light is that of a pixel of this level.
    pub level: u8,
    /// Whether it is summed in wide integers.
    pub is_bright: bool,
    /// Below [`CONTRASTS`]: how much of its light lies to a side that is not that of the rest. See [`wider_by_contrast`].
    pub contrast: u8,
    /// Whether its image is visible by itself: brighter than [`HIGHLIGHT`].
    pub is_highlight: bool,
    /// The index of its visibility; [`OPEN`] if it sees the whole aperture.
    pub cells: u32,
    /// Mean 1/z.
    pub inverse_depth: f32,
    /// How far they lie apart below it.
    pub inverse_depth_spread: f32,
    /// Red, green, blue and coverage of one pixel of its level, in quanta.
    pub light: [f32; 4],
    /// The weight of the aperture point u is `base` + `tilt`·u.
    pub base: i16,
    /// See `base`.
    pub tilt: [i16; 2],
    /// The first of the nodes that it replaces.
    first_child: u32,
    /// How many these are; none if it is a sample.
    child_count: u8,
}

/// The number of contrast classes.
pub const CONTRASTS: usize = 7;

/// By what factor the image of a node of this contrast must be larger than that of one of a single colour for it to stand for
/// those below it.
pub fn wider_by_contrast(contrast: u8) -> f64 {
    (f64::from(contrast) / CONTRASTS_AN_OCTAVE).exp2()
}

const CONTRASTS_AN_OCTAVE: f64 = 4.0;

/// The contrast of a node.
///
/// Light with a dipole m to its centre, thrown as an aperture image of radius r, is wrong by about m/r² along the image's
/// rim. For this to be alike everywhere, r must grow with the root of the dipole for each side.
fn contrast(node: &Node) -> u8 {
    // Those that are less are not told from a single colour. What sees a part of the aperture is dearer to draw, and its images
    // are less exact than its colours.
    let least = if node.cells.is_some() { 0.01 } else { 0.004 };
    let side = (1 << node.level) as f32;
    let share = node.dipole / (side * node.radiance.max_element().max(1.0));
    let octaves = (share / least).log2() / 2.0;
    (octaves * CONTRASTS_AN_OCTAVE as f32).round().clamp(0.0, (CONTRASTS - 1) as f32) as u8
}

/// Red, green and blue.
pub type Rgb = [f32; 3];

/// The visibility of a node: rows of 16 cells, row 0 at v = −1, column 0 (u = −1) the lowest bit.
pub type Cells = [u16; 16];

/// The index of the cells of a node that sees the whole aperture.
pub const OPEN: u32 = u32::MAX;

impl SplatNode {
    /// Whether it sees the whole aperture.
    #[inline(always)]
    pub fn is_open(&self) -> bool {
        self.cells == OPEN
    }

    /// Whether the node is a single sample.
    #[inline(always)]
    pub fn is_leaf(&self) -> bool {
        self.child_count == 0
    }

    /// The indices of the nodes that it replaces, which come after it.
    #[inline(always)]
    pub fn children(&self) -> Range<u32> {
        self.first_child..self.first_child + u32::from(self.child_count)
    }

    /// Where so many nodes and cells lie before those of its block.
    fn moved_by(self, nodes: u32, cells: u32) -> Self {
        let cells = if self.is_open() { OPEN } else { self.cells + cells };
        Self { first_child: self.first_child + nodes, cells, ..self }
    }

    /// A sample of a large cell, divided into samples of cells of level `level` (side 2 to its power, px).
    pub fn pieces(&self, level: u8) -> impl Iterator<Item = Self> + '_ {
        let finer = self.level - level;
        let count = 1 << finer;
        let half_size = self.half_size.map(|half| (half >> finer).max(PIXEL as u16 / 32));
        let offset = move |k: i32, axis: usize| (2 * k + 1 - count) * half_size[axis] as i32;
        (0..count * count).map(move |k| {
            let center = [self.center[0] + offset(k % count, 0), self.center[1] + offset(k / count, 1)];
            Self { center, half_size, level, ..*self }
        })
    }
}

/// The hierarchy in integers.
#[derive(Clone)]
pub struct Nodes {
    /// Nodes of each block.
    pub blocks: Vec<Range<u32>>,
    /// The nodes without a parent.
    pub roots: Vec<Range<u32>>,
    /// All nodes, block by block, each before those that it replaces.
    pub nodes: Vec<SplatNode>,
    cells: Vec<Cells>,
    /// The sample of each node that is one.
    pub sample_of_node: Vec<u32>,
    /// The node of each sample.
    pub node_of_sample: Vec<u32>,
    /// The block of each node.
    pub block_of_node: Vec<u32>,
    /// The integers that light is summed in.
    pub scale: Scale,
    /// The picture's middle, 1/4096 px.
    pub middle: [i32; 2],
    /// The largest radiance, at least 1.
    pub brightest: f64,
    /// Whether any sample needs wide integers.
    pub has_bright: bool,
}

impl Nodes {
    /// The nodes of a light field, in integers of this scale. `None` if a sample is too bright to be summed.
    pub fn new(salf: &Salf, scale: Scale) -> Option<Self> {
        Self::from_corner(salf, scale, [0; 2])
    }

    /// The same where the picture is a part of the whole that begins at this column and row, px: multiples of a block's side. All is as in
    /// the whole, but for places, which are counted from there.
    pub fn from_corner(salf: &Salf, scale: Scale, corner: [i32; 2]) -> Option<Self> {
        let corner = corner.map(|px| px * PIXEL);
        let parts = each_block(salf, HIGHLIGHT, |block| Part::new(block, scale, corner));
        let parts = parts.into_iter().collect::<Option<Vec<_>>>()?;
        let blocks = places(parts.iter().map(|part| part.nodes.len()));
        let cells_of_block = places(parts.iter().map(|part| part.cells.len()));
        let mut block_of_node = vec![0; blocks.last().map_or(0, |block| block.end as usize)];
        for (index, block) in blocks.iter().enumerate() {
            block_of_node[block.start as usize..block.end as usize].fill(index as u32);
        }
        let all = || {
            block_of_node.par_iter().enumerate().map(|(at, &block)| {
                let block = block as usize;
                (block, at - blocks[block].start as usize)
            })
        };
        let node = |(block, at): (usize, usize)| {
            parts[block].nodes[at].moved_by(blocks[block].start, cells_of_block[block].start)
        };
        let nodes: Vec<_> = all().map(node).collect();
        let sample_of_node: Vec<_> = all().map(|(block, at)| parts[block].samples[at]).collect();
        let mut node_of_sample = vec![0; salf.samples.len()];
        for (node, &sample) in sample_of_node.iter().enumerate() {
            if let Some(place) = node_of_sample.get_mut(sample as usize) {
                *place = node as u32;
            }
        }
        let root = |(part, block): (&Part, &Range<u32>)| block.start..block.start + part.roots;
        Some(Self {
            roots: parts.iter().zip(&blocks).map(root).collect(),
            blocks,
            has_bright: parts.iter().any(|part| part.has_bright),
            brightest: parts.iter().map(|part| part.brightest).fold(1.0, f32::max).into(),
            nodes,
            cells: parts.into_iter().flat_map(|part| part.cells).collect(),
            sample_of_node,
            node_of_sample,
            block_of_node,
            scale,
            middle: [
                salf.camera.width as i32 * (PIXEL / 2) - corner[0],
                salf.camera.height as i32 * (PIXEL / 2) - corner[1],
            ],
        })
    }

    /// How the integers of their sums become numbers: of ordinary samples, and of bright ones.
    pub fn quanta(&self) -> [Quanta; 2] {
        self.scale.quanta(self.brightest)
    }

    /// Changes the integers to another scale.
    pub fn rescale(&mut self, scale: Scale) {
        if self.scale == scale {
            return;
        }
        let factor = ((scale.dim_bits - self.scale.dim_bits) as f32).exp2();
        for node in self.nodes.iter_mut().filter(|node| !node.is_bright) {
            node.light = node.light.map(|value| value * factor);
        }
        self.scale = scale;
    }

    /// Gives samples other light: `light_of` tells red, green and blue of a sample, whose light is told to it, in shares of a pixel's
    /// coverage. Nodes that stand for several have what these have together. Coverage, and what is drawn, stays as it is.
    pub fn relight(&mut self, light_of: &(impl Fn(u32, Rgb) -> Rgb + Sync)) {
        let mut rest = self.nodes.as_mut_slice();
        let mut blocks = Vec::with_capacity(self.blocks.len());
        for block in &self.blocks {
            let (nodes, after) = std::mem::take(&mut rest).split_at_mut(block.len());
            blocks.push((nodes, block.start));
            rest = after;
        }
        let (samples, scale) = (&self.sample_of_node, self.scale);
        blocks.into_par_iter().for_each(|(nodes, first)| {
            // The nodes that a node replaces come after it.
            for index in (0..nodes.len()).rev() {
                let node = nodes[index];
                let [.., coverage] = node.light;
                if coverage <= 0.0 {
                    continue;
                }
                let rgb = if node.is_leaf() {
                    let own = [0, 1, 2].map(|c| node.light[c] / coverage);
                    light_of(samples[first as usize + index], own)
                } else {
                    let children = node.children().start - first..node.children().end - first;
                    let mut sum = [0.0; 4];
                    for child in &nodes[children.start as usize..children.end as usize] {
                        let weight = scale.weight_of_quantum(child);
                        (0..4).for_each(|c| sum[c] += weight * child.light[c]);
                    }
                    [0, 1, 2].map(|c| if sum[3] > 0.0 { sum[c] / sum[3] } else { 0.0 })
                };
                let [r, g, b] = rgb.map(|c| c * coverage);
                nodes[index].light = [r, g, b, coverage];
            }
        });
    }

    /// The light that a bright node adds to the sum of ordinary ones: its coverage.
    #[inline(always)]
    pub fn dim_coverage(&self, node: &SplatNode) -> [f32; 4] {
        let finer = self.scale.dim_bits - self.scale.bright_bits;
        [0.0, 0.0, 0.0, node.light[3] * (finer as f32).exp2()]
    }

    /// The memory that they take, in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.nodes)
            + size_of_val(&*self.cells)
            + size_of_val(&*self.sample_of_node)
            + size_of_val(&*self.node_of_sample)
            + size_of_val(&*self.block_of_node)
    }

    /// The pixel row in which the centre of the node with this index lies.
    pub fn row_of(&self, index: u32) -> i32 {
        self.nodes[index as usize].center[1] >> POSITION_BITS
    }

    /// The nodes of the block with this number.
    pub fn block_nodes(&self, block: usize) -> &[SplatNode] {
        let range = &self.blocks[block];
        &self.nodes[range.start as usize..range.end as usize]
    }

    /// The nodes of these samples, in order.
    pub fn leaves_of(&self, samples: &[u32]) -> Vec<u32> {
        let mut leaves: Vec<_> = samples.iter().map(|&sample| self.node_of_sample[sample as usize]).collect();
        leaves.par_sort_unstable();
        leaves
    }

    /// How many nodes see a part of the aperture.
    pub fn partial_count(&self) -> usize {
        self.cells.len()
    }

    /// Which cells of the aperture see the node; `None` if it sees the whole aperture.
    #[inline(always)]
    pub fn cells(&self, node: &SplatNode) -> Option<&Cells> {
        self.cells.get(node.cells as usize)
    }
}

/// The places of things that stand one group after the other, so many in each.
fn places(counts: impl Iterator<Item = usize>) -> Vec<Range<u32>> {
    let following = |next: &mut u32, count: usize| {
        let start = *next;
        *next += count as u32;
        Some(start..*next)
    };
    counts.scan(0, following).collect()
}

/// A block in integers: places are counted from its beginning.
struct Part {
    nodes: Vec<SplatNode>,
    roots: u32,
    cells: Vec<Cells>,
    /// The sample of each node that is one.
    samples: Vec<u32>,
    /// The largest radiance of a sample.
    brightest: f32,
    has_bright: bool,
}

impl Part {
    /// `None` if a node is too bright.
    fn new(block: Block, scale: Scale, corner: [i32; 2]) -> Option<Self> {
        let at_corner = |node: SplatNode| {
            let [x, y] = node.center;
            SplatNode { center: [x - corner[0], y - corner[1]], ..node }
        };
        let nodes = block.nodes.iter().map(|node| convert(node, scale).map(at_corner));
        let nodes = nodes.collect::<Option<Vec<_>>>()?;
        let leaves = block.nodes.iter().filter(|node| node.sample.is_some());
        let rows = |words: &[u64; 4]| std::array::from_fn(|row| (words[row / 4] >> (row % 4 * 16)) as u16);
        Some(Self {
            roots: block.roots,
            cells: block.cells.iter().map(rows).collect(),
            samples: block.nodes.iter().map(|node| node.sample.unwrap_or(u32::MAX)).collect(),
            brightest: leaves.map(|node| node.radiance.max_element()).fold(0.0, f32::max),
            has_bright: nodes.iter().any(|node| node.is_bright),
            nodes,
        })
    }
}

/// A node in integers. `None` if it is too bright.
fn convert(node: &Node, scale: Scale) -> Option<SplatNode> {
    const NARROWEST: f32 = PIXEL as f32 / 32.0;
    // What is nearer is that near, so that no product overflows; nodes of no weight are at no depth.
    const NEAREST: f32 = 1e12;
    let nearness = |x: f32| if x >= f32::MIN_POSITIVE { x.min(NEAREST) } else { 0.0 };
    let fixed = |px: f32| (px * PIXEL as f32).round() as i32;
    let half_size =
        node.half_size.to_array().map(|half| (half * PIXEL as f32).round().clamp(NARROWEST, 65535.0));
    // Where the weight changes sign over the aperture it is given as a share of its largest.
    let largest = node.weight.abs() + node.tilt.abs().element_sum();
    let is_edge_on = node.tilt.abs().element_sum() > node.weight;
    let weight = if is_edge_on { largest } else { node.weight };
    let share = |part: f32| (part / weight * ONE as f32).round() as i16;
    let density = weight / (4.0 * half_size[0] * half_size[1] / (PIXEL * PIXEL) as f32);
    let brightness = node.radiance.max_element().max(1.0) * density.max(1.0);
    if brightness > BRIGHTEST || brightness.is_nan() {
        return None;
    }
    let is_bright = brightness > BRIGHT;
    // Wide sums have one level.
    let level = if is_bright { 0 } else { node.level };
    let bits = if is_bright { scale.bright_bits } else { scale.dim_bits };
    let quanta = weight * 0.25f32.powi(level as i32) * (bits as f32).exp2();
    let [r, g, b] = node.radiance.to_array();
    debug_assert!((node.level as usize) < LEVELS && node.children.len() <= usize::from(u8::MAX));
    Some(SplatNode {
        center: node.center.to_array().map(fixed),
        half_size: half_size.map(|half| half as u16),
        level,
        is_bright,
        contrast: contrast(node),
        is_highlight: node.radiance.max_element() > HIGHLIGHT,
        cells: node.cells.unwrap_or(OPEN),
        inverse_depth: nearness(node.inverse_depth),
        inverse_depth_spread: nearness(node.inverse_depth_spread),
        // Nodes of no weight at all have no mean to speak of, and no light.
        light: [r, g, b, 1.0].map(|value| value * quanta).map(|value| if value > 0.0 { value } else { 0.0 }),
        base: if is_edge_on { share(node.weight) } else { ONE as i16 },
        tilt: [share(node.tilt.x), share(node.tilt.y)],
        first_child: node.children.start,
        child_count: node.children.len() as u8,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Vec2, Vec3};

    #[test]
    fn nodes_without_weight_have_no_light() {
        let node = Node {
            center: Vec2::NAN,
            half_size: Vec2::NAN,
            inverse_depth: f32::NAN,
            inverse_depth_spread: f32::NAN,
            weight: 0.0,
            tilt: Vec2::ZERO,
            radiance: Vec3::NAN,
            dipole: f32::NAN,
            level: 1,
            cells: None,
            children: 0..0,
            sample: None,
        };
        let converted = convert(&node, Scale::FINEST).expect("it is not bright");
        assert_eq!(converted.light, [0.0; 4]);
        let lit =
            convert(&Node { weight: 4.0, radiance: Vec3::ONE, ..node }, Scale::FINEST).expect("nor this");
        assert!(lit.light.iter().all(|&light| light > 0.0));
    }
}
