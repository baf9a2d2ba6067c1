//! Nodes in the card's memory.

use crate::gpu::Gpu;
use crate::gpu::device::Lost;
use crate::nodes::{Nodes, SplatNode};
use crate::seen::Seen;
use std::ops::Range;
use wgpu::{Buffer, BufferUsages};

/// Nodes of a chunk at most: with ten words each a chunk is within the 128 MiB that any card can bind.
const CHUNK_NODES: u32 = 1 << 21;

/// Words of a node.
const WORDS: usize = 10;

/// Words of what a partly occluded one sees.
const SEEN_WORDS: usize = 11;

/// A light field's nodes, in chunks of whole blocks.
pub struct Scene {
    pub chunks: Vec<Chunk>,
    /// The scale that light was uploaded at.
    pub dim_bits: i32,
}

/// Neighbouring blocks.
pub struct Chunk {
    pub blocks: Range<usize>,
    /// Its first node.
    pub first: u32,
    pub nodes: Buffer,
    /// What its partly occluded nodes see, after [`Scene::upload_seen`].
    pub cells: Buffer,
    partial: Vec<u32>,
}

impl Scene {
    /// Uploads the nodes.
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

    /// Bytes on the card.
    pub fn bytes(&self) -> usize {
        let buffers = self.chunks.iter().flat_map(|chunk| [&chunk.nodes, &chunk.cells]);
        buffers.map(|buffer| buffer.size() as usize).sum()
    }

    /// Uploads what partly occluded nodes see of an aperture.
    pub fn upload_seen(&self, gpu: &Gpu, nodes: &Nodes, seen: &[Seen]) {
        for chunk in &self.chunks {
            let mut words = Vec::with_capacity(chunk.partial.len() * SEEN_WORDS);
            for &index in &chunk.partial {
                let node = &nodes.nodes[index as usize];
                if let Some(cells) = nodes.cells(node) {
                    let seen = &seen[node.cells as usize];
                    words.extend(cells.chunks_exact(2).map(|pair| pair_of(pair[0], pair[1])));
                    words.extend([seen.share, pair_of(seen.mean[0] as u16, seen.mean[1] as u16)]);
                    words.push(pair_of(seen.half[0], seen.half[1]));
                }
            }
            gpu.write(&chunk.cells, &words);
        }
    }
}

impl Chunk {
    fn new(gpu: &Gpu, nodes: &Nodes, blocks: Range<usize>, range: Range<u32>) -> Result<Self, Lost> {
        let of_chunk = &nodes.nodes[range.start as usize..range.end as usize];
        let (mut words, mut partial) = (Vec::with_capacity(of_chunk.len() * WORDS), Vec::new());
        for (index, node) in range.clone().zip(of_chunk) {
            words.extend(words_of_node(node, partial.len() as u32));
            if !node.is_open() {
                partial.push(index);
            }
        }
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_DST;
        let buffer = gpu.buffer("nodes", words.len(), usage)?;
        gpu.write(&buffer, &words);
        let cells = gpu.buffer("cells", partial.len() * SEEN_WORDS, usage)?;
        Ok(Self { blocks, first: range.start, nodes: buffer, cells, partial })
    }
}

fn pair_of(low: u16, high: u16) -> u32 {
    low as u32 | (high as u32) << 16
}

/// A node as draw.wgsl reads it; `cells` is its place among the partly occluded ones.
fn words_of_node(node: &SplatNode, cells: u32) -> [u32; WORDS] {
    let light = node.light.map(f32::to_bits);
    [
        node.center[0] as u32,
        node.center[1] as u32,
        pair_of(node.half_size[0], node.half_size[1]),
        pair_of(node.level as u16 | (node.is_bright as u16) << 7, node.base as u16),
        pair_of(node.tilt[0] as u16, node.tilt[1] as u16),
        cells,
        light[0],
        light[1],
        light[2],
        light[3],
    ]
}

impl Gpu {
    /// A buffer of so many words (at least a few, for none can be bound that is empty).
    pub(super) fn buffer(&self, label: &str, words: usize, usage: BufferUsages) -> Result<Buffer, Lost> {
        let size = 4 * words.max(16) as u64;
        if size > self.largest_binding() {
            return Err(Lost);
        }
        let scope = self.device().push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let descriptor =
            wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false };
        let buffer = self.device().create_buffer(&descriptor);
        match pollster::block_on(scope.pop()) {
            Some(_) => Err(Lost),
            None => Ok(buffer),
        }
    }

    /// Writes words to a buffer's beginning.
    pub(super) fn write(&self, buffer: &Buffer, words: &[u32]) {
        if !words.is_empty() {
            self.queue().write_buffer(buffer, 0, bytemuck::cast_slice(words));
        }
    }
}
