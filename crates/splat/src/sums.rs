//! All nodes of a light field, summed band by band of the picture.

use crate::canvas::{Accumulator, Canvas};
use crate::draw::{Pen, SeenRun};
use crate::lens_in_use::{LensInUse, NodeFocus, Placed};
use crate::nodes::{Nodes, SplatNode};
use crate::paint::Paint;
use crate::resolve::{Lines, Overflow, Quanta, lines};
use crate::widest::with_widest_instructions;
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use salf::tree::LEVELS;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Pixel rows that one thread sums at a time; a multiple of the coarsest level's pixel.
const BAND_ROWS: u32 = 64;

/// One kind of samples: ordinary ones, and bright ones if there are any.
#[derive(Clone, PartialEq)]
pub struct Sum {
    pub dim: Accumulator<i32>,
    pub bright: Option<Accumulator<i64>>,
}

/// The sums of a picture.
#[derive(Clone, PartialEq)]
pub struct Sums {
    /// Open samples, and painted ones.
    pub free: Sum,
    /// Unpainted samples that see part of the aperture: they share what open ones leave (see [`crate::partition`]).
    pub sharing: Sum,
}

/// Rows of a sum to draw on.
struct SumCanvas<'a> {
    dim: Canvas<'a, i32>,
    bright: Option<Canvas<'a, i64>>,
    /// Room to work in.
    found: Vec<SeenRun>,
}

impl Sum {
    fn new([width, height]: [usize; 2], has_bright: bool) -> Self {
        Self {
            dim: Accumulator::new(width, height, LEVELS),
            bright: has_bright.then(|| Accumulator::new(width, height, 1)),
        }
    }

    fn bands(&mut self, rows: u32) -> Vec<SumCanvas<'_>> {
        let mut bright = self.bright.as_mut().map(|bright| bright.bands(rows as i32).into_iter());
        let dim = self.dim.bands(rows as i32).into_iter();
        let canvas =
            |dim| SumCanvas { dim, bright: bright.as_mut().and_then(Iterator::next), found: Vec::new() };
        dim.map(canvas).collect()
    }

    fn canvas(&mut self) -> SumCanvas<'_> {
        let bright = self.bright.as_mut().map(Accumulator::canvas);
        SumCanvas { dim: self.dim.canvas(), bright, found: Vec::new() }
    }

    fn bytes(&self) -> usize {
        self.dim.bytes() + self.bright.as_ref().map_or(0, Accumulator::bytes)
    }

    /// Its pixel rows `rows`; `None` if they are black.
    fn lines(&self, nodes: &Nodes, rows: Range<i32>) -> Result<Option<Lines>, Overflow> {
        let dim = Quanta::new(nodes.scale.dim_bits, 32, nodes.brightest.min(crate::nodes::BRIGHT as f64));
        let mut found = lines(&self.dim, dim, rows.clone())?;
        if let Some(bright) = &self.bright {
            let quanta = Quanta::new(nodes.scale.bright_bits, 64, nodes.brightest);
            // Their coverage is among the ordinary ones'.
            if let (Some(found), Some(light)) = (&mut found, lines(bright, quanta, rows)?) {
                found.add_light(&light);
            }
        }
        Ok(found)
    }
}

impl SumCanvas<'_> {
    fn clear(&mut self) {
        self.dim.clear();
        if let Some(bright) = &mut self.bright {
            bright.clear();
        }
    }

    #[inline(always)]
    fn draw(&mut self, pen: &Pen, node: &SplatNode, placed: Placed, sign: i32) {
        // All coverage is summed alike, so that how bright a sample is leaves no trace in it.
        let found = &mut self.found;
        match &mut self.bright {
            Some(bright) if node.is_bright => {
                pen.draw(node, node.light, placed, bright, found, sign);
                pen.draw(node, pen.nodes.dim_coverage(node), placed, &mut self.dim, found, sign);
            }
            _ => pen.draw(node, node.light, placed, &mut self.dim, found, sign),
        }
    }
}

/// What is summed: nodes as a lens sees them, and their paint.
pub struct Scene<'a> {
    pub pen: Pen<'a>,
    pub lens: &'a LensInUse,
    pub paint: &'a Paint,
}

impl Scene<'_> {
    /// Calls `visit` with each node of a block that is drawn, painted as `paint` says.
    #[inline(always)]
    pub fn drawn(
        &self,
        block: usize,
        paint: Option<&[NodeFocus]>,
        mut visit: impl FnMut(u32, &SplatNode, Placed),
    ) {
        let first = self.pen.nodes.blocks[block].start;
        let nodes = self.pen.nodes.of_block(block);
        let mut at = 0;
        while at < nodes.len() {
            let node = &nodes[at];
            let focus = paint.map_or(NodeFocus::STANDARD, |paint| paint[at]);
            let placed = self.lens.place(node, &focus);
            if node.is_leaf || self.lens.may_merge(node, &focus, placed) {
                if self.pen.nodes.may_reach_frame(node, placed.radius) {
                    visit(first + at as u32, node, placed);
                }
                at = (node.end - first) as usize;
            } else {
                at += 1;
            }
        }
    }

    /// The nodes of a block that are drawn.
    fn list(&self, block: usize, height: u32) -> Vec<Drawn> {
        let mut list = Vec::new();
        self.drawn(
            block,
            self.paint.of_block(block),
            #[inline(always)]
            |index, node, placed| {
                let rows = self.pen.rows(node, placed, height);
                if !rows.is_empty() {
                    list.push(Drawn { index, placed, rows: [rows.start, rows.end] });
                }
            },
        );
        list
    }
}

/// A node that is drawn.
struct Drawn {
    index: u32,
    placed: Placed,
    /// The first pixel row that its light may reach, and the one behind the last.
    rows: [u32; 2],
}

impl Sums {
    /// Empty ones, for a picture of this size.
    pub fn new(size: [usize; 2], has_bright: bool) -> Self {
        Self { free: Sum::new(size, has_bright), sharing: Sum::new(size, has_bright) }
    }

    /// Bytes in memory.
    pub fn bytes(&self) -> usize {
        self.free.bytes() + self.sharing.bytes()
    }

    /// Sets them to what a scene sends.
    pub fn set(&mut self, scene: &Scene, progress: &dyn Progress) -> Result<(), Cancelled> {
        let height = self.free.dim.levels[0].height as u32;
        let blocks = (0..scene.pen.nodes.blocks.len()).into_par_iter();
        let lists: Vec<(Vec<Drawn>, Range<u32>)> = blocks
            .map(|block| {
                let list = scene.list(block, height);
                let first = list.iter().map(|drawn| drawn.rows[0]).min().unwrap_or(0);
                let end = list.iter().map(|drawn| drawn.rows[1]).max().unwrap_or(0);
                (list, first..end)
            })
            .collect();
        let bands: Vec<_> =
            self.free.bands(BAND_ROWS).into_iter().zip(self.sharing.bands(BAND_ROWS)).collect();
        let (count, done) = (bands.len(), AtomicUsize::new(0));
        bands.into_par_iter().enumerate().with_max_len(1).try_for_each(|(band, (mut free, mut sharing))| {
            progress.check()?;
            free.clear();
            sharing.clear();
            let first = band as u32 * BAND_ROWS;
            let is_here = |rows: [u32; 2]| rows[0] < first + BAND_ROWS && rows[1] > first;
            let lists = lists.iter().filter(|(_, rows)| is_here([rows.start, rows.end]));
            with_widest_instructions(
                #[inline(always)]
                || {
                    for drawn in lists.flat_map(|(list, _)| list).filter(|drawn| is_here(drawn.rows)) {
                        let node = &scene.pen.nodes.nodes[drawn.index as usize];
                        let canvas = if is_sharing(node, drawn.placed) { &mut sharing } else { &mut free };
                        canvas.draw(&scene.pen, node, drawn.placed, 1);
                    }
                },
            );
            progress.report((done.fetch_add(1, Ordering::Relaxed) + 1) as f32 / count as f32);
            Ok(())
        })
    }

    /// Adds (`sign` 1) nodes, or takes them away (−1).
    pub fn add(&mut self, pen: &Pen, drawn: &[(u32, Placed)], sign: i32) {
        let (mut free, mut sharing) = (self.free.canvas(), self.sharing.canvas());
        with_widest_instructions(
            #[inline(always)]
            || {
                for &(index, placed) in drawn {
                    let node = &pen.nodes.nodes[index as usize];
                    let canvas = if is_sharing(node, placed) { &mut sharing } else { &mut free };
                    canvas.draw(pen, node, placed, sign);
                }
            },
        );
    }

    /// The pixel rows `rows`: what is free, and what shares the rest.
    pub fn lines(&self, nodes: &Nodes, rows: Range<i32>) -> Result<[Option<Lines>; 2], Overflow> {
        Ok([self.free.lines(nodes, rows.clone())?, self.sharing.lines(nodes, rows)?])
    }
}

/// Whether a node shares what open samples leave.
#[inline(always)]
pub fn is_sharing(node: &SplatNode, placed: Placed) -> bool {
    placed.is_standard && !node.is_open()
}

/// Rows that one thread resolves at a time.
pub const RESOLVE_ROWS: usize = 16;
