//! What of a pixel row the occluders let through.

use crate::canvas::{POSITION_BITS, Rows, Word};
use crate::draw::Pen;
use crate::draw::image::Image;
use crate::nodes::{Cells, ONE};

/// The parts of a run whose weight changes along it, by that change.
fn parts_of(tilt: i64) -> i64 {
    match tilt.abs() {
        tilt if tilt < ONE as i64 / 10 => 1,
        tilt if tilt < ONE as i64 / 3 => 2,
        _ => 4,
    }
}

impl Pen<'_> {
    /// Adds the parts of a row's span that `cells` let through, of a `height` with so many bits behind the point.
    #[allow(clippy::too_many_arguments)]
    #[inline(always)]
    pub fn add_seen<W: Word>(
        &self,
        image: &Image,
        cells: &Cells,
        row: i32,
        v: i32,
        span: [i64; 2],
        (height, bits): (i64, u32),
        rows: &mut Rows<W>,
        sign: i64,
    ) {
        self.seen_runs(image, cells, row, v, span, |start, end, weight| {
            let value = image.value((height * weight) >> 14, bits, row);
            rows.add_run(row, rows.clamped(start), rows.clamped(end), value, sign);
        });
    }

    /// Calls `emit` with start, end (1/4096 px) and weight (1/16384) of the parts of a row's span that `cells` let through.
    #[inline(always)]
    pub fn seen_runs(
        &self,
        image: &Image,
        cells: &Cells,
        row: i32,
        v: i32,
        span: [i64; 2],
        mut emit: impl FnMut(i64, i64, i64),
    ) {
        // A pixel row may lie across several rows of cells: each splat takes one of them, each row its own.
        let from_center = (row - (image.center[1] >> POSITION_BITS)) as u32;
        let jitter = (image.dither ^ from_center.wrapping_mul(0x85EB_CA77)).wrapping_mul(0xC2B2_AE35) >> 18;
        let pixel = (ONE << POSITION_BITS) as i64 / (image.radius.unsigned_abs().max(1) as i64);
        let jittered = v as i64 + ((pixel * (jitter as i64 - ONE as i64 / 2)) >> 14);
        let of_baked = (jittered * self.stop as i64) >> 14;
        let cell_row = ((of_baked + ONE as i64) >> 11).clamp(0, 15);
        let mut bits = cells[cell_row as usize] as u32;
        if image.radius < 0 {
            // u grows to the left.
            bits = u32::from((bits as u16).reverse_bits());
        }
        // The baked aperture's image.
        let reach = (((image.radius.unsigned_abs() as i64) << 14) / self.stop.max(1) as i64).max(1);
        // The outermost cells hold all that the blur of the footprint throws beyond them.
        let edge = |cell: i64| match cell {
            0 => i64::MIN,
            16 => i64::MAX,
            _ => image.center[0] as i64 + ((reach * (cell - 8)) >> 3),
        };
        let tilt = [image.node.tilt[0] as i64, image.node.tilt[1] as i64];
        let is_even = tilt == [0, 0] && image.node.base == ONE as i16;
        // Not the jittered row: weights are smooth.
        let base = image.node.base as i64 + ((tilt[1] * ((v as i64 * self.stop as i64) >> 14)) >> 14);
        let signed_reach = if image.radius < 0 { -reach } else { reach };
        while bits != 0 {
            let start = bits.trailing_zeros();
            let length = (bits >> start).trailing_ones();
            bits &= !(((1u32 << length) - 1) << start);
            let [from, to] = [start as i64, (start + length) as i64];
            let (from_x, to_x) = (edge(from).max(span[0]), edge(to).min(span[1]));
            if from_x >= to_x {
                continue;
            }
            if is_even {
                emit(from_x, to_x, ONE as i64);
                continue;
            }
            let parts = parts_of(tilt[0]);
            for part in 0..parts {
                let start = from_x + (to_x - from_x) * part / parts;
                let end = from_x + (to_x - from_x) * (part + 1) / parts;
                // The baked aperture's u in the middle, and half the part's width.
                let middle = ((start + end - 2 * image.center[0] as i64) << 13) / signed_reach;
                let half = ((end - start) << 13) / reach;
                let weight = base + ((tilt[0] * middle) >> 14);
                if weight > 0 {
                    // Within the part the light leans toward where the weight is.
                    let lean = tilt[0] * ((half * half) >> 14) / (3 * weight);
                    let moved = (lean.clamp(-half, half) * signed_reach) >> 14;
                    emit(start + moved, end + moved, weight);
                }
            }
        }
    }
}
