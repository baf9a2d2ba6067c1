//! What is painted on the nodes.

use crate::fixed::ONE;
use crate::lens_in_use::{LARGEST_OFFSET, NodeFocus};
use crate::nodes::Nodes;
use lens::FocusOffset;
use rayon::prelude::*;
use salf::{Addresses, SampleFocus, Samples};
use std::sync::Arc;
use surface::SurfaceField;

/// Focus of all nodes, block by block; a block on which nothing is painted has none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Paint {
    /// By block: the focus of its nodes, which clones share until it changes.
    pub blocks: Vec<Option<Arc<[NodeFocus]>>>,
}

/// Nothing is painted.
pub static STANDARD: Paint = Paint { blocks: Vec::new() };

impl Paint {
    /// Looks up the focus of every sample, and combines it for the nodes above.
    pub fn sample(nodes: &Nodes, focus: FocusOfSamples) -> Self {
        let blocks = (0..nodes.blocks.len()).into_par_iter().map(|block| {
            let first = nodes.blocks[block].start as usize;
            let of_nodes = nodes.block_nodes(block);
            let mut lookup = focus.lookup();
            let mut painted: Option<Vec<NodeFocus>> = None;
            for index in (0..of_nodes.len()).filter(|&index| of_nodes[index].is_leaf()) {
                let focus_of_node = lookup.get(nodes.sample_of_node[first + index]);
                if focus_of_node != NodeFocus::STANDARD {
                    painted.get_or_insert_with(|| vec![NodeFocus::STANDARD; of_nodes.len()])[index] =
                        focus_of_node;
                }
            }
            if let Some(painted) = &mut painted {
                (0..of_nodes.len()).rev().for_each(|index| combine_children(nodes, block, painted, index));
            }
            painted.map(Arc::from)
        });
        Self { blocks: blocks.collect() }
    }

    /// Whether nothing is painted: every node has the standard focus.
    pub fn is_standard(&self) -> bool {
        self.blocks.iter().all(Option::is_none)
    }

    /// Whether less than half of the nodes lie in blocks that are painted.
    pub fn is_of_less_than_half(&self, nodes: &Nodes) -> bool {
        let painted = nodes.blocks.iter().zip(&self.blocks).filter(|(_, paint)| paint.is_some());
        2 * painted.map(|(block, _)| block.len()).sum::<usize>() < nodes.nodes.len()
    }

    /// Looks up again the focus of the samples at `leaves`, nodes in order. Returns the blocks they are in, and what was
    /// painted on each.
    pub fn update(
        &mut self,
        nodes: &Nodes,
        leaves: &[u32],
        focus: FocusOfSamples,
    ) -> Vec<(usize, Option<Arc<[NodeFocus]>>)> {
        let block_of = |leaf: &u32| nodes.block_of_node[*leaf as usize] as usize;
        let groups: Vec<&[u32]> = leaves.chunk_by(|a, b| block_of(a) == block_of(b)).collect();
        let updated = groups.par_iter().map(|leaves| {
            let block = block_of(&leaves[0]);
            (block, self.updated(nodes, block, leaves, focus))
        });
        let mut updated: Vec<_> = updated.collect();
        for (block, paint) in &mut updated {
            std::mem::swap(paint, &mut self.blocks[*block]);
        }
        updated
    }

    /// The focus of the nodes of a block, with `leaves` updated; `None` if nothing is painted.
    fn updated(
        &self,
        nodes: &Nodes,
        block: usize,
        leaves: &[u32],
        focus: FocusOfSamples,
    ) -> Option<Arc<[NodeFocus]>> {
        let first = nodes.blocks[block].start;
        let mut painted = self.blocks[block]
            .clone()
            .unwrap_or_else(|| vec![NodeFocus::STANDARD; nodes.block_nodes(block).len()].into());
        let of_nodes = Arc::make_mut(&mut painted);
        let mut lookup = focus.lookup();
        for &leaf in leaves {
            of_nodes[(leaf - first) as usize] = lookup.get(nodes.sample_of_node[leaf as usize]);
        }
        (0..of_nodes.len()).rev().for_each(|index| combine_children(nodes, block, of_nodes, index));
        let is_standard = of_nodes.iter().all(|focus| *focus == NodeFocus::STANDARD);
        (!is_standard).then_some(painted)
    }

    /// The focus of the nodes of a block; `None` if nothing in it is painted.
    pub fn block(&self, block: usize) -> Option<&[NodeFocus]> {
        self.blocks.get(block)?.as_deref()
    }
}

/// Where the focus of samples comes from. An offset that is not valid counts as none.
#[derive(Clone, Copy)]
pub enum FocusOfSamples<'a> {
    /// A focus of the surface, at the samples' addresses.
    Surface(&'a Samples, SampleFocus<'a>),
    /// A focus for each sample.
    Samples(&'a [FocusOffset]),
}

/// Looks up the focus of samples, quickly where one is of the same block as the one before.
enum Lookup<'a> {
    Surface(Addresses<'a>, SampleFocus<'a>),
    Samples(&'a [FocusOffset]),
}

impl<'a> FocusOfSamples<'a> {
    /// That of the surface on which the samples lie.
    pub fn of_surface(samples: &'a Samples, focus: &'a dyn SurfaceField<FocusOffset>) -> Self {
        Self::Surface(samples, SampleFocus::new(focus))
    }

    fn lookup(self) -> Lookup<'a> {
        match self {
            Self::Surface(samples, focus) => Lookup::Surface(samples.addresses(), focus),
            Self::Samples(offsets) => Lookup::Samples(offsets),
        }
    }
}

impl Lookup<'_> {
    #[inline]
    fn get(&mut self, sample: u32) -> NodeFocus {
        let offset = match self {
            Self::Surface(addresses, focus) => focus.offset(addresses.get(sample)),
            Self::Samples(offsets) => offsets[sample as usize],
        };
        NodeFocus::new(offset.or_standard())
    }
}

/// Sets the focus of a node from those below it; a sample keeps its own.
fn combine_children(nodes: &Nodes, block: usize, painted: &mut [NodeFocus], index: usize) {
    let of_nodes = nodes.block_nodes(block);
    let node = &of_nodes[index];
    if node.is_leaf() {
        return;
    }
    let first = nodes.blocks[block].start;
    let children = || node.children().map(|child| (child - first) as usize);
    let standard = children().filter(|&child| painted[child] == NodeFocus::STANDARD).count();
    if standard == children().len() {
        painted[index] = NodeFocus::STANDARD;
        return;
    }
    let (mut t, mut anchor, mut weight) = (0.0f64, 0.0f64, 0.0f64);
    for child in children() {
        let share = of_nodes[child].light[3] as f64 * (1u32 << (2 * of_nodes[child].level)) as f64;
        let share = share * of_nodes[child].base.unsigned_abs() as f64 / ONE as f64;
        t += share * painted[child].t as f64;
        anchor += share * painted[child].anchor as f64;
        weight += share;
    }
    // Where nothing has weight, whatever is drawn has no light.
    let weight = weight.max(f64::MIN_POSITIVE);
    let mut mean =
        NodeFocus { t: (t / weight) as f32, anchor: (anchor / weight) as f32, ..NodeFocus::STANDARD };
    for child in children() {
        let below = painted[child];
        mean.t_apart = mean.t_apart.max(2.0 * ((below.t - mean.t).abs() + below.t_apart / 2.0));
        mean.anchor_apart =
            mean.anchor_apart.max(2.0 * ((below.anchor - mean.anchor).abs() + below.anchor_apart / 2.0));
    }
    if standard > 0 {
        mean.t_apart = LARGEST_OFFSET;
    }
    painted[index] = mean.without_subnormals();
}
