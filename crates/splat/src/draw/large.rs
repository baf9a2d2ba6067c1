//! Images too large for stencils.

use crate::canvas::{PIXEL, POSITION_BITS, Rows, Word};
use crate::draw::Pen;
use crate::draw::image::Image;
use crate::nodes::{Cells, ONE};

/// The light of larger images, in pixel rows, is what their area says; that of smaller ones what their rows say.
const MOST_ROWS: i64 = 1 << 12;

/// Bits behind the point of the heights of large images.
const LARGE_HEIGHT_BITS: u32 = 36;

impl Pen<'_> {
    /// An image too large for a stencil: each pixel row is looked up in the shape.
    #[cold]
    pub fn draw_large<W: Word>(
        &self,
        image: &mut Image,
        cells: Option<(&Cells, u32)>,
        rows: &mut Rows<W>,
        sign: i64,
    ) {
        let (radius, center) = (image.radius as i64, image.center.map(i64::from));
        let first = (center[1] - radius.abs()) >> POSITION_BITS;
        let last = (center[1] + radius.abs()) >> POSITION_BITS;
        // The runs of a row with their transmission.
        let runs_of = |row: i64| {
            let v = (center[1] - ((row << POSITION_BITS) + PIXEL as i64 / 2)) as f64 / radius as f64;
            let runs = self.stencils.shape.row_at(v).iter().map(move |run| {
                let [a, b] = [run.start, run.end].map(|u| center[0] + (u * radius as f64).round() as i64);
                ([a.min(b), a.max(b)], run.transmission)
            });
            ((v * ONE as f64) as i32, runs)
        };
        // Light a pixel, for a transmission of 1: of the rows as they are asked, while these are few.
        let area = if last - first <= MOST_ROWS {
            let mut area = 0.0;
            for row in first..=last {
                let (v, runs) = runs_of(row);
                for (span, transmission) in runs {
                    let mut add = |start: i64, end: i64, weight: i64| {
                        area += (end - start) as f64 * weight as f64 * transmission;
                    };
                    match cells {
                        None => add(span[0], span[1], ONE as i64),
                        Some((cells, _)) => self.seen_runs(image, cells, row as i32, v, span, add),
                    }
                }
            }
            image.share = cells.map_or(image.share, |(_, share)| share as i64);
            area / (ONE as f64 * PIXEL as f64)
        } else {
            (radius as f64 / PIXEL as f64).powi(2) * self.stencils.shape.open_area
        };
        let height = (1u64 << LARGE_HEIGHT_BITS) as f64 / area.max(1.0);
        for row in first.max(rows.first as i64)..=last.min(rows.end as i64 - 1) {
            let (v, runs) = runs_of(row);
            for (span, transmission) in runs {
                let height = (height * transmission) as i64;
                match cells {
                    None => {
                        let value = image.value(height, LARGE_HEIGHT_BITS, row as i32);
                        let [start, end] = span.map(|x| rows.clamped(x));
                        rows.add_run(row as i32, start, end, value, sign);
                    }
                    Some((cells, _)) => {
                        let height = (height, LARGE_HEIGHT_BITS);
                        self.add_seen(image, cells, row as i32, v, span, height, rows, sign);
                    }
                }
            }
        }
    }
}
