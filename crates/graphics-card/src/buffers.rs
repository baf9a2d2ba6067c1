//! Buffers in the card's memory: made, written, bound and read.

use crate::{Gpu, Lost};
use bytemuck::Pod;
use std::ops::Range;
use std::sync::mpsc;
use wgpu::{BindGroup, BindGroupLayout, Buffer, BufferUsages};

impl Gpu {
    /// A buffer of this many words (at least a few: empty buffers cannot be bound).
    ///
    /// # Errors
    /// The card is lost, or has no room.
    pub fn buffer(&self, label: &str, words: usize, usage: BufferUsages) -> Result<Buffer, Lost> {
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

    /// Room for a struct that shaders read.
    ///
    /// # Errors
    /// The card is lost, or has no room.
    pub fn struct_buffer<T: Pod>(&self, label: &str, usage: BufferUsages) -> Result<Buffer, Lost> {
        self.buffer(label, size_of::<T>() / 4, usage | BufferUsages::COPY_DST)
    }

    /// Writes a struct that shaders read.
    pub fn write_struct<T: Pod>(&self, buffer: &Buffer, value: &T) {
        self.write(buffer, bytemuck::cast_slice(std::slice::from_ref(value)));
    }

    /// Writes words to a buffer's beginning.
    pub fn write(&self, buffer: &Buffer, words: &[u32]) {
        self.write_at(buffer, 0, words);
    }

    /// Writes words, from the one at `first` on, to their places in a buffer.
    pub fn write_at(&self, buffer: &Buffer, first: usize, words: &[u32]) {
        if first < words.len() {
            self.queue().write_buffer(buffer, 4 * first as u64, bytemuck::cast_slice(&words[first..]));
        }
    }

    /// Buffers at their bindings.
    pub fn bind<'a>(
        &self,
        layout: &BindGroupLayout,
        buffers: impl IntoIterator<Item = (u32, &'a Buffer)>,
    ) -> BindGroup {
        let entry = |(binding, buffer): (u32, &'a Buffer)| wgpu::BindGroupEntry {
            binding,
            resource: buffer.as_entire_binding(),
        };
        let entries: Vec<_> = buffers.into_iter().map(entry).collect();
        let descriptor = wgpu::BindGroupDescriptor { label: None, layout, entries: &entries };
        self.device().create_bind_group(&descriptor)
    }

    /// The words of a range of bytes of a buffer.
    ///
    /// # Errors
    /// The card is lost.
    pub fn read(&self, buffer: &Buffer, range: Range<u64>) -> Result<Vec<u32>, Lost> {
        self.read_all(&[(buffer, range)])
    }

    /// The words of ranges of bytes of buffers, one after the other, waited for once.
    ///
    /// # Errors
    /// The card is lost.
    pub fn read_all(&self, parts: &[(&Buffer, Range<u64>)]) -> Result<Vec<u32>, Lost> {
        self.check()?;
        let size = parts.iter().map(|(_, range)| range.end - range.start).sum::<u64>();
        let usage = BufferUsages::MAP_READ | BufferUsages::COPY_DST;
        let staging = self.buffer("read", size as usize / 4, usage)?;
        let mut encoder = self.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut first = 0;
        for (buffer, range) in parts {
            let size = range.end - range.start;
            encoder.copy_buffer_to_buffer(buffer, range.start, &staging, first, size);
            first += size;
        }
        let submission = self.queue().submit([encoder.finish()]);
        let (sender, receiver) = mpsc::channel();
        staging.map_async(wgpu::MapMode::Read, 0..size, move |result| {
            // Nobody listens any more where the device was lost meanwhile.
            let _ = sender.send(result.is_ok());
        });
        self.wait_for(submission)?;
        if !self.receive(&receiver)? {
            return Err(Lost);
        }
        let view = staging.get_mapped_range(0..size).map_err(|_| Lost)?;
        self.check()?;
        Ok(view.chunks_exact(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect())
    }
}
