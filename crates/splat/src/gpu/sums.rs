//! The sums on the card: accumulators, and what is drawn onto them.

use crate::draw::Pen;
use crate::draw_list::{BlockChanges, Changes, Scene};
use crate::gpu::error::GpuError;
use crate::gpu::formats::{KIND_LARGE, LANES, RECORD_WORDS, THREADS};
use crate::gpu::layout::Layout;
use crate::gpu::listing::{Listed, Listing};
use crate::gpu::pace::{Batch, Pace};
use crate::gpu::passes::Passes;
use crate::gpu::records::{Records, complete_large};
use crate::gpu::resolve::Resolve;
use crate::gpu::scene::Scene as Uploaded;
use crate::gpu::shader_structs;
use crate::gpu::shapes::Shapes;
use crate::nodes::Nodes;
use crate::resolve::balance::{Gains, NO_REST};
use crate::resolve::knots::{Knots, SharedSums};
use graphics_card::{Commands, Gpu, Lost, Stopwatch};
use lens::Picture;
use progress::Progress;
use salf::tree::LEVELS;
use std::ops::Range;
use wgpu::{BindGroup, Buffer, BufferUsages};

/// Words of the room for records that are listed elsewhere.
const ROOM: usize = 1 << 18;

/// Fewer records than that are drawn by [`LANES`] threads each.
const FEW: usize = if cfg!(test) { 1 << 6 } else { 1 << 14 };

/// The number of workgroups that every card takes.
const MAX_GROUPS: usize = 65_535;

/// Accumulators of one kind of samples' integers.
struct Accumulators {
    layout: Layout,
    /// Of free samples, then of sharing ones.
    sums: [Buffer; 2],
}

/// The sums of a picture on a card.
pub struct GpuSums {
    gpu: Gpu,
    scene: Uploaded,
    shapes: Option<Shapes>,
    /// Ordinary ones, then wide ones if any sample is bright.
    accumulators: Vec<Accumulators>,
    pens: Vec<Buffer>,
    listing: Listing,
    /// Whether what is painted has been uploaded.
    is_paint_there: bool,
    /// Room for what is listed elsewhere.
    records: Buffer,
    batch: Buffer,
    pace: Pace,
    resolve: Resolve,
    /// The rows that lines are integrated of, of the sums as they are.
    integrated: Range<u32>,
    stopwatch: Option<Stopwatch>,
}

impl GpuSums {
    /// Uploads nodes and makes room for a picture of them, of `size` columns and rows.
    ///
    /// # Errors
    /// The card is lost.
    pub fn new(gpu: &Gpu, nodes: &Nodes, size: [usize; 2]) -> Result<Self, Lost> {
        Self::with_scene(gpu, Uploaded::new(gpu, nodes)?, nodes.has_bright, size)
    }

    /// Another picture of the same nodes, which are uploaded already.
    ///
    /// # Errors
    /// The card is lost.
    pub fn twin(&self) -> Result<Self, Lost> {
        let has_bright = self.accumulators.len() > 1;
        Self::with_scene(&self.gpu, self.scene.twin(&self.gpu)?, has_bright, self.resolve.size)
    }

    fn with_scene(gpu: &Gpu, scene: Uploaded, has_bright: bool, size: [usize; 2]) -> Result<Self, Lost> {
        gpu.check()?;
        let storage = BufferUsages::STORAGE | BufferUsages::COPY_DST | BufferUsages::COPY_SRC;
        let accumulators = |levels, words_of_pixel| {
            let layout = Layout::new(size, levels, words_of_pixel);
            let buffer = || gpu.buffer("sums", layout.words, storage);
            Ok::<_, Lost>(Accumulators { sums: [buffer()?, buffer()?], layout })
        };
        let mut all = vec![accumulators(LEVELS, 4)?];
        if has_bright {
            all.push(accumulators(1, 8)?);
        }
        let pens: Result<Vec<_>, Lost> = all.iter().map(|_| Shapes::pen_buffer(gpu)).collect();
        Ok(Self {
            listing: Listing::new(gpu, &scene)?,
            is_paint_there: false,
            stopwatch: Stopwatch::new(gpu)?,
            scene,
            shapes: None,
            resolve: Resolve::new(gpu, size, &all[0].layout)?,
            accumulators: all,
            pens: pens?,
            records: gpu.buffer("records", ROOM, BufferUsages::STORAGE | BufferUsages::COPY_DST)?,
            batch: gpu.struct_buffer::<shader_structs::Batch>("batch", BufferUsages::UNIFORM)?,
            pace: Pace::new(),
            integrated: 0..0,
            gpu: gpu.clone(),
        })
    }

    /// The memory on the card, in bytes: of the nodes, then of the sums.
    pub fn bytes(&self) -> [usize; 2] {
        let sums = self.accumulators.iter().flat_map(|accumulators| &accumulators.sums);
        let stencils = self.shapes.iter().map(|shapes| &shapes.stencils);
        let own = sums.chain(stencils).chain([self.listing.records()]).map(|buffer| buffer.size() as usize);
        let [shared, of_scene] = self.scene.bytes();
        [shared, of_scene + own.sum::<usize>() + self.resolve.bytes()]
    }

    /// Forgets the aperture: the next picture is of another.
    pub fn forget_aperture(&mut self) {
        self.shapes = None;
    }

    /// The next picture is painted otherwise.
    pub fn forget_paint(&mut self) {
        self.is_paint_there = false;
    }

    /// Sets the sums to what a scene sends.
    ///
    /// # Errors
    /// The work was cancelled, the card is lost, or an integer has overflowed.
    pub fn set(&mut self, scene: &Scene, progress: &dyn Progress) -> Result<(), GpuError> {
        self.integrated = 0..0;
        self.pace.clear();
        let mut work = Commands::new(&self.gpu);
        self.accumulators
            .iter()
            .flat_map(|accumulators| &accumulators.sums)
            .for_each(|sums| work.clear(sums));
        work.submit();
        self.set_aperture(&scene.pen)?;
        let is_painted = !scene.paint.is_standard();
        if is_painted && !self.is_paint_there {
            self.scene.upload_paint(&self.gpu, scene.pen.nodes, scene.paint)?;
            self.is_paint_there = true;
        }
        let counts = self.listing.count(&self.gpu, &self.scene, scene, &self.pens[0], is_painted)?;
        self.shapes.as_mut().ok_or(Lost)?.upload(&self.gpu, scene.pen.stencils, &counts.places)?;
        let count = self.scene.chunks.len();
        for chunk in 0..count {
            progress.check()?;
            let listed =
                self.listing.list(&self.gpu, &self.scene, chunk, &counts, &self.pens[0], is_painted)?;
            self.draw_listed(&scene.pen, chunk, listed, progress)?;
            progress.report((chunk + 1) as f32 / count as f32);
        }
        Ok(())
    }

    /// Draws what the card listed of a chunk.
    fn draw_listed(
        &mut self,
        pen: &Pen,
        chunk: usize,
        listed: Listed,
        progress: &dyn Progress,
    ) -> Result<(), GpuError> {
        for (width, kinds) in listed.into_iter().enumerate().take(self.accumulators.len()) {
            let bound = self.bind_group(chunk, width, self.listing.records())?;
            let [boxes, images, partial, large] = kinds;
            for (kind, records) in [boxes, images, partial].into_iter().enumerate() {
                let mut first = records.start;
                while first < records.end {
                    progress.check()?;
                    let count = self.pace.size(width, kind).min((records.end - first) as usize);
                    first += self.draw_batch(&bound, Batch { width, kind, count }, first)?;
                }
            }
            if !large.is_empty() {
                let bytes = [large.start, large.end].map(|at| 4 * (RECORD_WORDS as u64) * u64::from(at));
                let listed = self.gpu.read(self.listing.records(), bytes[0]..bytes[1])?;
                for listed in listed.chunks(ROOM / words_of(KIND_LARGE) * RECORD_WORDS) {
                    progress.check()?;
                    let words = complete_large(pen, self.scene.chunks[chunk].shared.first, listed);
                    self.draw_words([chunk, width, KIND_LARGE], &words, progress)?;
                }
            }
        }
        Ok(())
    }

    /// Takes nodes away and adds others.
    ///
    /// # Errors
    /// The card is lost, or an integer has overflowed.
    pub fn change(&mut self, pen: &Pen, changes: &Changes) -> Result<(), GpuError> {
        self.integrated = 0..0;
        self.pace.clear();
        self.set_aperture(pen)?;
        for chunk in 0..self.scene.chunks.len() {
            let first = self.scene.chunks[chunk].shared.first;
            let end = self.scene.chunks.get(chunk + 1).map_or(u32::MAX, |next| next.shared.first);
            let mut records = Records::default();
            let of_chunk =
                |block: &&BlockChanges| block.first().is_some_and(|node| (first..end).contains(&node));
            for block in changes.0.iter().filter(of_chunk) {
                for (changed, sign) in [(&block.removed, -1), (&block.added, 1)] {
                    for drawn in changed {
                        let node = &pen.nodes.nodes[drawn.index as usize];
                        records.push(pen, drawn.index, first, node, drawn.placed, sign);
                    }
                }
            }
            self.draw(pen, chunk, &records, &progress::Unwatched)?;
        }
        Ok(())
    }

    /// Uploads the pen, and the aperture's shape and stencils if it has changed.
    fn set_aperture(&mut self, pen: &Pen) -> Result<(), Lost> {
        self.gpu.check()?;
        if self.shapes.is_none() {
            self.shapes = Some(Shapes::new(&self.gpu, pen.stencils)?);
            self.scene.upload_moments(&self.gpu, pen.nodes, pen.moments);
        }
        for (buffer, accumulators) in self.pens.iter().zip(&self.accumulators) {
            Shapes::upload_pen(&self.gpu, buffer, pen, &accumulators.layout, self.scene.dim_bits);
        }
        Ok(())
    }

    fn draw(
        &mut self,
        pen: &Pen,
        chunk: usize,
        records: &Records,
        progress: &dyn Progress,
    ) -> Result<(), GpuError> {
        let shapes = self.shapes.as_mut().ok_or(Lost)?;
        shapes.upload(&self.gpu, pen.stencils, &records.places)?;
        for width in 0..self.accumulators.len() {
            for (kind, words) in records.words[width].iter().enumerate() {
                self.draw_words([chunk, width, kind], words, progress)?;
            }
        }
        Ok(())
    }

    /// Draws records of a chunk, a width and a kind that are not on the card yet.
    fn draw_words(
        &mut self,
        [chunk, width, kind]: [usize; 3],
        mut words: &[u32],
        progress: &dyn Progress,
    ) -> Result<(), GpuError> {
        if words.is_empty() {
            return Ok(());
        }
        let bound = self.bind_group(chunk, width, &self.records)?;
        while !words.is_empty() {
            progress.check()?;
            let count = self.pace.size(width, kind).min(ROOM.min(words.len()) / words_of(kind));
            self.gpu.write(&self.records, &words[..count * words_of(kind)]);
            let drawn = self.draw_batch(&bound, Batch { width, kind, count }, 0)?;
            words = &words[drawn as usize * words_of(kind)..];
        }
        Ok(())
    }

    /// Draws records from `first` on. Returns how many: no more than a card takes at once.
    fn draw_batch(&mut self, bound: &BindGroup, batch: Batch, first: u32) -> Result<u32, Lost> {
        self.gpu.check()?;
        let Batch { width, kind, count } = batch;
        let is_few = kind == KIND_LARGE || count <= FEW;
        let lanes = if is_few { LANES as usize } else { 1 };
        let count = count.min(MAX_GROUPS * THREADS as usize / lanes);
        self.gpu.write_struct(&self.batch, &shader_structs::Batch { count: count as u32, first });
        let pass = &Passes::of(&self.gpu).draw[width][kind][usize::from(is_few)];
        let mut work = Commands::new(&self.gpu);
        work.dispatch(pass, bound, [(count * lanes).div_ceil(THREADS as usize) as u32, 1]);
        let submission = work.submit();
        // Frees what was staged for batches that are through.
        self.gpu.device().poll(wgpu::PollType::Poll).map_err(|_| Lost)?;
        self.pace.add(&self.gpu, Batch { count, ..batch }, submission)?;
        Ok(count as u32)
    }

    fn bind_group(&self, chunk: usize, width: usize, records: &Buffer) -> Result<BindGroup, Lost> {
        let (chunk, shapes) = (&self.scene.chunks[chunk], self.shapes.as_ref().ok_or(Lost)?);
        let sums = &self.accumulators[width].sums;
        let buffers = [
            &chunk.shared.nodes,
            &chunk.cells,
            &self.pens[width],
            &shapes.shape,
            &shapes.stencils,
            records,
            &sums[0],
            &sums[1],
            &self.batch,
        ];
        Ok(self.gpu.bind(&Passes::of(&self.gpu).draw_layout, (0..).zip(buffers)))
    }

    /// Finds the shares of a standard picture whose sums these are, and the gains.
    ///
    /// # Errors
    /// The card is lost, or an integer has overflowed.
    pub fn find_shares(&mut self, nodes: &Nodes) -> Result<Gains, GpuError> {
        let rows = 0..self.resolve.size[1] as u32;
        self.resolve.begin(&self.gpu, nodes, rows.clone(), true, false);
        self.integrate_lines(&rows)?;
        self.resolve.finish(&self.gpu, &rows);
        Ok(Gains::from_sums(Knots::new(self.resolve.size), &self.resolve.knot_sums(&self.gpu)?))
    }

    /// Integrates pixel rows for a picture of them, unless they are integrated already.
    ///
    /// # Errors
    /// The card is lost, or an integer has overflowed.
    pub fn integrate(&mut self, nodes: &Nodes, rows: &Range<u32>, is_evened: bool) -> Result<(), GpuError> {
        self.resolve.begin(&self.gpu, nodes, rows.clone(), false, is_evened);
        let is_there = self.integrated.start <= rows.start && rows.end <= self.integrated.end;
        if is_there { Ok(()) } else { Ok(self.integrate_lines(rows)?) }
    }

    /// The sums of what shares in each cell of a picture, once all rows are integrated.
    ///
    /// # Errors
    /// The card is lost, or an integer has overflowed.
    pub fn shared_sums(&self, gains: &Gains) -> Result<Vec<SharedSums>, GpuError> {
        self.resolve.set_gains(&self.gpu, gains, NO_REST);
        self.resolve.shared_sums(&self.gpu)
    }

    /// Makes pixel rows of a picture from what was integrated last, and submits that.
    pub fn make_picture(&self, gains: &Gains, rest: [f32; 3], rows: &Range<u32>) {
        self.resolve.set_gains(&self.gpu, gains, rest);
        self.resolve.finish(&self.gpu, rows);
        if let Some(stopwatch) = &self.stopwatch {
            stopwatch.end(&self.gpu);
        }
    }

    /// The picture on the card: of each pixel red, green, blue and coverage.
    pub fn picture(&self) -> &Buffer {
        self.resolve.picture()
    }

    /// Waits until the picture is made.
    ///
    /// # Errors
    /// The card is lost, or an integer has overflowed.
    pub fn finish(&self) -> Result<(), GpuError> {
        self.resolve.check(&self.gpu)
    }

    /// Copies pixel rows of the picture from the card to `picture`.
    ///
    /// # Errors
    /// The card is lost, or an integer has overflowed.
    pub fn read_picture(&self, rows: Range<u32>, picture: &mut Picture) -> Result<(), GpuError> {
        let first = rows.start as usize * self.resolve.size[0];
        let pixels = self.resolve.read(&self.gpu, rows)?;
        let out = picture.radiance[first..].iter_mut().zip(&mut picture.coverage[first..]);
        for (&[r, g, b, covered], (radiance, coverage)) in pixels.iter().zip(out) {
            *radiance = [r, g, b];
            *coverage = covered;
        }
        Ok(())
    }

    /// The seconds by the card's own clock from the beginning of the last sum, or change, to the end of its picture; none
    /// where it has no clock.
    pub fn seconds(&self) -> Option<f64> {
        self.stopwatch.as_ref()?.seconds(&self.gpu).ok()
    }

    /// Work on another picture begins.
    pub fn begin(&self) {
        if let Some(stopwatch) = &self.stopwatch {
            stopwatch.begin(&self.gpu);
        }
    }

    fn integrate_lines(&mut self, rows: &Range<u32>) -> Result<(), Lost> {
        self.gpu.check()?;
        self.integrated = rows.clone();
        let mut work = Commands::new(&self.gpu);
        for kind in 0..2 {
            let work = &mut work;
            self.resolve.integrate(&self.gpu, work, kind, &self.accumulators[0].sums[kind], rows);
            if let Some(wide) = self.accumulators.get(1) {
                self.resolve.integrate_wide(&self.gpu, work, kind, &wide.sums[kind], &wide.layout, rows)?;
            }
        }
        work.submit();
        Ok(())
    }

    /// The sums as the processor keeps them: pixels and totals of every level, of free and of sharing samples.
    ///
    /// # Errors
    /// The card is lost.
    #[cfg(test)]
    pub fn accumulated(&self, width: usize) -> Result<[crate::gpu::tests::Accumulated; 2], Lost> {
        let accumulators = &self.accumulators[width];
        let of = |buffer: &Buffer| {
            let words = self.gpu.read(buffer, 0..4 * accumulators.layout.words as u64)?;
            Ok::<_, Lost>(crate::gpu::tests::accumulated(&words, &accumulators.layout, width == 1))
        };
        Ok([of(&accumulators.sums[0])?, of(&accumulators.sums[1])?])
    }
}

/// Words of a record of a kind.
fn words_of(kind: usize) -> usize {
    if kind == KIND_LARGE { 2 * RECORD_WORDS } else { RECORD_WORDS }
}
