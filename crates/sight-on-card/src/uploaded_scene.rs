//! A scene's triangles in the card's memory.

use crate::formats::{Node, Triangle};
use graphics_card::{Gpu, Lost};
use scene::Scene;
use std::sync::{Arc, Weak};
use trace::Tracer;
use wgpu::{Buffer, BufferUsages};

/// The hierarchy and its triangles on a card.
pub struct UploadedScene {
    of: Weak<Scene>,
    pub nodes: Buffer,
    pub triangles: Buffer,
    pub node_count: u32,
}

/// Nodes or triangles that are converted at once, so that little of the processor's memory is taken.
const AT_ONCE: usize = 1 << 16;

impl UploadedScene {
    /// Uploads a tracer's scene.
    ///
    /// # Errors
    /// The card is lost, or has no room.
    pub fn new(gpu: &Gpu, tracer: &Tracer) -> Result<Self, Lost> {
        let flat = tracer.flat();
        let [node_count, triangle_count] = flat.counts();
        let nodes = buffer::<Node>(gpu, "nodes", node_count)?;
        write_all(gpu, &nodes, flat.nodes().map(Node::from));
        let triangles = buffer::<Triangle>(gpu, "triangles", triangle_count)?;
        write_all(gpu, &triangles, flat.triangles().map(Triangle::from));
        gpu.check()?;
        let of = Arc::downgrade(flat.scene());
        Ok(Self { of, nodes, triangles, node_count: node_count as u32 })
    }

    /// Whether it is that of this tracer's scene.
    pub fn is_of(&self, tracer: &Tracer) -> bool {
        std::ptr::eq(self.of.as_ptr(), Arc::as_ptr(tracer.scene())) && self.of.strong_count() > 0
    }
}

/// Room for some items.
fn buffer<T>(gpu: &Gpu, label: &str, count: usize) -> Result<Buffer, Lost> {
    gpu.buffer(label, count.max(1) * size_of::<T>() / 4, BufferUsages::STORAGE | BufferUsages::COPY_DST)
}

/// Writes all items, some at a time.
fn write_all<T: bytemuck::Pod>(gpu: &Gpu, buffer: &Buffer, mut items: impl Iterator<Item = T>) {
    let mut written = 0;
    loop {
        let some: Vec<T> = items.by_ref().take(AT_ONCE).collect();
        if some.is_empty() {
            return;
        }
        gpu.queue().write_buffer(buffer, written, bytemuck::cast_slice(&some));
        written += size_of_val(some.as_slice()) as u64;
        // Uploads what was staged.
        gpu.queue().submit([]);
    }
}
