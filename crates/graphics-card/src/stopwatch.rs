//! Time measured by the card's own clock.

use crate::{Gpu, Lost};
use wgpu::{Buffer, BufferUsages, ComputePassTimestampWrites, QuerySet};

/// Two moments of the card's clock.
pub struct Stopwatch {
    moments: QuerySet,
    words: Buffer,
}

impl Stopwatch {
    /// A stopwatch by the card's own clock; `None` where the card has none.
    ///
    /// # Errors
    /// The card is lost.
    pub fn new(gpu: &Gpu) -> Result<Option<Self>, Lost> {
        if !gpu.device().features().contains(wgpu::Features::TIMESTAMP_QUERY) {
            return Ok(None);
        }
        let moments = gpu.device().create_query_set(&wgpu::QuerySetDescriptor {
            label: Some("moments"),
            ty: wgpu::QueryType::Timestamp,
            count: 2,
        });
        let usage = BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC;
        Ok(Some(Self { moments, words: gpu.buffer("moments", 4, usage)? }))
    }

    /// Takes the first moment.
    pub fn begin(&self, gpu: &Gpu) {
        self.write_timestamp(gpu, Some(0), None);
    }

    /// Takes the second moment.
    pub fn end(&self, gpu: &Gpu) {
        self.write_timestamp(gpu, None, Some(1));
    }

    /// Notes when the card has come so far.
    fn write_timestamp(&self, gpu: &Gpu, begin: Option<u32>, end: Option<u32>) {
        let writes = ComputePassTimestampWrites {
            query_set: &self.moments,
            beginning_of_pass_write_index: begin,
            end_of_pass_write_index: end,
        };
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder
            .begin_compute_pass(&wgpu::ComputePassDescriptor { label: None, timestamp_writes: Some(writes) });
        gpu.queue().submit([encoder.finish()]);
    }

    /// Seconds from the first to the second moment, by the card's clock.
    ///
    /// # Errors
    /// The card is lost.
    pub fn seconds(&self, gpu: &Gpu) -> Result<f64, Lost> {
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.resolve_query_set(&self.moments, 0..2, &self.words, 0);
        gpu.queue().submit([encoder.finish()]);
        let words = gpu.read(&self.words, 0..16)?;
        let moment = |k: usize| u64::from(words[2 * k]) | u64::from(words[2 * k + 1]) << 32;
        let ticks = moment(1).wrapping_sub(moment(0));
        Ok(ticks as f64 * f64::from(gpu.queue().get_timestamp_period()) * 1e-9)
    }
}
