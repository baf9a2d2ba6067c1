//! Accumulators to a picture, on the card.

use crate::gpu::error::GpuError;
use crate::gpu::formats::THREADS;
use crate::gpu::layout::{Layout, Level};
use crate::gpu::passes::Passes;
use crate::gpu::shader_structs::{Frame, LineLevel};
use crate::nodes::{BRIGHT, Nodes};
use crate::resolve::balance::Gains;
use crate::resolve::knots::{KnotSums, Knots, SharedSums};
use crate::resolve::{MARGIN, Overflow, Quanta};
use graphics_card::{Commands, Gpu, Lost, Pass};
use std::ops::Range;
use wgpu::{BindGroup, Buffer, BufferUsages};

/// Lines, shares and picture.
pub struct Resolve {
    /// Of the picture.
    pub size: [usize; 2],
    levels: Vec<Level>,
    /// The uniform of each level.
    uniforms: Vec<Buffer>,
    wide_uniform: Buffer,
    frame: Buffer,
    lines: [Buffer; 2],
    shares: Buffer,
    knots: Buffer,
    gains: Buffer,
    picture: Buffer,
    overflow: Buffer,
}

/// Words of a knot's sums, and of its gains; four of the rest follow all of these.
const KNOT_WORDS: usize = 16;
const GAIN_WORDS: usize = 8;

impl Resolve {
    /// Makes the buffers in which sums of this layout become a picture of `size` columns and rows.
    ///
    /// # Errors
    /// The card is lost.
    pub fn new(gpu: &Gpu, size: [usize; 2], layout: &Layout) -> Result<Self, Lost> {
        let storage = BufferUsages::STORAGE | BufferUsages::COPY_DST | BufferUsages::COPY_SRC;
        let pixels = size[0] * size[1];
        let mut uniforms = Vec::new();
        for (k, level) in layout.levels.iter().enumerate() {
            let buffer = gpu.struct_buffer::<LineLevel>("level", BufferUsages::UNIFORM)?;
            gpu.write_struct(&buffer, &line_level(k, level, layout.levels.get(k + 1)));
            uniforms.push(buffer);
        }
        let lines = || gpu.buffer("lines", 4 * layout.lines, storage);
        let knots = Knots::new(size);
        let knot_count = knots.columns() * knots.rows();
        let resolve = Self {
            size,
            levels: layout.levels.clone(),
            uniforms,
            wide_uniform: gpu.struct_buffer::<LineLevel>("wide level", BufferUsages::UNIFORM)?,
            frame: gpu.struct_buffer::<Frame>("frame", BufferUsages::UNIFORM)?,
            lines: [lines()?, lines()?],
            shares: gpu.buffer("shares", 2 * pixels, storage)?,
            knots: gpu.buffer("knots", KNOT_WORDS * knot_count, storage)?,
            gains: gpu.buffer("gains", GAIN_WORDS * knot_count + 4, storage)?,
            picture: gpu.buffer("picture", 4 * pixels, storage)?,
            overflow: gpu.buffer("overflow", 1, storage)?,
        };
        Ok(resolve)
    }

    /// The memory that it takes on the card, in bytes.
    pub fn bytes(&self) -> usize {
        let buffers = self.lines.iter().chain([&self.shares, &self.knots, &self.gains, &self.picture]);
        buffers.map(|buffer| buffer.size() as usize).sum()
    }

    /// Sets which pixel rows are made next, and whether shares are found or light is evened out.
    pub fn begin(&self, gpu: &Gpu, nodes: &Nodes, rows: Range<u32>, is_sharing: bool, is_evened: bool) {
        let (dim, wide) = Quanta::from_nodes(nodes);
        let wide_largest = wide.largest_coverage as u64;
        let frame = Frame {
            first: rows.start as i32,
            end: rows.end as i32,
            width: self.size[0] as i32,
            is_evened: is_evened.into(),
            zero: 0,
            quantum: dim.quantum as f32,
            wide_quantum: wide.quantum as f32,
            largest: dim.largest_coverage.min(i32::MAX as i64) as i32,
            wide_largest: [wide_largest as u32, (wide_largest >> 32) as u32],
            is_sharing: is_sharing.into(),
            padding: 0,
        };
        gpu.write_struct(&self.frame, &frame);
        gpu.write(&self.overflow, &[0]);
    }

    /// Integrates the pixel rows `rows` of the sums of free (`kind` 0) or sharing (1) samples to lines, coarse levels
    /// first. Recorded in `work`, not yet run.
    pub fn integrate(&self, gpu: &Gpu, work: &mut Commands, kind: usize, sums: &Buffer, rows: &Range<u32>) {
        let passes = Passes::of(gpu);
        for (k, level) in self.levels.iter().enumerate().rev() {
            let bound = self.integrate_bind_group(gpu, sums, kind, &self.uniforms[k]);
            // The requested rows, and those that they are made of.
            let [first, end] = if k == 0 {
                [rows.start as i32, rows.end as i32]
            } else {
                [(rows.start as i32 >> k) - MARGIN, ((rows.end as i32 - 1) >> k) + MARGIN + 1]
            };
            let count = end.min(level.height as i32 + 1) - first.max(-1);
            work.dispatch(&passes.integrate, &bound, [count.max(0) as u32, 1]);
        }
    }

    /// Adds the sums of bright free (`kind` 0) or sharing (1) samples to the lines of `rows`. Recorded in `work`, not
    /// yet run.
    ///
    /// # Errors
    /// The card is lost.
    pub fn integrate_wide(
        &self,
        gpu: &Gpu,
        work: &mut Commands,
        kind: usize,
        sums: &Buffer,
        layout: &Layout,
        rows: &Range<u32>,
    ) -> Result<(), Lost> {
        gpu.write_struct(&self.wide_uniform, &line_level(0, layout.levels.first().ok_or(Lost)?, None));
        let bound = self.integrate_bind_group(gpu, sums, kind, &self.wide_uniform);
        work.dispatch(&Passes::of(gpu).integrate_wide, &bound, [rows.len() as u32, 1]);
        Ok(())
    }

    fn integrate_bind_group(&self, gpu: &Gpu, sums: &Buffer, kind: usize, level: &Buffer) -> BindGroup {
        let buffers = [sums, &self.lines[kind], level, &self.frame, &self.overflow];
        gpu.bind(&Passes::of(gpu).integrate_layout, (0..).zip(buffers))
    }

    /// Makes the shares or the picture from the lines of pixel rows, and submits that.
    pub fn finish(&self, gpu: &Gpu, rows: &Range<u32>) {
        let across = (self.size[0] as u32).div_ceil(THREADS);
        let mut work = Commands::new(gpu);
        work.dispatch(&Passes::of(gpu).finish, &self.finish_bind_group(gpu), [across, rows.len() as u32]);
        work.submit();
    }

    /// What lines and shares contribute to each knot, row by row.
    ///
    /// # Errors
    /// The card is lost, or an integer has overflowed.
    pub fn knot_sums(&self, gpu: &Gpu) -> Result<Vec<KnotSums>, GpuError> {
        let knots = Knots::new(self.size);
        let sums = self.sums(gpu, &Passes::of(gpu).balance, [knots.columns(), knots.rows()])?;
        Ok(sums.into_iter().map(KnotSums).collect())
    }

    /// What lines, shares and gains contribute to each cell between knots, row by row.
    ///
    /// # Errors
    /// The card is lost, or an integer has overflowed.
    pub fn shared_sums(&self, gpu: &Gpu) -> Result<Vec<SharedSums>, GpuError> {
        let knots = Knots::new(self.size);
        let sums = self.sums(gpu, &Passes::of(gpu).share, [knots.columns() - 1, knots.rows() - 1])?;
        Ok(sums.into_iter().map(SharedSums).collect())
    }

    /// The sums that a pass makes, `COUNT` a workgroup.
    fn sums<const COUNT: usize>(
        &self,
        gpu: &Gpu,
        pass: &Pass,
        groups: [usize; 2],
    ) -> Result<Vec<[[f32; 4]; COUNT]>, GpuError> {
        let mut work = Commands::new(gpu);
        work.dispatch(pass, &self.finish_bind_group(gpu), groups.map(|groups| groups as u32));
        work.submit();
        let bytes = groups[0] * groups[1] * size_of::<[[f32; 4]; COUNT]>();
        let words = self.checked(gpu, &self.knots, 0..bytes as u64)?;
        let floats: Vec<f32> = words.into_iter().map(f32::from_bits).collect();
        Ok(floats.as_chunks().0.as_chunks().0.to_vec())
    }

    /// Uploads the gains.
    pub fn set_gains(&self, gpu: &Gpu, gains: &Gains, rest: [f32; 3]) {
        let all = gains.knot_gains().as_flattened().iter().chain([&rest]);
        let words = all.flat_map(|[r, g, b]| [*r, *g, *b, 1.0].map(f32::to_bits));
        gpu.write(&self.gains, &words.collect::<Vec<_>>());
    }

    fn finish_bind_group(&self, gpu: &Gpu) -> BindGroup {
        let (level, [free, sharing]) = (&self.uniforms[0], &self.lines);
        let buffers = [
            (2, level),
            (3, &self.frame),
            (5, free),
            (6, sharing),
            (7, &self.shares),
            (8, &self.picture),
            (9, &self.knots),
            (10, &self.gains),
        ];
        gpu.bind(&Passes::of(gpu).finish_layout, buffers)
    }

    /// Waits for all submitted work, and checks that no integer has overflowed.
    ///
    /// # Errors
    /// The card is lost, or an integer has overflowed.
    pub fn check(&self, gpu: &Gpu) -> Result<(), GpuError> {
        self.checked(gpu, &self.overflow, 0..4).map(|_| ())
    }

    /// The words of a range of bytes of a buffer, if all integers held what they were given.
    fn checked(&self, gpu: &Gpu, buffer: &Buffer, range: Range<u64>) -> Result<Vec<u32>, GpuError> {
        let mut words = gpu.read_all(&[(buffer, range), (&self.overflow, 0..4)])?;
        match words.pop() {
            Some(0) => Ok(words),
            Some(_) => Err(Overflow.into()),
            None => Err(Lost.into()),
        }
    }

    /// The picture: of each pixel red, green, blue and coverage.
    pub fn picture(&self) -> &Buffer {
        &self.picture
    }

    /// Reads pixel rows of the picture back: red, green, blue (linear), coverage.
    ///
    /// # Errors
    /// The card is lost, or an integer has overflowed.
    pub fn read(&self, gpu: &Gpu, rows: Range<u32>) -> Result<Vec<[f32; 4]>, GpuError> {
        let row = 16 * self.size[0] as u64;
        let words = self.checked(gpu, &self.picture, rows.start as u64 * row..rows.end as u64 * row)?;
        Ok(words.chunks_exact(4).map(|p| [p[0], p[1], p[2], p[3]].map(f32::from_bits)).collect())
    }
}

impl Quanta {
    /// Of ordinary and of bright sums.
    fn from_nodes(nodes: &Nodes) -> (Self, Self) {
        let dim = Self::new(nodes.scale.dim_bits, 32, nodes.brightest.min(BRIGHT as f64));
        (dim, Self::new(nodes.scale.bright_bits, 64, nodes.brightest))
    }
}

/// A level as resolve.wgsl reads it, the `k`-th.
fn line_level(k: usize, level: &Level, coarser: Option<&Level>) -> LineLevel {
    LineLevel {
        width: level.width as i32,
        height: level.height as i32,
        pixels: level.pixels,
        totals: level.totals,
        lines: level.lines,
        coarse_lines: coarser.map_or(0, |coarser| coarser.lines),
        coarse_width: coarser.map_or(0, |coarser| coarser.width as i32),
        coarse_height: coarser.map_or(0, |coarser| coarser.height as i32),
        level: k as u32,
    }
}
