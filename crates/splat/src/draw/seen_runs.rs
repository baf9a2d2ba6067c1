//! What of a pixel row the occluders let through.

use crate::canvas::POSITION_BITS;
use crate::draw::Pen;
use crate::draw::image::Image;
use crate::fixed::{Divisor, signed_mul_shift};
use crate::nodes::{Cells, ONE};

/// A part of a pixel row that is let through, of `height` a pixel.
#[derive(Clone, Copy, Debug)]
pub struct SeenRun {
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

/// 2³² over the golden ratio: its multiples, wrapped, are spread out evenly.
const GOLDEN: u32 = 0x9E37_79B1;

/// ⌊x·factor / 2^`shift`⌋ for |factor| < 2^`shift`, where x·factor may not fit.
#[inline(always)]
fn part(x: i32, factor: i32, shift: u32) -> i32 {
    (x >> shift) * factor + (((x & ((1 << shift) - 1)) * factor) >> shift)
}

/// The height of a pixel row in units of the image's radius, times 16384, counts as at most this.
const TALLEST_ROW: u32 = 1 << 16;

/// Radii of the baked aperture's image, 1/4096 px, count as at least this: so small, its cells are not told apart.
const SMALLEST_REACH: u64 = 1 << 8;

/// And as at most this.
const LARGEST_REACH: u64 = 1 << 30;

/// How an image's rows meet its cells.
pub struct SeenRuns {
    /// A pixel row's height, as the lens's v.
    pixel: i32,
    stop: i32,
    /// The radius of the baked aperture's image.
    reach: i32,
    per_reach: Divisor,
    is_turned: bool,
    /// Whether the weight is that at the aperture's centre for all of it.
    is_even: bool,
}

impl SeenRuns {
    #[inline(always)]
    pub fn new(pen: &Pen, image: &Image) -> Self {
        let radius = image.radius.unsigned_abs();
        let reach = ((radius as u64 * pen.per_stop as u64) >> 14).clamp(SMALLEST_REACH, LARGEST_REACH) as u32;
        Self {
            pixel: ((1u32 << 26) / radius.max(1)).min(TALLEST_ROW) as i32,
            stop: pen.stop,
            reach: reach as i32,
            per_reach: Divisor::new(reach),
            is_turned: image.radius < 0,
            is_even: image.node.base as i32 == ONE
                && (image.node.tilt[0].abs() as i32 + (image.node.tilt[1].abs() as i32))
                    <= pen.even_seen_tilt,
        }
    }

    /// Calls `emit` with start, end (1/4096 px) and weight (1/16384) of the parts of a row's span that `cells` let through.
    #[inline(always)]
    pub fn of_row(
        &self,
        image: &Image,
        cells: &Cells,
        Row { row, v }: Row,
        span: [i32; 2],
        mut emit: impl FnMut(i32, i32, i32),
    ) {
        // A pixel row may lie across several rows of cells: each splat takes one of them, each row its own.
        let from_center = (row - (image.center[1] >> POSITION_BITS)) as u32;
        let jitter = image.dither.wrapping_add(from_center.wrapping_mul(GOLDEN)) >> 18;
        let jittered = v + ((self.pixel * (jitter as i32 - ONE / 2)) >> 14);
        let of_baked = (jittered * self.stop) >> 14;
        let cell_row = ((of_baked + ONE) >> 11).clamp(0, 15);
        let mut bits = cells[cell_row as usize] as u32;
        if self.is_even && bits == u32::from(u16::MAX) {
            return emit(span[0], span[1], ONE);
        }
        if self.is_turned {
            // u grows to the left.
            bits = u32::from((bits as u16).reverse_bits());
        }
        // The outermost cells hold all that the blur of the footprint throws beyond them.
        let edge = |cell: u32| match cell {
            0 => i32::MIN,
            16 => i32::MAX,
            _ => image.center[0].wrapping_add(part(self.reach, cell as i32 - 8, 3)),
        };
        let tilt = image.node.tilt.map(i32::from);
        // Not the jittered row: weights are smooth.
        let base = image.node.base as i32 + ((tilt[1] * ((v * self.stop) >> 14)) >> 14);
        while bits != 0 {
            let start = bits.trailing_zeros();
            let end = start + (bits >> start).trailing_ones();
            bits &= u32::MAX << end;
            let (from, to) = (edge(start).max(span[0]), edge(end).min(span[1]));
            if from >= to {
                continue;
            }
            if self.is_even {
                emit(from, to, ONE);
                continue;
            }
            let (shift, width) = (halvings(tilt[0]), to.wrapping_sub(from));
            for at in 0..1 << shift {
                let [start, end] = [at, at + 1].map(|k| from.wrapping_add(part(width, k, shift)));
                // The baked aperture's u in the middle, and half the part's width.
                let middle = self.per_reach.divide(((start >> 1) + (end >> 1)).wrapping_sub(image.center[0]));
                let half = self.per_reach.divide(end.wrapping_sub(start) >> 1);
                let toward = if self.is_turned { -tilt[0] } else { tilt[0] };
                let weight = base + ((toward * middle) >> 14);
                if weight > 0 {
                    // Within the part the light leans toward where the weight is.
                    let lean = (toward * ((half * half) >> 14) / (3 * weight)).clamp(-half, half);
                    let moved = signed_mul_shift(self.reach, lean, 14);
                    emit(start.wrapping_add(moved), end.wrapping_add(moved), weight);
                }
            }
        }
    }
}
