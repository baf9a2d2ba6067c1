//! Images as stencils.

use crate::canvas::{POSITION_BITS, Rows, Word};
use crate::draw::Pen;
use crate::draw::boxes::integer_sqrt;
use crate::draw::image::{Image, WHOLE};
use crate::nodes::{Cells, ONE};
use crate::stencil::{LARGEST_RADIUS_PX, Stencil, StencilRun};

impl Pen<'_> {
    /// The aperture's image, or what `cells` let through of it: then of the light `share` (times 2²⁴) in all.
    #[inline(always)]
    pub fn draw_image<W: Word>(
        &self,
        image: &mut Image,
        cells: Option<(&Cells, u32)>,
        rows: &mut Rows<W>,
        sign: i64,
    ) {
        let radius = self.blurred_radius(image);
        if radius.unsigned_abs() > (LARGEST_RADIUS_PX as u32) << POSITION_BITS {
            return self.draw_large(image, cells, rows, sign);
        }
        let (stencil, base) = self.stencils.at(radius, image.center[1]);
        let row_of = |run: Option<&StencilRun>| run.map_or(0, |run| base + run.row);
        if row_of(stencil.runs.last()) < rows.first || row_of(stencil.runs.first()) >= rows.end {
            return;
        }
        if let Some((cells, share)) = cells {
            self.scale_to_share(image, cells, share, stencil, base);
        }
        for run in &stencil.runs {
            let row = base + run.row;
            if row < rows.first || row >= rows.end {
                continue;
            }
            let span = [image.center[0] + run.start, image.center[0] + run.end];
            let height = run.height as i64;
            match cells {
                None => {
                    let value = image.value(height, stencil.height_bits, row);
                    rows.add_run(row, span[0], span[1], value, sign);
                }
                Some((cells, _)) => {
                    let span = [span[0] as i64, span[1] as i64];
                    let height = (height, stencil.height_bits);
                    self.add_seen(image, cells, row, run.v, span, height, rows, sign);
                }
            }
        }
    }

    /// Scales the light so that what `cells` let through of a stencil is `share` (times 2²⁴) of it: rows of pixels and rows
    /// of cells meet only roughly.
    #[inline(always)]
    fn scale_to_share(&self, image: &mut Image, cells: &Cells, share: u32, stencil: &Stencil, base: i32) {
        const LARGEST: i64 = 4 * WHOLE;
        let mut passing = 0;
        for run in &stencil.runs {
            let span = [image.center[0] + run.start, image.center[0] + run.end].map(i64::from);
            self.seen_runs(image, cells, base + run.row, run.v, span, |start, end, weight| {
                passing += ((((end - start) * run.height as i64) >> POSITION_BITS) * weight) >> 14;
            });
        }
        // `passing` is times 2 to the stencil's height bits.
        let scale = ((share as i64) << (stencil.height_bits - 4)) / (passing >> 4).max(1);
        image.share = scale.min(LARGEST);
    }

    /// The radius of the stencil that, blurred by its level, has the variance of the footprint and the aperture's image.
    #[inline(always)]
    fn blurred_radius(&self, image: &Image) -> i32 {
        let (x, y) = (image.node.half_size[0] as i64, image.node.half_size[1] as i64);
        // A box of half side h has the variance h²/3.
        let footprint =
            ((x * x + y * y) >> (2 * image.node.level + 1)) * self.per_variance / (3 * ONE as i64);
        let radius = image.radius as i64;
        let square = radius * radius + footprint - self.too_blurred[image.node.level as usize];
        let blurred = integer_sqrt(square.max(1)) as i32;
        if radius < 0 { -blurred } else { blurred }
    }
}
