//! All nodes of a light field, summed band by band of the picture.

use crate::bands::{Pace, Stopwatch, Work};
use crate::canvas::{Accumulator, Level, Word};
use crate::draw::{Paper, Pen};
use crate::draw_list::{AHEAD, BlockList, Changes, DrawnNode};
use crate::lens_in_use::Placed;
use crate::nodes::SplatNode;
use crate::resolve::marks::Marks;
use crate::resolve::{Columns, LevelRows, Light, Overflow, Quanta, Room, Window, add_row};
use numerics::{prefetch, with_widest_simd};
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use salf::tree::{BLOCK_PX, LEVELS};
use std::convert::Infallible;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A picture has no more bands of rows than one for so many: what lies at their edges is drawn twice.
const BAND_ROWS: u32 = 64;

/// How many nodes ahead visibility is prefetched: the node itself must be in the cache by then.
const CELLS_AHEAD: usize = 4;

/// How many blocks, a row or two of them, are changed before the next: what is added to one lies in memory that taking away from
/// it has brought near.
const BLOCKS_PER_CHANGE: usize = 128;

/// How many blocks are drawn from one report of progress to the next.
const BLOCKS_PER_REPORT: usize = 64;

/// One kind of samples: ordinary ones, and bright ones if there are any.
#[derive(Clone, PartialEq)]
pub struct Sum {
    /// The sums of ordinary samples.
    pub dim: Accumulator<i32>,
    /// The sums of bright samples, in wide integers.
    pub bright: Option<Accumulator<i64>>,
}

/// The sums of a picture.
#[derive(Clone, PartialEq)]
pub struct Sums {
    /// Open samples, and painted ones.
    pub free: Sum,
    /// Unpainted samples that see part of the aperture: they share what open ones leave (see [`crate::resolve::partition`]).
    pub sharing: Sum,
}

/// Marks of some rows of a sum: of ordinary samples, and of bright ones.
pub type SumMarks = (Marks<i32>, Marks<i64>);

/// Rows of a sum to draw on.
struct SumCanvas<'a> {
    /// Level by level.
    dim: Vec<Paper<'a, i32>>,
    bright: Option<Vec<Paper<'a, i64>>>,
}

impl Sum {
    fn new([width, height]: [usize; 2], has_bright: bool) -> Self {
        Self {
            dim: Accumulator::new(width, height, LEVELS),
            bright: has_bright.then(|| Accumulator::new(width, height, 1)),
        }
    }

    fn bands(&mut self, starts: &[u32]) -> Vec<SumCanvas<'_>> {
        let mut bright = self.bright.as_mut().map(|bright| papers(bright, starts));
        papers(&mut self.dim, starts)
            .map(|dim| SumCanvas { dim, bright: bright.as_mut().and_then(Iterator::next) })
            .collect()
    }

    /// Marks of some of its rows, while they hold nothing.
    fn marks(&self, rows: Range<i32>) -> SumMarks {
        let columns = self.dim.levels[0].columns();
        let bright = if self.bright.is_some() { rows.clone() } else { 0..0 };
        (Marks::empty(rows, columns), Marks::empty(bright, columns))
    }

    fn bytes(&self) -> usize {
        self.dim.bytes() + self.bright.as_ref().map_or(0, Accumulator::bytes)
    }

    /// The rows of its pixels in a window of the picture. `quanta` are those of ordinary samples, and of bright ones ([`crate::nodes::Scale::quanta`]).
    ///
    /// # Errors
    /// A sum has overflowed.
    pub fn rows<'a>(
        &'a self,
        quanta: [Quanta; 2],
        window: &Window,
        (dim_marks, bright_marks): &'a mut SumMarks,
        room: &mut Room,
    ) -> Result<SumRows<'a>, Overflow> {
        let [dim, bright] = quanta;
        let of_bright = |sum: &'a Accumulator<i64>| (&sum.levels[0], bright, bright_marks);
        Ok(SumRows {
            columns: Columns::marked(&window.columns),
            largest_bright: 0,
            dim: LevelRows::for_sum(&self.dim, dim, window, room)?,
            dim_marks,
            bright: self.bright.as_ref().map(of_bright),
        })
    }
}

/// The rows of a sum's pixels in some columns, each made when it is read.
pub struct SumRows<'a> {
    columns: Columns,
    largest_bright: i64,
    dim: LevelRows<'a, i32>,
    dim_marks: &'a mut Marks<i32>,
    bright: Option<(&'a Level<i64>, Quanta, &'a mut Marks<i64>)>,
}

impl SumRows<'_> {
    /// Sets `line` to the pixels of row `row`: linear RGB and coverage.
    ///
    /// # Errors
    /// A sum has overflowed.
    pub fn read(&mut self, row: i32, line: &mut [Light]) -> Result<(), Overflow> {
        self.dim.read(row, self.dim_marks.row(row), line)?;
        if let Some((level, quanta, marks)) = &mut self.bright {
            // Their coverage is among the ordinary ones'.
            let largest = add_row::<i64, 3>(level, row, &self.columns, *quanta, marks.row(row), line)?;
            self.largest_bright = self.largest_bright.max(largest);
        }
        Ok(())
    }

    /// The largest coverage of a pixel so far, in quanta: in the sum of ordinary samples, and in that of bright ones.
    pub fn largest(&self) -> [i64; 2] {
        [self.dim.largest, self.largest_bright]
    }

    /// Of coverage alone: it is all among the ordinary samples'. Colours are what they may.
    pub fn coverage_only(self) -> Self {
        Self { bright: None, ..self }
    }

    /// Gives the lists of pixels back to `room`.
    pub fn recycle(self, room: &mut Room) {
        self.dim.recycle(room);
    }
}

/// The bands of an accumulator that begin at these pixel rows, level by level.
fn papers<'a, W: Word>(
    accumulator: &'a mut Accumulator<W>,
    starts: &[u32],
) -> impl Iterator<Item = Vec<Paper<'a, W>>> {
    let bands = accumulator.bands(starts).into_iter();
    bands.map(|canvas| (0..).zip(canvas.levels).map(|(level, rows)| Paper::new(rows, level)).collect())
}

impl SumCanvas<'_> {
    fn clear(&mut self) {
        self.dim.iter_mut().for_each(|paper| paper.rows.clear());
        self.bright.iter_mut().flatten().for_each(|paper| paper.rows.clear());
    }

    /// Draws what waits.
    fn finish(&mut self, sign: i32) {
        self.dim.iter_mut().for_each(|paper| paper.finish(sign));
        self.bright.iter_mut().flatten().for_each(|paper| paper.finish(sign));
    }

    #[inline(always)]
    fn draw(&mut self, pen: &Pen, node: &SplatNode, placed: Placed, sign: i32) {
        // All coverage is summed alike, so that how bright a sample is leaves no trace in it.
        match &mut self.bright {
            Some(bright) if node.is_bright => {
                pen.draw(node, node.light, placed, bright, sign);
                pen.draw(node, pen.nodes.dim_coverage(node), placed, &mut self.dim, sign);
            }
            _ => pen.draw(node, node.light, placed, &mut self.dim, sign),
        }
    }
}

impl Sums {
    /// Empty sums for a picture of `size` columns and rows; `has_bright`: with room for samples that need wide
    /// integers.
    pub fn new(size: [usize; 2], has_bright: bool) -> Self {
        Self { free: Sum::new(size, has_bright), sharing: Sum::new(size, has_bright) }
    }

    /// The memory that they take, in bytes.
    pub fn bytes(&self) -> usize {
        self.free.bytes() + self.sharing.bytes()
    }

    /// Marks of some of their rows, free and sharing, while they hold nothing.
    pub fn marks(&self, rows: Range<i32>) -> [SumMarks; 2] {
        [self.free.marks(rows.clone()), self.sharing.marks(rows)]
    }

    /// Replaces the sums by the lists of all blocks. `pace` learns how long it takes.
    ///
    /// # Errors
    /// [`Cancelled`] if `progress` asks to stop.
    pub fn set(
        &mut self,
        pen: &Pen,
        lists: &[BlockList],
        pace: &mut Pace,
        progress: &dyn Progress,
    ) -> Result<(), Cancelled> {
        self.draw(pen, lists, |band| band.clear(), pace, progress)
    }

    /// Adds the lists of all blocks to the sums. `pace` learns how long it takes.
    ///
    /// # Errors
    /// [`Cancelled`] if `progress` asks to stop.
    pub fn add(
        &mut self,
        pen: &Pen,
        lists: &[BlockList],
        pace: &mut Pace,
        progress: &dyn Progress,
    ) -> Result<(), Cancelled> {
        self.draw(pen, lists, |_| (), pace, progress)
    }

    /// Makes room for bright samples, if there is none yet.
    pub fn ensure_bright(&mut self) {
        for sum in [&mut self.free, &mut self.sharing] {
            let level = &sum.dim.levels[0];
            let size = [level.width, level.height];
            sum.bright.get_or_insert_with(|| Accumulator::new(size[0], size[1], 1));
        }
    }

    /// Draws the lists of all blocks over what `prepare` leaves of each band.
    fn draw(
        &mut self,
        pen: &Pen,
        lists: &[BlockList],
        prepare: impl Fn(&mut Band) + Sync,
        pace: &mut Pace,
        progress: &dyn Progress,
    ) -> Result<(), Cancelled> {
        let height = self.height();
        let mut work = Work::empty(height);
        for list in lists {
            let Some(first) = list.drawn.first() else { continue };
            work.add(pen.nodes.row_of(first.index), list.cost);
        }
        let bands = self.bands(&work, pace, height);
        let reach = |band: &Band| lists.iter().filter(|list| overlap(&list.rows, &band.rows)).count();
        let (count, done) = (bands.iter().map(reach).sum::<usize>(), AtomicUsize::new(0));
        let summed = bands.into_par_iter().with_max_len(1).map(|mut band| {
            progress.check()?;
            let begun = Stopwatch::start();
            prepare(&mut band);
            let here = band.rows.clone();
            let lists =
                lists.iter().filter(|list| overlap(&list.rows, &here)).map(|list| list.drawn.as_slice());
            band.draw_each(pen, lists, 1, || {
                let done = done.fetch_add(1, Ordering::Relaxed) + 1;
                if done % BLOCKS_PER_REPORT == 0 {
                    progress.report(done as f32 / count as f32);
                }
                progress.check()
            })?;
            Ok((here, begun.elapsed()))
        });
        pace.learn(&work, &summed.collect::<Result<Vec<_>, _>>()?);
        Ok(())
    }

    /// Takes away the nodes that are no longer drawn, and adds those that are now.
    pub fn change(&mut self, pen: &Pen, changes: &Changes, pace: &Pace) {
        let changed: Vec<_> = changes.0.iter().filter(|block| !block.is_empty()).collect();
        let mut work = Work::empty(self.height());
        for (first, cost) in changed.iter().filter_map(|block| Some((block.first()?, block.cost))) {
            work.add(pen.nodes.row_of(first), cost);
        }
        let rows = changes.rows();
        let mut bands = self.bands(&work, pace, rows.len() as u32);
        bands.retain(|band| overlap(&rows, &band.rows));
        bands.into_par_iter().with_max_len(1).for_each(|mut band| {
            let here = band.rows.clone();
            for blocks in changed.chunks(BLOCKS_PER_CHANGE) {
                let blocks = || blocks.iter().filter(|block| overlap(&block.rows, &here));
                let Ok(()) = band.draw_each(pen, blocks().map(|block| &*block.removed), -1, never_cancelled);
                let Ok(()) = band.draw_each(pen, blocks().map(|block| &*block.added), 1, never_cancelled);
            }
        });
    }

    /// Pixel rows of the picture.
    fn height(&self) -> u32 {
        self.free.dim.levels[0].height as u32
    }

    /// Bands for work in this many rows: one for each thread, but few if there are few rows.
    fn bands(&mut self, work: &Work, pace: &Pace, rows: u32) -> Vec<Band<'_>> {
        let count = rayon::current_num_threads().min(rows.div_ceil(BAND_ROWS) as usize).max(1);
        let starts = work.band_starts(count, pace);
        let ends = starts.iter().skip(1).copied().chain([u32::MAX]);
        let rows = starts.iter().copied().zip(ends).map(|(start, end)| start..end);
        let both = self.free.bands(&starts).into_iter().zip(self.sharing.bands(&starts));
        rows.zip(both).map(|(rows, (free, sharing))| Band { rows, free, sharing }).collect()
    }
}

/// Nobody waits for so little.
fn never_cancelled() -> Result<(), Infallible> {
    Ok(())
}

/// Whether two ranges have anything in common.
#[inline(always)]
fn overlap(a: &Range<u32>, b: &Range<u32>) -> bool {
    a.start < b.end && b.start < a.end
}

/// Some pixel rows of both sums.
struct Band<'a> {
    rows: Range<u32>,
    free: SumCanvas<'a>,
    sharing: SumCanvas<'a>,
}

impl Band<'_> {
    /// Makes it black.
    fn clear(&mut self) {
        self.free.clear();
        self.sharing.clear();
    }

    /// Adds (`sign` 1) the nodes of some blocks' lists, or takes them away (−1). Ends with `check` if that fails after one.
    fn draw_each<'l, E>(
        &mut self,
        pen: &Pen,
        lists: impl Iterator<Item = &'l [DrawnNode]>,
        sign: i32,
        mut check: impl FnMut() -> Result<(), E>,
    ) -> Result<(), E> {
        let mut lists = lists.peekable();
        while let Some(list) = lists.next() {
            if let Some(next) = lists.peek() {
                self.prefetch_block(pen, next);
            }
            self.draw(pen, list, sign);
            check()?;
        }
        self.finish(sign);
        Ok(())
    }

    /// Adds (`sign` 1) the nodes of a list, or takes them away (−1): at the latest when it is finished with that sign.
    fn draw(&mut self, pen: &Pen, list: &[DrawnNode], sign: i32) {
        // Compiled for either sign.
        if sign > 0 {
            with_widest_simd(
                #[inline(always)]
                || self.draw_signed(pen, list, 1),
            );
        } else {
            with_widest_simd(
                #[inline(always)]
                || self.draw_signed(pen, list, -1),
            );
        }
    }

    #[inline(always)]
    fn draw_signed(&mut self, pen: &Pen, list: &[DrawnNode], sign: i32) {
        let node_at = |at: usize| list.get(at).map(|drawn| &pen.nodes.nodes[drawn.index as usize]);
        let prefetch_cells = |at: usize| {
            if let Some(node) = node_at(at) {
                prefetch(pen.nodes.cells(node));
                pen.moments.prefetch(node);
            }
        };
        (0..CELLS_AHEAD).for_each(prefetch_cells);
        for (at, drawn) in list.iter().enumerate() {
            prefetch(node_at(at + AHEAD));
            prefetch_cells(at + CELLS_AHEAD);
            if !overlap(&drawn.rows(), &self.rows) {
                continue;
            }
            let node = &pen.nodes.nodes[drawn.index as usize];
            let moved;
            let node = match &pen.view {
                None => node,
                Some(view) => {
                    moved = view.moved(node);
                    &moved
                }
            };
            let is_sharing = is_sharing(node, drawn.placed);
            let canvas = if is_sharing { &mut self.sharing } else { &mut self.free };
            canvas.draw(pen, node, drawn.placed, sign);
        }
    }

    /// Asks for the first nodes of a block, and for the finest level's pixels if it has samples to be drawn there: they lie in
    /// many rows, which a processor does not foresee.
    fn prefetch_block(&self, pen: &Pen, list: &[DrawnNode]) {
        list.iter().take(AHEAD).for_each(|drawn| prefetch(pen.nodes.nodes.get(drawn.index as usize)));
        const MANY: usize = (BLOCK_PX * BLOCK_PX / 4) as usize;
        let Some(first) = list.first().filter(|first| list.len() >= MANY && first.placed.level == 0) else {
            return;
        };
        let node = &pen.nodes.nodes[first.index as usize];
        let canvas = if is_sharing(node, first.placed) { &self.sharing } else { &self.free };
        canvas.dim[0].rows.prefetch_block(node.center);
    }

    /// Draws what waits.
    fn finish(&mut self, sign: i32) {
        self.free.finish(sign);
        self.sharing.finish(sign);
    }
}

/// Whether a node, drawn with the standard focus, shares the light that open samples leave of a pixel.
#[inline(always)]
pub fn is_sharing(node: &SplatNode, placed: Placed) -> bool {
    placed.is_standard && !node.is_open()
}

/// Rows that one thread resolves at a time.
pub const RESOLVE_ROWS: usize = 16;
