//! The list of what is drawn, made on the card.

use crate::aperture::stencil::{COARSER, Place, Stencils};
use crate::draw_list::Scene as DrawnScene;
use crate::gpu::formats::{COUNTS, KINDS, RECORD_WORDS, THREADS};
use crate::gpu::passes::Passes;
use crate::gpu::scene::{Chunk, Scene};
use crate::gpu::shader_structs;
use graphics_card::{Commands, Gpu, Lost};
use std::ops::Range;
use wgpu::{BindGroup, Buffer, BufferUsages};

/// Of how many words the bits of all places of stencils are.
const PLACE_WORDS: usize = Stencils::PLACES.div_ceil(u32::BITS as usize);

/// What finds on the card which nodes are drawn.
pub struct Listing {
    lens: Buffer,
    /// How many records of each kind each chunk has, and how many have been written; then a bit for each place of stencils
    /// of requested stencils.
    counts: Buffer,
    /// The uniforms of each chunk, for counting and for writing.
    chunks: Vec<[Buffer; 2]>,
    /// Stands for what is painted where nothing is.
    unpainted: Buffer,
    /// What is listed of a chunk.
    records: Buffer,
}

/// How many records of each kind a scene has.
pub struct Counts {
    of_chunks: Vec<[u32; COUNTS]>,
    /// The stencils that the records use.
    pub places: Vec<Place>,
}

/// The records of each kind, by index: for ordinary accumulators, then for wide ones.
pub type Listed = [[Range<u32>; KINDS]; 2];

impl Listing {
    /// Makes the buffers with which the nodes of `scene` are listed.
    ///
    /// # Errors
    /// The card is lost.
    pub fn new(gpu: &Gpu, scene: &Scene) -> Result<Self, Lost> {
        let storage = BufferUsages::STORAGE | BufferUsages::COPY_DST | BufferUsages::COPY_SRC;
        let of_chunk = |_| {
            let buffer = || gpu.struct_buffer::<shader_structs::Chunk>("chunk", BufferUsages::UNIFORM);
            Ok([buffer()?, buffer()?])
        };
        Ok(Self {
            lens: gpu.struct_buffer::<shader_structs::Lens>("lens", BufferUsages::STORAGE)?,
            counts: gpu.buffer("found", 2 * COUNTS * scene.chunks.len() + PLACE_WORDS, storage)?,
            chunks: scene.chunks.iter().map(of_chunk).collect::<Result<_, Lost>>()?,
            unpainted: gpu.buffer("unpainted", 0, storage)?,
            records: gpu.buffer("listed", 0, storage)?,
        })
    }

    /// The buffer that holds the listed records.
    pub fn records(&self) -> &Buffer {
        &self.records
    }

    /// Counts what is drawn of all chunks; `is_painted`: with the paint, otherwise with the standard focus.
    ///
    /// # Errors
    /// The card is lost.
    pub fn count(
        &self,
        gpu: &Gpu,
        scene: &Scene,
        drawn: &DrawnScene,
        pen: &Buffer,
        is_painted: bool,
    ) -> Result<Counts, Lost> {
        gpu.write_struct(&self.lens, &shader_lens(drawn));
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

    /// Lists what is drawn of the chunk with this number, as it was counted.
    ///
    /// # Errors
    /// The card is lost.
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
        let words = RECORD_WORDS * end as usize;
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
        let first = std::array::from_fn(|kind| firsts.map_or(0, |firsts| firsts[kind].start));
        let of_chunk = shader_structs::Chunk {
            node_count: chunk.shared.count,
            is_painted: focus.is_some().into(),
            counts: counts as u32,
            places: (2 * COUNTS * self.chunks.len()) as u32,
            first,
        };
        let uniform = &self.chunks[index][usize::from(is_writing)];
        gpu.write_struct(uniform, &of_chunk);
        let bound = self.bind_group(gpu, chunk, pen, focus, uniform);
        let pass = &Passes::of(gpu).list[usize::from(is_writing)];
        let mut work = Commands::new(gpu);
        work.dispatch(pass, &bound, [chunk.shared.count.div_ceil(THREADS), 1]);
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
        gpu.bind(&Passes::of(gpu).list_layout, (0..).zip(buffers))
    }
}

/// A lens as draw_list.wgsl reads it.
fn shader_lens(DrawnScene { pen, lens, size, .. }: &DrawnScene) -> shader_structs::Lens {
    shader_structs::Lens {
        radius_at_infinity: lens.radius_at_infinity,
        radius_per_kappa: lens.radius_per_kappa,
        radius_per_offset: lens.radius_per_offset,
        zero: 0,
        size: size.map(|side| side as i32),
        box_radius: pen.box_radius,
        one_box_radius: pen.one_box_radius,
        even_tilt: pen.even_tilt,
        per_variance: pen.per_variance as u32,
        half_places: (Stencils::PLACES / 2) as u32,
        coarser: COARSER.map(|place| place as u32),
        padding: 0,
        too_blurred: pen.too_blurred.map(|square| [square as u32, (square >> 32) as u32]),
        smallest_radius: lens.smallest_radius,
        smallest_joint_radius: lens.smallest_joint_radius,
    }
}
