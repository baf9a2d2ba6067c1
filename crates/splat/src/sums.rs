//! All nodes of a light field, summed band by band of the picture.

use crate::canvas::{Accumulator, Canvas};
use crate::draw::{Pen, SeenRun};
use crate::drawn::{Drawn, Scene, rows_of};
use crate::lens_in_use::Placed;
use crate::nodes::{Nodes, SplatNode};
use crate::resolve::{Lines, Overflow, Quanta, Window, lines};
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

    fn bytes(&self) -> usize {
        self.dim.bytes() + self.bright.as_ref().map_or(0, Accumulator::bytes)
    }

    /// Its pixels in a window; `None` if they are black.
    fn lines(&self, nodes: &Nodes, window: &Window) -> Result<Option<Lines>, Overflow> {
        let dim = Quanta::new(nodes.scale.dim_bits, 32, nodes.brightest.min(crate::nodes::BRIGHT as f64));
        let mut found = lines(&self.dim, dim, window)?;
        if let Some(bright) = &self.bright {
            let quanta = Quanta::new(nodes.scale.bright_bits, 64, nodes.brightest);
            // Their coverage is among the ordinary ones'.
            if let (Some(found), Some(light)) = (&mut found, lines(bright, quanta, window)?) {
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
        let blocks = (0..scene.pen.nodes.blocks.len()).into_par_iter();
        let lists: Vec<_> = blocks
            .map(|block| {
                let list = scene.list(block, scene.paint.of_block(block));
                let rows = rows_of(&list);
                (list, rows)
            })
            .collect();
        let bands = self.bands();
        let (count, done) = (bands.len(), AtomicUsize::new(0));
        bands.into_par_iter().with_max_len(1).try_for_each(|mut band| {
            progress.check()?;
            band.free.clear();
            band.sharing.clear();
            let here = band.rows.clone();
            let lists = lists.iter().filter(|(_, rows)| meet(rows, &here)).map(|(list, _)| list);
            band.draw(&scene.pen, lists, 1);
            progress.report((done.fetch_add(1, Ordering::Relaxed) + 1) as f32 / count as f32);
            Ok(())
        })
    }

    /// Takes away the nodes `removed`, and adds `added`.
    pub fn change(&mut self, pen: &Pen, removed: &[Drawn], added: &[Drawn]) {
        let rows = rows_of(removed.iter().chain(added));
        let mut bands = self.bands();
        bands.retain(|band| meet(&rows, &band.rows));
        bands.into_par_iter().with_max_len(1).for_each(|mut band| {
            band.draw(pen, [removed], -1);
            band.draw(pen, [added], 1);
        });
    }

    fn bands(&mut self) -> Vec<Band<'_>> {
        let free = self.free.bands(BAND_ROWS).into_iter();
        let both = free.zip(self.sharing.bands(BAND_ROWS)).zip((0..).step_by(BAND_ROWS as usize));
        both.map(|((free, sharing), first)| Band { rows: first..first + BAND_ROWS, free, sharing }).collect()
    }

    /// The pixels in a window: what is free, and what shares the rest.
    pub fn lines(&self, nodes: &Nodes, window: &Window) -> Result<[Option<Lines>; 2], Overflow> {
        Ok([self.free.lines(nodes, window)?, self.sharing.lines(nodes, window)?])
    }
}

/// Whether two ranges have anything in common.
#[inline(always)]
fn meet(a: &Range<u32>, b: &Range<u32>) -> bool {
    a.start < b.end && b.start < a.end
}

/// Some pixel rows of both sums.
struct Band<'a> {
    rows: Range<u32>,
    free: SumCanvas<'a>,
    sharing: SumCanvas<'a>,
}

impl Band<'_> {
    /// Adds (`sign` 1) the nodes of lists, or takes them away (−1).
    fn draw<'d>(
        &mut self,
        pen: &Pen,
        lists: impl IntoIterator<Item = impl IntoIterator<Item = &'d Drawn>>,
        sign: i32,
    ) {
        with_widest_instructions(
            #[inline(always)]
            || {
                for drawn in lists.into_iter().flatten() {
                    if !meet(&drawn.rows(), &self.rows) {
                        continue;
                    }
                    let node = &pen.nodes.nodes[drawn.index as usize];
                    let is_sharing = is_sharing(node, drawn.placed);
                    let canvas = if is_sharing { &mut self.sharing } else { &mut self.free };
                    canvas.draw(pen, node, drawn.placed, sign);
                }
            },
        );
    }
}

/// Whether a node shares what open samples leave.
#[inline(always)]
pub fn is_sharing(node: &SplatNode, placed: Placed) -> bool {
    placed.is_standard && !node.is_open()
}

/// Rows that one thread resolves at a time.
pub const RESOLVE_ROWS: usize = 16;
