//! What of a pixel row the occluders let through.

use crate::canvas::POSITION_BITS;
use crate::draw::image::Image;
use crate::draw::pen::Pen;
use crate::fixed::{Divisor, GOLDEN, ONE, signed_mul_shift};
use crate::nodes::Cells;

/// A part of a pixel row that is let through, of `height` a pixel.
#[derive(Clone, Copy, Debug, Default)]
pub struct VisibleRun {
    pub row: i32,
    /// From where, 1/4096 px.
    pub start: i32,
    /// To where.
    pub end: i32,
    pub height: u32,
}

/// A pixel row of an image: where, and the lens's v at its middle, times 16384.
#[derive(Clone, Copy)]
pub struct Row {
    pub row: i32,
    pub v: i32,
}

/// The halvings into parts of a run whose weight changes along it, by that change.
fn halvings(tilt: i32) -> u32 {
    match tilt.abs() {
        tilt if tilt < ONE / 10 => 0,
        tilt if tilt < ONE / 3 => 1,
        _ => 2,
    }
}

/// ⌊x·factor / 2^`shift`⌋ for |factor| ≤ 2^`shift`, where x·factor may not fit; `shift` ≤ 15.
#[inline(always)]
fn scaled_floor(x: i32, factor: i32, shift: u32) -> i32 {
    (x >> shift) * factor + (((x & ((1 << shift) - 1)) * factor) >> shift)
}

/// The height of a pixel row in units of the image's radius, times 16384, counts as at most this.
pub const TALLEST_ROW: u32 = 1 << 16;

/// The smallest radius of the baked aperture's image, 1/4096 px: below it, cells cannot be resolved.
pub const SMALLEST_REACH: u32 = 1 << 8;

/// And as at most this.
pub const LARGEST_REACH: u32 = 1 << 30;

/// Rows of cells.
const ROWS: usize = 16;

/// The largest number of runs in a row of cells, and of parts of a run.
const MAX_RUNS: usize = 8;
const MAX_PARTS: usize = 4;

/// Binary digits of the height of a row of cells, where the baked aperture is 2·[`ONE`] high.
pub const CELL_BITS: u32 = 11;

/// Binary digits behind the point of a column of cells, from the left.
pub const COLUMN_BITS: u32 = 12;

/// The right edge of a row of cells.
pub const LAST_COLUMN: i32 = 16 << COLUMN_BITS;

/// A run of cells: the columns where it begins and ends, and how much of the pixel row it is in, times 16384.
#[derive(Clone, Copy)]
struct CellRun {
    columns: [i32; 2],
    share: i32,
}

/// How an image's rows meet its cells.
pub struct VisibleRuns {
    /// The image's centre, 1/4096 px, and where its dither starts.
    center: [i32; 2],
    dither: u32,
    base: i32,
    tilt: [i32; 2],
    /// A pixel row's height in the baked aperture, whose whole is 2·[`ONE`], and 2²⁸ over it.
    height: i32,
    per_height: u32,
    stop: i32,
    /// The radius of the baked aperture's image.
    reach: i32,
    per_reach: Divisor,
    /// Where cells begin and end, from the left, 1/4096 px; the outermost reach to infinity.
    edges: [i32; 17],
    is_turned: bool,
    /// Whether the weight is that at the aperture's centre for all of it.
    is_even: bool,
}

impl Pen<'_> {
    /// Whether an image's pixel rows take of all rows of cells that they lie across, not of one each.
    #[inline(always)]
    pub fn takes_all_rows(&self, image: &Image) -> bool {
        image.radius.unsigned_abs() < self.all_rows_radius
    }
}

impl VisibleRuns {
    /// The runs of the part of the aperture that the node of `image` sees, at the image's size.
    #[inline(always)]
    pub fn new(pen: &Pen, image: &Image) -> Self {
        let radius = image.radius.unsigned_abs();
        let reach = ((radius as u64 * pen.per_stop as u64) >> 14)
            .clamp(SMALLEST_REACH.into(), LARGEST_REACH.into()) as u32;
        let (base, tilt) = (i32::from(image.node.base), image.node.tilt.map(i32::from));
        let pixel = ((1u32 << 26) / radius.max(1)).min(TALLEST_ROW) as i32;
        let height = ((pixel * (pen.stop >> 2)) >> 12).clamp(1, 2 * ONE);
        let mut edges = [0; 17];
        for (cell, edge) in (-8..).zip(&mut edges) {
            *edge = image.center[0].wrapping_add(scaled_floor(reach as i32, cell, 3));
        }
        // The outermost cells hold everything that the blur of the footprint spreads beyond them.
        (edges[0], edges[16]) = (i32::MIN, i32::MAX);
        Self {
            center: image.center,
            edges,
            dither: image.dither,
            base,
            tilt,
            height,
            per_height: (1 << 28) / height as u32,
            stop: pen.stop,
            reach: reach as i32,
            per_reach: Divisor::new(reach),
            is_turned: image.radius < 0,
            is_even: base == ONE && tilt[0].abs() + tilt[1].abs() <= pen.even_partial_tilt,
        }
    }

    /// The largest number of calls of `emit` that [`Self::visit_row`] makes for a row.
    #[inline(always)]
    pub fn max_runs_of_row<const TAKES_ALL: bool>(&self) -> usize {
        // Rows of cells that a pixel row lies across.
        let rows = if TAKES_ALL { ((self.height >> CELL_BITS) as usize + 2).min(ROWS) } else { 1 };
        let runs = rows * MAX_RUNS;
        if self.is_even { runs } else { runs * MAX_PARTS }
    }

    /// Calls `emit` with start, end (1/4096 px) and weight (1/16384) of the parts of a row's span that `cells` let through.
    #[inline(always)]
    pub fn visit_row<const TAKES_ALL: bool>(
        &self,
        cells: &Cells,
        Row { row, v }: Row,
        span: [i32; 2],
        mut emit: impl FnMut(i32, i32, i32),
    ) {
        let middle = ((v * self.stop) >> 14) + ONE;
        if TAKES_ALL {
            self.visit_mean_runs(cells, middle, |run| self.emit_run(run, v, span, &mut emit));
            return;
        }
        // Each splat takes one of the rows of cells, each of its pixel rows its own.
        let from_center = (row - (self.center[1] >> POSITION_BITS)) as u32;
        let jitter = self.dither.wrapping_add(from_center.wrapping_mul(GOLDEN)) >> 18;
        let at = middle + ((self.height * (jitter as i32 - ONE / 2)) >> 14);
        let bits = cells[(at >> CELL_BITS).clamp(0, ROWS as i32 - 1) as usize];
        if self.is_even && bits == u16::MAX {
            return emit(span[0], span[1], ONE);
        }
        each_run(bits, |[first, end]| {
            // Of a turned image u grows to the left.
            let [first, end] = if self.is_turned { [16 - end, 16 - first] } else { [first, end] };
            let [from, to] = [first, end].map(|cell| self.edges[cell as usize]);
            self.emit_weighted([from.max(span[0]), to.min(span[1])], ONE, v, &mut emit);
        });
    }

    /// Calls `emit` with what is let through of a pixel row by all rows of cells that it lies across, as much as it lies in each.
    /// Rows that let through one run each, not far from each other, are taken as one with the mean of their edges.
    #[inline(always)]
    fn visit_mean_runs(&self, cells: &Cells, middle: i32, mut emit: impl FnMut(CellRun)) {
        // The outermost rows hold everything that the blur of the footprint spreads beyond them.
        let lowest = middle - self.height / 2;
        let bottom = lowest.clamp(0, 2 * ONE - 1);
        let top = (lowest + self.height).clamp(bottom + 1, 2 * ONE);
        let all = top - bottom;
        let per_height = if all == self.height { self.per_height } else { (1 << 28) / all as u32 };
        let mut mean = MeanRun::default();
        let mut at = bottom;
        while at < top {
            let (start, bits) = (at, cells[row_of_height(at)]);
            while at < top && cells[row_of_height(at)] == bits {
                at = ((at >> CELL_BITS) + 1) << CELL_BITS;
            }
            if bits == 0 {
                continue;
            }
            let height = at.min(top) - start;
            let share = if height == all { ONE } else { ((height as u32 * per_height) >> 14) as i32 };
            let [first, end] = ends(bits);
            if bits.count_ones() != end - first {
                each_run(bits, |run| emit(CellRun { columns: run.map(column), share }));
            } else {
                let run = [first as i32, end as i32];
                if !mean.is_near(run, (self.height >> CELL_BITS) + 2) {
                    emit(mean.run());
                    mean = MeanRun::default();
                }
                mean.add(run, share);
            }
        }
        if mean.share > 0 {
            emit(mean.run());
        }
    }

    /// Calls `emit` with where a run lies within a row's span, in parts with their weights.
    #[inline(always)]
    fn emit_run(&self, run: CellRun, v: i32, span: [i32; 2], emit: &mut impl FnMut(i32, i32, i32)) {
        let [first, last] = run.columns;
        let [first, last] =
            if self.is_turned { [LAST_COLUMN - last, LAST_COLUMN - first] } else { [first, last] };
        let at = |column: i32| {
            self.center[0].wrapping_add(scaled_floor(self.reach, column - LAST_COLUMN / 2, COLUMN_BITS + 3))
        };
        let from = if first == 0 { span[0] } else { at(first).max(span[0]) };
        let to = if last == LAST_COLUMN { span[1] } else { at(last).min(span[1]) };
        self.emit_weighted([from, to], run.share, v, emit);
    }

    /// Calls `emit` with a `share` of a run, in parts with their weights.
    #[inline(always)]
    fn emit_weighted(&self, [from, to]: [i32; 2], share: i32, v: i32, emit: &mut impl FnMut(i32, i32, i32)) {
        if from >= to {
            return;
        }
        if self.is_even {
            return emit(from, to, share);
        }
        // Not the jittered row: weights are smooth.
        let base = self.base + ((self.tilt[1] * ((v * self.stop) >> 14)) >> 14);
        let toward = if self.is_turned { -self.tilt[0] } else { self.tilt[0] };
        let (shift, width) = (halvings(self.tilt[0]), to.wrapping_sub(from));
        for at in 0..1 << shift {
            let [start, end] = [at, at + 1].map(|k| from.wrapping_add(scaled_floor(width, k, shift)));
            // The baked aperture's u in the middle, and half the part's width.
            let middle = self.per_reach.divide(((start >> 1) + (end >> 1)).wrapping_sub(self.center[0]));
            let half = self.per_reach.divide(end.wrapping_sub(start) >> 1);
            let weight = base + ((toward * middle) >> 14);
            if weight > 0 {
                // Within the part the light leans toward where the weight is.
                let lean = (toward * ((half * half) >> 14) / (3 * weight)).clamp(-half, half);
                let moved = signed_mul_shift(self.reach, lean, 14);
                emit(start.wrapping_add(moved), end.wrapping_add(moved), (weight * share) >> 14);
            }
        }
    }
}

/// The row of cells at a height of the baked aperture.
#[inline(always)]
fn row_of_height(height: i32) -> usize {
    (height >> CELL_BITS) as usize & (ROWS - 1)
}

/// The left edge of a cell.
#[inline(always)]
fn column(cell: u32) -> i32 {
    (cell << COLUMN_BITS) as i32
}

/// The first visible cell of a row that has any, and the one behind the last.
#[inline(always)]
fn ends(bits: u16) -> [u32; 2] {
    let bits = u32::from(bits);
    [bits.trailing_zeros(), u32::BITS - bits.leading_zeros()]
}

/// Calls `emit` with the first cell of each run of a row, and the one behind its last.
#[inline(always)]
fn each_run(bits: u16, mut emit: impl FnMut([u32; 2])) {
    let mut bits = u32::from(bits);
    while bits != 0 {
        let first = bits.trailing_zeros();
        let end = first + (bits >> first).trailing_ones();
        bits &= u32::MAX << end;
        emit([first, end]);
    }
}

/// The mean of runs of several rows of cells.
#[derive(Clone, Copy, Default)]
struct MeanRun {
    /// The sum of their shares.
    share: i32,
    /// The first of them, in cells.
    first: [i32; 2],
    /// How far the others begin and end from there, times their shares.
    apart: [i32; 2],
}

impl MeanRun {
    /// Whether a run begins and ends at most this many cells from the first, if there is one.
    #[inline(always)]
    fn is_near(&self, run: [i32; 2], most: i32) -> bool {
        let near = |k: usize| (run[k] - self.first[k]).abs() <= most;
        self.share == 0 || near(0) && near(1)
    }

    #[inline(always)]
    fn add(&mut self, run: [i32; 2], share: i32) {
        if self.share == 0 {
            self.first = run;
        }
        self.share += share;
        (0..2).for_each(|k| self.apart[k] += share * (run[k] - self.first[k]));
    }

    #[inline(always)]
    fn run(&self) -> CellRun {
        let mean = |k: usize| {
            let apart = if self.apart[k] == 0 { 0 } else { (self.apart[k] << COLUMN_BITS) / self.share };
            (self.first[k] << COLUMN_BITS) + apart
        };
        CellRun { columns: [mean(0), mean(1)], share: self.share }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::canvas::PIXEL;

    /// Pixel rows of this height in the baked aperture.
    fn rows_of(height: i32) -> VisibleRuns {
        VisibleRuns {
            center: [0; 2],
            dither: 0,
            base: ONE,
            tilt: [0; 2],
            height,
            per_height: (1 << 28) / height as u32,
            stop: ONE,
            reach: PIXEL,
            per_reach: Divisor::new(PIXEL as u32),
            edges: [0; 17],
            is_turned: false,
            is_even: true,
        }
    }

    fn visible_cell_runs(rows: &VisibleRuns, cells: &Cells, middle: i32) -> Vec<CellRun> {
        let mut runs = Vec::new();
        rows.visit_mean_runs(cells, middle, |run| runs.push(run));
        runs
    }

    /// What is seen of a pixel row, and its first moment along the row, is what its rows of cells see.
    #[test]
    fn rows_see_what_their_cells_do() {
        let half_plane = std::array::from_fn(|row| (u32::MAX << row.min(15)) as u16);
        let slab = std::array::from_fn(|row| if row % 5 < 2 { 0x0FF0 } else { 0 });
        let noise = std::array::from_fn(|row| (row as u16 + 7).wrapping_mul(0x9E37));
        for cells in [half_plane, slab, noise, [0; 16], [u16::MAX; 16]] {
            for (height, middle) in
                [(700, 5000), (2048, 9000), (5000, 20_000), (9000, 1000), (30_000, 17_000)]
            {
                let rows = rows_of(height);
                let found = visible_cell_runs(&rows, &cells, middle);
                assert!(found.len() <= rows.max_runs_of_row::<true>());
                let bottom = (middle - height / 2).max(0);
                let top = (middle - height / 2 + height).min(2 * ONE);
                let mut wanted = [0.0; 2];
                for (row, bits) in cells.iter().enumerate() {
                    let [low, high] =
                        [row, row + 1].map(|row| ((row as i32) << CELL_BITS).clamp(bottom, top));
                    for cell in (0..16).filter(|cell| bits >> cell & 1 == 1) {
                        let seen = f64::from(high - low) / f64::from(top - bottom);
                        wanted[0] += seen;
                        wanted[1] += seen * (f64::from(cell) + 0.5);
                    }
                }
                let seen = found.iter().map(|run| {
                    let [from, to] = run.columns.map(|column| f64::from(column) / 4096.0);
                    let seen = (to - from) * f64::from(run.share) / f64::from(ONE);
                    [seen, seen * (from + to) / 2.0]
                });
                let seen = seen.fold([0.0; 2], |sum, seen| [sum[0] + seen[0], sum[1] + seen[1]]);
                assert!((seen[0] - wanted[0]).abs() < 0.02, "{height} {middle}: {seen:?}, {wanted:?}");
                // Edges' mean is not quite that of what lies between them.
                let slack = 0.01 + wanted[0] * f64::from(height >> CELL_BITS) / 8.0;
                assert!((seen[1] - wanted[1]).abs() < slack, "{height} {middle}: {seen:?}, {wanted:?}");
            }
        }
    }

    #[test]
    fn an_edge_is_one_run() {
        let slanted: Cells = std::array::from_fn(|row| u16::MAX >> (row / 2));
        for (height, middle) in [(1500, 4096), (4096, 10_000), (6000, 20_000)] {
            assert_eq!(visible_cell_runs(&rows_of(height), &slanted, middle).len(), 1, "{height}");
        }
        // What lies apart stays apart.
        let apart: Cells = std::array::from_fn(|row| if row < 8 { 0x000F } else { 0xF000 });
        assert_eq!(visible_cell_runs(&rows_of(4096), &apart, ONE).len(), 2);
    }
}
