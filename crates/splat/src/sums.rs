//! All nodes of a light field, summed band by band of the picture.

use crate::canvas::{Accumulator, Canvas};
use crate::draw::{Pen, SeenRun};
use crate::lens_in_use::{LensInUse, NodeFocus, Placed};
use crate::nodes::{Nodes, SplatNode};
use crate::paint::Paint;
use crate::partition::Share;
use crate::resolve::{Lines, Overflow, Quanta, add_rows};
use crate::widest::with_widest_instructions;
use progress::{Cancelled, Progress};
use rayon::prelude::*;
use salf::tree::LEVELS;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Pixel rows that one thread sums at a time; a multiple of the coarsest level's pixel.
const BAND_ROWS: i32 = 64;

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

    fn bands(&mut self, rows: i32) -> Vec<SumCanvas<'_>> {
        let mut bright = self.bright.as_mut().map(|bright| bright.bands(rows).into_iter());
        let dim = self.dim.bands(rows).into_iter();
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

    /// Its pixel rows `rows`.
    fn lines(&self, nodes: &Nodes, rows: Range<i32>) -> Result<Lines, Overflow> {
        let mut lines = vec![[0.0; 4]; self.dim.levels[0].width * rows.len()];
        let dim = Quanta::new(nodes.scale.dim_bits, 32, nodes.brightest.min(crate::nodes::BRIGHT as f64));
        add_rows(&self.dim, dim, rows.clone(), &mut lines)?;
        if let Some(bright) = &self.bright {
            let quanta = Quanta::new(nodes.scale.bright_bits, 64, nodes.brightest);
            let mut light = vec![[0.0; 4]; lines.len()];
            add_rows(bright, quanta, rows, &mut light)?;
            for (pixel, light) in lines.iter_mut().zip(light) {
                (0..3).for_each(|c| pixel[c] += light[c]);
            }
        }
        Ok(lines)
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
    fn draw(&mut self, pen: &Pen, index: u32, node: &SplatNode, placed: Placed, sign: i32) {
        // All coverage is summed alike, so that how bright a sample is leaves no trace in it.
        let found = &mut self.found;
        match &mut self.bright {
            Some(bright) if node.is_bright => {
                pen.draw(index, node.light, placed, bright, found, sign);
                pen.draw(index, pen.nodes.dim_coverage(node), placed, &mut self.dim, found, sign);
            }
            _ => pen.draw(index, node.light, placed, &mut self.dim, found, sign),
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

    /// The pixel rows that a block's light may reach.
    fn reach(&self, block: usize) -> Range<i32> {
        let bounds = &self.pen.nodes.bounds[block];
        let (mut t, mut anchor) = ([1.0f32; 2], [0.0f32; 2]);
        for focus in self.paint.of_block(block).into_iter().flatten() {
            t = [t[0].min(focus.t), t[1].max(focus.t)];
            anchor = [anchor[0].min(focus.anchor), anchor[1].max(focus.anchor)];
        }
        let radius = self.lens.largest_radius_px(bounds.inverse_depths, t, anchor);
        // Coarse levels spread a little further.
        let reach = radius * 1.01 + 2.0 * bounds.half_height as f64 + 3.0 * (1 << LEVELS) as f64;
        let clamp = |row: f64| row.clamp(-1e9, 1e9) as i32;
        clamp(bounds.rows[0] as f64 - reach)..clamp(bounds.rows[1] as f64 + reach)
    }
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
        let blocks = scene.pen.nodes.blocks.len();
        let reaches: Vec<_> = (0..blocks).into_par_iter().map(|block| scene.reach(block)).collect();
        let bands: Vec<_> =
            self.free.bands(BAND_ROWS).into_iter().zip(self.sharing.bands(BAND_ROWS)).collect();
        let (count, done) = (bands.len(), AtomicUsize::new(0));
        bands.into_par_iter().enumerate().with_max_len(1).try_for_each(|(band, (mut free, mut sharing))| {
            progress.check()?;
            free.clear();
            sharing.clear();
            let rows = band as i32 * BAND_ROWS..(band as i32 + 1) * BAND_ROWS;
            let reaches = reaches.iter().enumerate();
            let blocks = reaches.filter(|(_, reach)| reach.start <= rows.end && reach.end >= rows.start);
            with_widest_instructions(
                #[inline(always)]
                || {
                    for (block, _) in blocks {
                        scene.drawn(
                            block,
                            scene.paint.of_block(block),
                            #[inline(always)]
                            |index, node, placed| {
                                let canvas = if is_sharing(node, placed) { &mut sharing } else { &mut free };
                                canvas.draw(&scene.pen, index, node, placed, 1);
                            },
                        );
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
                    canvas.draw(pen, index, node, placed, sign);
                }
            },
        );
    }

    /// The factors that a standard picture's sums give its pixel rows `rows`.
    pub fn shares(&self, nodes: &Nodes, rows: Range<i32>) -> Result<Vec<Share>, Overflow> {
        let (free, sharing) = (self.free.lines(nodes, rows.clone())?, self.sharing.lines(nodes, rows)?);
        let shares = free.iter().zip(&sharing).map(|(free, sharing)| Share::of(free[3], sharing[3]));
        Ok(shares.collect())
    }

    /// The picture's pixel rows `rows`, evened out if nothing is painted.
    pub fn picture(
        &self,
        nodes: &Nodes,
        rows: Range<i32>,
        shares: &[Share],
        is_painted: bool,
    ) -> Result<Lines, Overflow> {
        let mut lines = self.free.lines(nodes, rows.clone())?;
        let sharing = self.sharing.lines(nodes, rows)?;
        for ((pixel, sharing), share) in lines.iter_mut().zip(&sharing).zip(shares) {
            let even = if is_painted { 1.0 } else { share.even };
            (0..4).for_each(|c| pixel[c] = even * (pixel[c] + share.partial * sharing[c]));
        }
        Ok(lines)
    }
}

/// Whether a node shares what open samples leave.
#[inline(always)]
pub fn is_sharing(node: &SplatNode, placed: Placed) -> bool {
    placed.is_standard && !node.is_open()
}

/// Rows that one thread resolves at a time.
pub const RESOLVE_ROWS: usize = 32;
