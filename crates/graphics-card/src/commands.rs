//! Passes that are submitted together.

use crate::{Gpu, Pass};
use wgpu::{BindGroup, Buffer, CommandEncoder, SubmissionIndex};

/// What is to be done, one thing after the other.
pub struct Commands<'g> {
    gpu: &'g Gpu,
    encoder: CommandEncoder,
}

impl<'g> Commands<'g> {
    /// An empty list of commands for a card.
    pub fn new(gpu: &'g Gpu) -> Self {
        let encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        Self { gpu, encoder }
    }

    /// Records a pass with these buffers, in `x` × `y` workgroups.
    pub fn dispatch(&mut self, pass: &Pass, bound: &BindGroup, [x, y]: [u32; 2]) {
        let mut compute = self.encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        compute.set_pipeline(pass.pipeline(self.gpu.device()));
        compute.set_bind_group(0, bound, &[]);
        compute.dispatch_workgroups(x, y, 1);
    }

    /// Records that a buffer is set to 0.
    pub fn clear(&mut self, buffer: &Buffer) {
        self.encoder.clear_buffer(buffer, 0, None);
    }

    /// Submits the recorded commands to the card.
    pub fn submit(self) -> SubmissionIndex {
        self.gpu.queue().submit([self.encoder.finish()])
    }
}
