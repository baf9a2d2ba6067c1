//! Images as stencils.

use crate::aperture::stencil::{HEIGHT_BITS, Stencil, StencilSize};
use crate::canvas::{PIXEL, POSITION_BITS, Word};
use crate::draw::image::Image;
use crate::draw::paper::Paper;
use crate::draw::pen::Pen;
use crate::draw::visible_runs::{Row, VisibleRun, VisibleRuns};
use crate::fixed::{ONE, mul_shift, ratio};
use crate::nodes::Cells;
use numerics::with_widest_simd;

/// What is let through of a stencil is scaled by this at most.
pub const LARGEST_SCALE: u32 = 4;

impl Pen<'_> {
    /// The aperture's image, or what `cells` let through of it: then of the light `share` (times 2²⁴) in all.
    #[inline(always)]
    pub fn draw_image<W: Word>(
        &self,
        image: &mut Image,
        cells: Option<(&Cells, u32)>,
        paper: &mut Paper<W>,
        sign: i32,
    ) {
        let Some(size) = self.stencil_size_of(image) else {
            return self.draw_large(image, cells, None, &mut paper.rows, sign);
        };
        let mut rows = paper.rows.borrowed();
        // Most images that miss these rows are rejected before their stencil is fetched.
        let reach = image.radius.abs() + image.radius.abs() / 2 + 2 * PIXEL;
        if (image.center[1] + reach) >> POSITION_BITS < rows.first
            || (image.center[1] - reach) >> POSITION_BITS >= rows.end
        {
            return;
        }
        let (stencil, base) = self.stencils.stencil_at(size, image.center[1]);
        let shift = image.light.shift(stencil.height_bits);
        let Some((cells, share)) = cells else {
            for run in &stencil.runs {
                let row = base + run.row;
                if row >= rows.first && row < rows.end {
                    let [start, end] = [image.center[0] + run.start, image.center[0] + run.end];
                    rows.add_run(row, start, end, image.value(run.height, shift, row), sign);
                }
            }
            return;
        };
        // Each in a function of its own: 2 to 3 % off a picture that has many of either.
        let visible = if self.takes_all_rows(image) {
            with_widest_simd(
                #[inline(always)]
                || self.visible_runs::<true>(image, cells, share, stencil, base, &mut paper.runs),
            )
        } else {
            self.visible_runs::<false>(image, cells, share, stencil, base, &mut paper.runs)
        };
        let Some((scale, runs)) = visible else {
            return self.draw_partial_box(image, paper, sign);
        };
        image.share = scale;
        let mut rows = paper.rows.borrowed();
        for run in runs {
            if run.row >= rows.first && run.row < rows.end {
                let value = image.value(run.height, shift, run.row);
                rows.add_run(run.row, run.start, run.end, value, sign);
            }
        }
    }

    /// Finds what `cells` let through of a stencil, with `room` to keep it in, and what it is to be scaled by (times 2²⁴) so that
    /// it is `share` (times 2²⁴) of the light: rows of pixels and rows of cells meet only roughly. `None` where a partly occluded
    /// node's few cells are missed.
    #[inline(always)]
    pub(super) fn visible_runs<'r, const TAKES_ALL: bool>(
        &self,
        image: &Image,
        cells: &Cells,
        share: u32,
        stencil: &Stencil,
        base: i32,
        buffer: &'r mut Vec<VisibleRun>,
    ) -> Option<(u32, &'r [VisibleRun])> {
        // Heights are as much finer as the stencil is larger.
        let finer = POSITION_BITS + stencil.height_bits - HEIGHT_BITS;
        let row_runs = VisibleRuns::new(self, image);
        let max_runs = stencil.runs.len() * row_runs.max_runs_of_row::<TAKES_ALL>();
        if buffer.len() < max_runs {
            buffer.resize(max_runs, VisibleRun::default());
        }
        let (buffer, mut count, mut passing) = (&mut buffer[..max_runs], 0, 0);
        for run in &stencil.runs {
            let row = Row { row: base + run.row, v: run.v };
            let span = [image.center[0] + run.start, image.center[0] + run.end];
            row_runs.visit_row::<TAKES_ALL>(cells, row, span, |start, end, weight| {
                let height =
                    if weight == ONE { run.height } else { mul_shift(run.height, weight as u32, 14) };
                passing += mul_shift(end.wrapping_sub(start) as u32, height, finer);
                buffer[count] = VisibleRun { row: row.row, start, end, height };
                count += 1;
            });
        }
        let is_missed = !image.node.is_open() && passing < share / LARGEST_SCALE;
        (!is_missed).then(|| (ratio(share, passing, LARGEST_SCALE), &buffer[..count]))
    }

    /// The size of the stencil that, blurred by its level, has the variance of the footprint and the aperture's image;
    /// none where that is too large for a stencil.
    #[inline(always)]
    pub fn stencil_size_of(&self, image: &Image) -> Option<StencilSize> {
        let [x, y] = image.node.half_size.map(i64::from);
        // A box of half side h has the variance h²/3.
        let footprint = ((x * x + y * y) >> (2 * image.level + 1)) * self.per_variance / (3 * ONE as i64);
        let radius = image.radius as i64;
        let square = radius * radius + footprint - self.too_blurred[image.level as usize];
        StencilSize::from_radius_square(square, image.radius < 0)
    }
}
