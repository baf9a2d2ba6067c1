//! What nodes are drawn with, in the card's memory: the pen, the aperture's rows, its stencils.

use crate::aperture::stencil::{Place, Stencils};
use crate::draw::Pen;
use crate::gpu::layout::Layout;
use crate::gpu::shader_structs::{self, SumLevel};
use crate::nodes::Scale;
use bytemuck::Zeroable;
use graphics_card::{Gpu, Lost};
use wgpu::{Buffer, BufferUsages};

/// Words of a table's beginning: where each stencil's runs lie.
const TABLE_WORDS: usize = 2 * Stencils::PLACES * Stencils::PHASES;

/// Words that a table of stencils is made larger by.
const GROWTH: usize = 1 << 18;

/// The aperture's rows and stencils of one shape.
pub struct Shapes {
    /// The rows of the aperture.
    pub shape: Buffer,
    /// The stencils that have been uploaded.
    pub stencils: Buffer,
    /// What `stencils` holds: for each place where its runs begin and how many, then the runs.
    words: Vec<u32>,
    is_uploaded: Vec<bool>,
    /// Words that have been written.
    written: usize,
    capacity: usize,
}

impl Shapes {
    /// Uploads the rows of the stencils' shape; stencils follow when they are needed.
    ///
    /// # Errors
    /// The card is lost.
    pub fn new(gpu: &Gpu, stencils: &Stencils) -> Result<Self, Lost> {
        let shape = &stencils.shape;
        let mut words = shape.firsts.clone();
        words.extend(shape.runs.iter().flat_map(|run| [run.start as u32, run.end as u32, run.transmission]));
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_DST;
        let of_shape = gpu.buffer("shape", words.len(), usage)?;
        gpu.write(&of_shape, &words);
        let capacity = TABLE_WORDS + GROWTH;
        Ok(Self {
            shape: of_shape,
            stencils: gpu.buffer("stencils", capacity, usage)?,
            is_uploaded: vec![false; Stencils::PLACES],
            words: vec![0; TABLE_WORDS],
            written: 0,
            capacity,
        })
    }

    /// Uploads the stencils of these places that are not there yet.
    ///
    /// # Errors
    /// The card is lost.
    pub fn upload(&mut self, gpu: &Gpu, stencils: &Stencils, places: &[Place]) -> Result<(), Lost> {
        let before = self.words.len();
        for &place in places {
            if std::mem::replace(&mut self.is_uploaded[place.index], true) {
                continue;
            }
            for (phase, stencil) in stencils.at_place(place).iter().enumerate() {
                let entry = 2 * (place.index * Stencils::PHASES + phase);
                self.words[entry] = self.words.len() as u32;
                self.words[entry + 1] =
                    stencil.runs.len() as u32 | (stencil.height_bits | place.half_step() << 6) << 16;
                for run in &stencil.runs {
                    let row_and_v = (run.v as u32 & 0xFFFF) | (run.row as u32) << 16;
                    self.words.extend([run.start as u32, run.end as u32, run.height, row_and_v]);
                }
            }
        }
        if self.words.len() == before && self.written > 0 {
            return Ok(());
        }
        if self.words.len() > self.capacity {
            self.capacity = self.words.len() + self.words.len() / 2;
            let usage = BufferUsages::STORAGE | BufferUsages::COPY_DST;
            self.stencils = gpu.buffer("stencils", self.capacity, usage)?;
            self.written = 0;
        }
        // The table, and what is new behind it.
        gpu.write(&self.stencils, &self.words[..TABLE_WORDS]);
        gpu.write_at(&self.stencils, self.written.max(TABLE_WORDS), &self.words);
        self.written = self.words.len();
        Ok(())
    }

    /// A buffer that holds a pen.
    ///
    /// # Errors
    /// The card is lost.
    pub fn pen_buffer(gpu: &Gpu) -> Result<Buffer, Lost> {
        gpu.struct_buffer::<shader_structs::Pen>("pen", BufferUsages::STORAGE)
    }

    /// Uploads a pen, for accumulators of this layout, and for light that was uploaded at `dim_bits`.
    pub fn upload_pen(gpu: &Gpu, buffer: &Buffer, pen: &Pen, layout: &Layout, dim_bits: i32) {
        let Scale { dim_bits: now, bright_bits } = pen.nodes.scale;
        let rows = pen.stencils.shape.firsts.len() as u32;
        let mut uploaded = shader_structs::Pen {
            middle: pen.nodes.middle,
            stop: pen.stop,
            per_stop: pen.per_stop,
            half: pen.half,
            tilt_shift: pen.tilt_shift,
            mean: pen.mean,
            stencil_radius: pen.stencil_radius,
            per_stencil_radius: pen.per_stencil_radius,
            shape_rows: rows - 1,
            shape_runs: rows,
            dim_exponent: now - dim_bits,
            coverage_exponent: now - bright_bits,
            part_count: pen.parts.len() as u32,
            even_partial_tilt: pen.even_partial_tilt,
            all_rows_radius: pen.all_rows_radius,
            is_exact: pen.is_exact.into(),
            ..shader_structs::Pen::zeroed()
        };
        for (to, level) in uploaded.levels.iter_mut().zip(&layout.levels) {
            let (width, height) = (level.width as i32, level.height as i32);
            *to = SumLevel { width, height, pixels: level.pixels, totals: level.totals };
        }
        for (to, part) in uploaded.parts.iter_mut().zip(&pen.parts) {
            let (share, mean, variance, half) = (part.share, part.mean, part.variance, part.half);
            *to = shader_structs::BoxPart { share, padding: 0, mean, variance, half };
        }
        gpu.write_struct(buffer, &uploaded);
    }
}
