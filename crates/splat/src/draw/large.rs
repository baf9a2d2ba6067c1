//! Images too large for stencils.

use crate::aperture::stencil::HEIGHT_BITS;
use crate::canvas::{PIXEL, POSITION_BITS, Rows, Word};
use crate::character::node_shape::NodeShape;
use crate::draw::image::Image;
use crate::draw::image_frame::ImageFrame;
use crate::draw::pen::Pen;
use crate::draw::visible_runs::{Row, VisibleRuns};
use crate::fixed::{Divisor, ONE, mul_shift, signed_mul_shift};
use crate::nodes::Cells;

/// The light of images of more rows is distributed by their area; that of smaller ones by their rows.
const MAX_ROWS: i32 = 1 << 12;

/// How much light a large image has in a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Large {
    /// In a pixel where the aperture is clear, times 2 to `height_bits`.
    pub height: u32,
    pub height_bits: u32,
    /// How much of the light is drawn, times 2²⁴.
    pub share: u32,
}

/// The rows of a large image.
struct LargeRows {
    center: [i32; 2],
    radius: i32,
    per_radius: Divisor,
    first: i32,
    last: i32,
}

impl LargeRows {
    #[inline(always)]
    fn new(image: &Image) -> Self {
        let size = image.radius.abs().max(PIXEL);
        Self {
            center: image.center,
            radius: if image.radius < 0 { -size } else { size },
            per_radius: Divisor::new(size as u32),
            first: (image.center[1] - size) >> POSITION_BITS,
            last: (image.center[1] + size) >> POSITION_BITS,
        }
    }

    /// The lens's v at a row's middle, times 16384; pixel rows go down, v goes up.
    #[inline(always)]
    fn v(&self, row: i32) -> i32 {
        let v = self.per_radius.divide(self.center[1].wrapping_sub((row << POSITION_BITS) + PIXEL / 2));
        if self.radius < 0 { -v } else { v }
    }

    /// Where light that crosses the aperture from u to u' (times 2²⁴) lands.
    #[inline(always)]
    fn span(&self, from: i32, to: i32) -> [i32; 2] {
        let [a, b] = [from, to].map(|u| self.center[0] + signed_mul_shift(self.radius, u, 24));
        [a.min(b), a.max(b)]
    }
}

impl Pen<'_> {
    /// How much light an image has in a pixel: `share` in all, of what `cells` let through.
    pub fn large(&self, image: &Image, cells: Option<(&Cells, u32)>) -> Large {
        let (lines, visible) = (LargeRows::new(image), VisibleRuns::new(self, image));
        // Pixels of a transmission of 1: of the rows as they are asked, while these are few.
        let area = if lines.last - lines.first <= MAX_ROWS {
            let mut area = 0.0;
            for row in lines.first..=lines.last {
                let v = lines.v(row);
                for run in self.stencils.shape.runs_at(v) {
                    let mut add = |start: i32, end: i32, weight: i32| {
                        area +=
                            end.wrapping_sub(start) as u32 as f64 * weight as f64 * run.transmission as f64;
                    };
                    let span = lines.span(run.start, run.end);
                    match cells {
                        None => add(span[0], span[1], ONE),
                        Some((cells, _)) => visible.visit_row::<false>(cells, Row { row, v }, span, add),
                    }
                }
            }
            area / (ONE as f64 * PIXEL as f64 * 65536.0)
        } else {
            (lines.radius as f64 / PIXEL as f64).powi(2) * self.stencils.shape.open_area
        };
        let area = area.max(1.0);
        let height_bits = HEIGHT_BITS + area.log2() as u32;
        let share = match cells {
            Some((_, share)) if lines.last - lines.first <= MAX_ROWS => share,
            _ => image.share,
        };
        Large { height: ((1u64 << height_bits) as f64 / area).round() as u32, height_bits, share }
    }

    /// An image too large for a stencil: each pixel row is looked up in the aperture's shape, and cut and weighed by `shape`.
    #[cold]
    pub fn draw_large<W: Word>(
        &self,
        image: &mut Image,
        cells: Option<(&Cells, u32)>,
        shape: Option<&NodeShape>,
        rows: &mut Rows<W>,
        sign: i32,
    ) {
        let large = self.large(image, cells);
        image.share = large.share;
        let shift = image.light.shift(large.height_bits);
        let (lines, visible) = (LargeRows::new(image), VisibleRuns::new(self, image));
        let frame = ImageFrame::new(image, lines.radius);
        for row in lines.first.max(rows.first)..=lines.last.min(rows.end - 1) {
            let v = lines.v(row);
            for run in self.stencils.shape.runs_at(v) {
                let height = mul_shift(large.height, run.transmission, 16);
                let span = lines.span(run.start, run.end);
                let mut add = |start: i32, end: i32, weight: i32| {
                    let height = mul_shift(height, weight as u32, 14);
                    let mut add = |start: i32, end: i32, height: u32| {
                        let value = image.value(height, shift, row);
                        rows.add_run(row, rows.clamped(start), rows.clamped(end), value, sign);
                    };
                    match shape {
                        None => add(start, end, height),
                        Some(shape) => shape.visit_row(frame.row(row, Some(v), [start, end]), |part| {
                            add(part.start, part.end, mul_shift(height, part.weight, 14));
                        }),
                    }
                };
                match cells {
                    None => add(span[0], span[1], ONE),
                    Some((cells, _)) => visible.visit_row::<false>(cells, Row { row, v }, span, add),
                }
            }
        }
    }
}
