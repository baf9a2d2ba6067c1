//! Nodes in the card's memory.

use crate::aperture::moments::MomentCache;
use crate::gpu::formats::{
    FOCUS_WORDS, NO_PARENT, NODE_CONTRAST_BIT, NODE_IS_BRIGHT, NODE_IS_HIGHLIGHT, NODE_IS_LEAF, NODE_IS_OPEN,
    NODE_WORDS, PARTIAL_WORDS,
};
use crate::lens_in_use::NodeFocus;
use crate::nodes::{Nodes, SplatNode};
use crate::paint::Paint;
use graphics_card::{Gpu, Lost};
use std::iter::repeat_n;
use std::ops::Range;
use std::sync::Arc;
use wgpu::{Buffer, BufferUsages};

/// Nodes of a chunk at most: with 13 words each a chunk is within the 128 MiB that any card can bind.
/// Tests' scenes have several, too.
const CHUNK_NODES: u32 = if cfg!(test) { 1 << 11 } else { 1 << 21 };

/// A light field's nodes, in chunks of whole blocks.
pub struct Scene {
    /// The chunks, in the order of the nodes.
    pub chunks: Vec<Chunk>,
    /// The scale that light was uploaded at.
    pub dim_bits: i32,
}

/// Neighbouring blocks.
pub struct Chunk {
    /// The nodes, which twins share.
    pub shared: Arc<NodesOfChunk>,
    /// The cells and moments of its partly occluded nodes, after [`Scene::upload_moments`].
    pub cells: Buffer,
    /// What is painted on its nodes, after [`Scene::upload_paint`]; none if nothing is.
    pub focus: Option<Buffer>,
}

/// What is the same whatever lens and paint: splatters of one light field share it.
pub struct NodesOfChunk {
    /// The blocks whose nodes these are.
    pub blocks: Range<usize>,
    /// The first of them.
    pub first: u32,
    /// So many.
    pub count: u32,
    /// The nodes on the card.
    pub nodes: Buffer,
    partial: Vec<u32>,
}

impl Scene {
    /// Uploads the nodes.
    ///
    /// # Errors
    /// The card is lost.
    pub fn new(gpu: &Gpu, nodes: &Nodes) -> Result<Self, Lost> {
        let mut chunks = Vec::new();
        let mut block = 0;
        while block < nodes.blocks.len() {
            let first = nodes.blocks[block].start;
            let rest = &nodes.blocks[block..];
            let fits = rest.iter().take_while(|block| block.end - first <= CHUNK_NODES).count().max(1);
            let end = nodes.blocks[block + fits - 1].end;
            chunks.push(Chunk::new(gpu, nodes, block..block + fits, first..end)?);
            block += fits;
        }
        Ok(Self { chunks, dim_bits: nodes.scale.dim_bits })
    }

    /// The same nodes, without a second upload, for another lens and paint.
    ///
    /// # Errors
    /// The card is lost.
    pub fn twin(&self, gpu: &Gpu) -> Result<Self, Lost> {
        let chunks = self.chunks.iter().map(|chunk| Chunk::with_shared(gpu, chunk.shared.clone()));
        Ok(Self { chunks: chunks.collect::<Result<_, Lost>>()?, dim_bits: self.dim_bits })
    }

    /// The memory on the card, in bytes: what twins share, and its own.
    pub fn bytes(&self) -> [usize; 2] {
        let shared = self.chunks.iter().map(|chunk| chunk.shared.nodes.size());
        let own = |chunk: &Chunk| chunk.cells.size() + chunk.focus.as_ref().map_or(0, Buffer::size);
        [shared.sum::<u64>(), self.chunks.iter().map(own).sum()].map(|bytes| bytes as usize)
    }

    /// Uploads the cells and aperture moments of partly occluded nodes.
    pub fn upload_moments(&self, gpu: &Gpu, nodes: &Nodes, moments: &MomentCache) {
        for chunk in &self.chunks {
            let partial = &chunk.shared.partial;
            let mut words = Vec::with_capacity(partial.len() * PARTIAL_WORDS);
            for &index in partial {
                let node = &nodes.nodes[index as usize];
                if let Some(cells) = nodes.cells(node) {
                    let node_moments = moments.of(nodes, node);
                    words.extend(cells.chunks_exact(2).map(|pair| pack_pair(pair[0], pair[1])));
                    words.extend([
                        node_moments.share,
                        pack_pair(node_moments.mean[0] as u16, node_moments.mean[1] as u16),
                    ]);
                    words.push(pack_pair(node_moments.half_width[0], node_moments.half_width[1]));
                }
            }
            gpu.write(&chunk.cells, &words);
        }
    }

    /// Uploads what is painted on the nodes.
    ///
    /// # Errors
    /// The card is lost.
    pub fn upload_paint(&mut self, gpu: &Gpu, nodes: &Nodes, paint: &Paint) -> Result<(), Lost> {
        for chunk in &mut self.chunks {
            let NodesOfChunk { blocks, count, .. } = &*chunk.shared;
            if blocks.clone().all(|block| paint.block(block).is_none()) {
                chunk.focus = None;
                continue;
            }
            let mut words = Vec::with_capacity(*count as usize * FOCUS_WORDS);
            for block in blocks.clone() {
                let standard = || repeat_n(&NodeFocus::STANDARD, nodes.blocks[block].len());
                match paint.block(block) {
                    Some(painted) => words.extend(painted.iter().flat_map(words_of_focus)),
                    None => words.extend(standard().flat_map(words_of_focus)),
                }
            }
            if chunk.focus.is_none() {
                let usage = BufferUsages::STORAGE | BufferUsages::COPY_DST;
                chunk.focus = Some(gpu.buffer("focus", words.len(), usage)?);
            }
            if let Some(focus) = &chunk.focus {
                gpu.write(focus, &words);
            }
        }
        Ok(())
    }
}

impl Chunk {
    fn new(gpu: &Gpu, nodes: &Nodes, blocks: Range<usize>, range: Range<u32>) -> Result<Self, Lost> {
        let of_chunk = &nodes.nodes[range.start as usize..range.end as usize];
        let (mut words, mut partial) = (Vec::with_capacity(of_chunk.len() * NODE_WORDS), Vec::new());
        let mut parents = vec![NO_PARENT; of_chunk.len()];
        for (parent, node) in (0..).zip(of_chunk) {
            node.children().for_each(|child| parents[(child - range.start) as usize] = parent);
        }
        for ((index, node), parent) in range.clone().zip(of_chunk).zip(parents) {
            words.extend(words_of_node(node, partial.len() as u32, parent));
            if !node.is_open() {
                partial.push(index);
            }
        }
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_DST;
        let buffer = gpu.buffer("nodes", words.len(), usage)?;
        gpu.write(&buffer, &words);
        let (first, count) = (range.start, range.len() as u32);
        Self::with_shared(gpu, Arc::new(NodesOfChunk { blocks, first, count, nodes: buffer, partial }))
    }

    fn with_shared(gpu: &Gpu, shared: Arc<NodesOfChunk>) -> Result<Self, Lost> {
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_DST;
        let cells = gpu.buffer("cells", shared.partial.len() * PARTIAL_WORDS, usage)?;
        Ok(Self { shared, cells, focus: None })
    }
}

fn pack_pair(low: u16, high: u16) -> u32 {
    low as u32 | (high as u32) << 16
}

/// A node as pen.wgsl and draw_list.wgsl read it; `cells` is its index among the partly occluded ones, `parent` that of the node
/// above it in the chunk.
fn words_of_node(node: &SplatNode, cells: u32, parent: u32) -> [u32; NODE_WORDS] {
    let light = node.light.map(f32::to_bits);
    let flag = |is_set: bool, flag: u32| if is_set { flag } else { 0 };
    let flags = flag(node.is_highlight, NODE_IS_HIGHLIGHT)
        | flag(node.is_leaf(), NODE_IS_LEAF)
        | flag(node.is_open(), NODE_IS_OPEN)
        | flag(node.is_bright, NODE_IS_BRIGHT)
        | u32::from(node.contrast) << NODE_CONTRAST_BIT;
    [
        node.center[0] as u32,
        node.center[1] as u32,
        pack_pair(node.half_size[0], node.half_size[1]),
        pack_pair((u32::from(node.level) | flags) as u16, node.base as u16),
        pack_pair(node.tilt[0] as u16, node.tilt[1] as u16),
        cells,
        light[0],
        light[1],
        light[2],
        light[3],
        node.inverse_depth.to_bits(),
        node.inverse_depth_spread.to_bits(),
        parent,
    ]
}

fn words_of_focus(focus: &NodeFocus) -> [u32; FOCUS_WORDS] {
    [focus.t, focus.anchor, focus.t_apart, focus.anchor_apart].map(f32::to_bits)
}
