//! The list of what is drawn, made on the card.

use crate::aperture::stencil::{COARSER, Place, Stencils};
use crate::draw_list::Scene as Drawn;
use crate::gpu::Gpu;
use crate::gpu::device::Lost;
use crate::gpu::device::commands::Commands;
use crate::gpu::passes::KINDS;
use crate::gpu::records;
use crate::gpu::scene::{Chunk, Scene};
use salf::tree::LEVELS;
use std::ops::Range;
use wgpu::{BindGroup, Buffer, BufferUsages};

/// Kinds of records, of ordinary accumulators and of wide ones.
const COUNTS: usize = 2 * KINDS;

/// Words of `Lens` in list.wgsl before its thresholds, and of `Chunk`.
const LENS_WORDS: usize = 14 + 2 * LEVELS;
const CHUNK_WORDS: usize = 4 + COUNTS;

/// Of how many words the bits of all places of stencils are.
const PLACE_WORDS: usize = Stencils::PLACES.div_ceil(u32::BITS as usize);

/// What finds on the card which nodes are drawn.
pub struct Listing {
    lens: Buffer,
    /// How many records of each kind each chunk has, and how many have been written; then a bit for each place of stencils
    /// that is asked for.
    counts: Buffer,
    /// What list.wgsl is told of each chunk, when it counts and when it writes.
    chunks: Vec<[Buffer; 2]>,
    /// Stands for what is painted where nothing is.
    unpainted: Buffer,
    /// What is listed of a chunk.
    records: Buffer,
}

/// How many records of each kind a scene has.
pub struct Counts {
    of_chunks: Vec<[u32; COUNTS]>,
    /// Stencils that they ask for.
    pub places: Vec<Place>,
}

/// Where the records of each kind stand: of ordinary accumulators, then of wide ones.
pub type Listed = [[Range<u32>; KINDS]; 2];

impl Listing {
    pub fn new(gpu: &Gpu, scene: &Scene) -> Result<Self, Lost> {
        let storage = BufferUsages::STORAGE | BufferUsages::COPY_DST | BufferUsages::COPY_SRC;
        let uniform = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        let of_chunk = |_| {
            let buffer = || gpu.buffer("chunk", CHUNK_WORDS, uniform);
            Ok([buffer()?, buffer()?])
        };
        Ok(Self {
            lens: gpu.buffer("lens", LENS_WORDS + 10 * 4 * LEVELS, storage)?,
            counts: gpu.buffer("found", 2 * COUNTS * scene.chunks.len() + PLACE_WORDS, storage)?,
            chunks: scene.chunks.iter().map(of_chunk).collect::<Result<_, Lost>>()?,
            unpainted: gpu.buffer("unpainted", 0, storage)?,
            records: gpu.buffer("listed", 0, storage)?,
        })
    }

    /// Where listed records are.
    pub fn records(&self) -> &Buffer {
        &self.records
    }

    /// Counts what is drawn of all chunks; `is_painted`: as it is painted.
    pub fn count(
        &self,
        gpu: &Gpu,
        scene: &Scene,
        drawn: &Drawn,
        pen: &Buffer,
        is_painted: bool,
    ) -> Result<Counts, Lost> {
        gpu.write(&self.lens, &words_of_lens(drawn));
        let words = 2 * COUNTS * scene.chunks.len() + PLACE_WORDS;
        gpu.write(&self.counts, &vec![0; words]);
        for (k, chunk) in scene.chunks.iter().enumerate() {
            self.dispatch(gpu, (k, chunk), pen, is_painted, None);
        }
        let readback = gpu.read(&self.counts, 0..4 * words as u64)?;
        let (counts, places) = readback.split_at(words - PLACE_WORDS);
        let is_requested = |index: &usize| places[index / 32] >> (index % 32) & 1 == 1;
        let of_chunk = |counts: &[u32; 2 * COUNTS]| std::array::from_fn(|kind| counts[kind]);
        Ok(Counts {
            of_chunks: counts.as_chunks().0.iter().map(of_chunk).collect(),
            places: (0..Stencils::PLACES).filter(is_requested).map(Place::from_table_index).collect(),
        })
    }

    /// Lists what is drawn of a chunk.
    pub fn list(
        &mut self,
        gpu: &Gpu,
        scene: &Scene,
        chunk: usize,
        counts: &Counts,
        pen: &Buffer,
        is_painted: bool,
    ) -> Result<Listed, Lost> {
        let mut end = 0u32;
        let firsts = counts.of_chunks[chunk].map(|count| {
            let first = end;
            end = end.saturating_add(count);
            first..end
        });
        let words = records::WORDS * end as usize;
        if 4 * words as u64 > self.records.size() {
            // With some room, that it need not grow with every lens.
            let roomy = (words + words / 4).min((gpu.largest_binding() / 4) as usize);
            self.records = gpu.buffer("listed", roomy.max(words), self.records.usage())?;
        }
        self.dispatch(gpu, (chunk, &scene.chunks[chunk]), pen, is_painted, Some(&firsts));
        let [of_ordinary, of_wide] =
            [0, KINDS].map(|first| std::array::from_fn(|kind| firsts[first + kind].clone()));
        Ok([of_ordinary, of_wide])
    }

    /// Counts (`firsts` none) or writes the records of a chunk.
    fn dispatch(
        &self,
        gpu: &Gpu,
        (index, chunk): (usize, &Chunk),
        pen: &Buffer,
        is_painted: bool,
        firsts: Option<&[Range<u32>; COUNTS]>,
    ) {
        let focus = chunk.focus.as_ref().filter(|_| is_painted);
        let (is_writing, counts) = (firsts.is_some(), 2 * COUNTS * index);
        let counts = counts + if is_writing { COUNTS } else { 0 };
        let mut words = vec![chunk.shared.count, focus.is_some().into(), counts as u32];
        words.push((2 * COUNTS * self.chunks.len()) as u32);
        words.extend((0..COUNTS).map(|kind| firsts.map_or(0, |firsts| firsts[kind].start)));
        let uniform = &self.chunks[index][usize::from(is_writing)];
        gpu.write(uniform, &words);
        let bound = self.bind_group(gpu, chunk, pen, focus, uniform);
        let pass = &gpu.passes().list[usize::from(is_writing)];
        let mut work = Commands::new(gpu);
        work.dispatch(pass, &bound, [chunk.shared.count.div_ceil(64), 1]);
        work.submit();
    }

    fn bind_group(
        &self,
        gpu: &Gpu,
        chunk: &Chunk,
        pen: &Buffer,
        focus: Option<&Buffer>,
        uniform: &Buffer,
    ) -> BindGroup {
        let focus = focus.unwrap_or(&self.unpainted);
        let buffers = [&chunk.shared.nodes, focus, pen, &self.lens, &self.counts, &self.records, uniform];
        gpu.bind(&gpu.passes().list_layout, (0..).zip(buffers))
    }
}

/// A lens as list.wgsl reads it.
fn words_of_lens(Drawn { pen, lens, size, .. }: &Drawn) -> Vec<u32> {
    let mut words =
        [lens.radius_at_infinity, lens.radius_per_kappa, lens.radius_per_offset].map(f32::to_bits).to_vec();
    words.extend([0, size[0], size[1], pen.box_radius, pen.one_box_radius, pen.even_tilt as u32]);
    words.extend([pen.per_variance as u32, (Stencils::PLACES / 2) as u32]);
    words.extend(COARSER.map(|place| place as u32));
    // What follows begins at a multiple of eight bytes.
    words.push(0);
    words.extend(pen.too_blurred.iter().flat_map(|square| [*square as u32, (square >> 32) as u32]));
    debug_assert_eq!(words.len(), LENS_WORDS);
    words.extend(lens.smallest_radius.as_flattened());
    words.extend(lens.smallest_joint_radius.as_flattened().as_flattened());
    words
}
