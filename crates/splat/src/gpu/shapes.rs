//! What nodes are drawn with, in the card's memory: the pen, the aperture's rows, its stencils.

use crate::aperture::stencil::{Place, Stencils};
use crate::draw::Pen;
use crate::gpu::Gpu;
use crate::gpu::device::Lost;
use crate::gpu::layout::Layout;
use crate::nodes::Scale;
use wgpu::{Buffer, BufferUsages};

/// Words of a table's beginning: where each stencil's runs lie.
const TABLE_WORDS: usize = 2 * Stencils::PLACES * Stencils::PHASES;

/// Words that a table of stencils is made larger by.
const GROWTH: usize = 1 << 18;

/// The aperture's rows and stencils of one shape.
pub struct Shapes {
    pub shape: Buffer,
    pub stencils: Buffer,
    /// What `stencils` holds: for each place where its runs begin and how many, then the runs.
    words: Vec<u32>,
    is_uploaded: Vec<bool>,
    /// Words that have been written.
    written: usize,
    capacity: usize,
}

impl Shapes {
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

    /// Room for a pen.
    pub fn pen_buffer(gpu: &Gpu) -> Result<Buffer, Lost> {
        gpu.buffer("pen", PEN_WORDS, BufferUsages::STORAGE | BufferUsages::COPY_DST)
    }

    /// Uploads a pen, for accumulators laid out so, and light that was uploaded at `dim_bits`.
    pub fn upload_pen(gpu: &Gpu, buffer: &Buffer, pen: &Pen, layout: &Layout, dim_bits: i32) {
        let Scale { dim_bits: now, bright_bits } = pen.nodes.scale;
        let signed = |x: [i32; 2]| x.map(|x| x as u32);
        let mut words = Vec::with_capacity(PEN_WORDS);
        words.extend(signed(pen.nodes.middle));
        words.extend([pen.stop as u32, pen.per_stop]);
        words.extend(pen.half);
        words.extend(signed(pen.tilt_shift));
        words.extend(signed(pen.mean));
        words.extend([pen.stencil_radius, pen.per_stencil_radius]);
        let rows = pen.stencils.shape.firsts.len() as u32;
        words.extend([rows - 1, rows]);
        words.extend([(now - dim_bits) as u32, (now - bright_bits) as u32, pen.parts.len() as u32]);
        words.extend([pen.even_partial_tilt as u32, pen.all_rows_radius, u32::from(pen.is_exact)]);
        for level in &layout.levels {
            words.extend([level.width as u32, level.height as u32, level.pixels, level.totals]);
        }
        words.resize(FIRST_LEVEL + 4 * salf::tree::LEVELS, 0);
        // Parts begin at a multiple of eight bytes.
        words.resize(words.len().next_multiple_of(2), 0);
        for part in &pen.parts {
            words.extend([part.share, 0]);
            words.extend(signed(part.mean));
            words.extend(signed(part.variance));
            words.extend(part.half);
        }
        words.resize(PEN_WORDS, 0);
        gpu.write(buffer, &words);
    }
}

/// Words of `Pen` in pen.wgsl before its levels, and in all.
const FIRST_LEVEL: usize = 20;
const PEN_WORDS: usize = FIRST_LEVEL + 4 * salf::tree::LEVELS + 8 * 16;
