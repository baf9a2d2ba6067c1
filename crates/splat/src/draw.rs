//! Drawing a node: the aperture's image, thrown by its footprint.
//!
//! Everything here is integer arithmetic, so that any machine draws the same bits. A node far out of focus is a stencil of
//! the aperture on its level, one nearly in focus a box of the same mean and variance. Levels blur what is drawn on them
//! (a pixel's box, and the upsampling), and a footprint is itself a blur; stencils are made smaller or larger so that the
//! variance on the picture is that of footprint and aperture together.

use crate::canvas::{Canvas, Rows, Word};
use crate::lens_in_use::Placed;
use crate::nodes::{Cells, Light, Nodes, ONE, SplatNode};
use crate::seen::Seen;
use crate::stencil::{HEIGHT_BITS, LARGEST_RADIUS_PX, POSITION_BITS, StencilRun, Stencils};

/// Aperture images of a smaller standard deviation, px, are boxes.
const BOX_DEVIATION_PX: f64 = 0.75;

/// Bits behind the point of the heights of large images.
const LARGE_HEIGHT_BITS: u32 = 36;

/// What nodes are drawn with.
pub struct Pen<'a> {
    pub nodes: &'a Nodes,
    pub stencils: &'a Stencils,
    pub seen: &'a [Seen],
    /// The lens's aperture radius as a share of the baked one, in 1/16384.
    pub stop: i32,
    variance: [i64; 2],
    /// By what the tilt over the baked aperture moves the mean aperture point of the lens.
    tilt_shift: [i64; 2],
    mean: [i64; 2],
    /// What levels blur too much, as squares of a stencil's radius: by level, (1/256 px of the level)².
    too_blurred: [i64; salf::tree::LEVELS],
    /// 16384 over the mean variance.
    per_variance: i64,
    /// Aperture images of a smaller radius, 1/256 px, are boxes.
    box_radius: i64,
}

/// A node's image on its level: centre and signed radius, 1/256 px of the level.
struct Image<'a> {
    node: &'a SplatNode,
    center: [i32; 2],
    radius: i32,
    light: Light,
    /// Where its dither starts.
    dither: u32,
}

impl<'a> Pen<'a> {
    pub fn new(nodes: &'a Nodes, stencils: &'a Stencils, seen: &'a [Seen], stop: f64) -> Self {
        let shape = &stencils.shape;
        let variance = (shape.variance.x + shape.variance.y) / 2.0;
        let fixed = |x: f64| (x * ONE as f64).round() as i64;
        // On level ℓ the picture gets the variance σ²r'² + (4^ℓ/3 − 1/4) px² and should get σ²r² + footprint + 1/12.
        let too_blurred = std::array::from_fn(|level| {
            let side_squared = 4f64.powi(level as i32);
            ((1.0 / 3.0 - 1.0 / (3.0 * side_squared)) / variance * 65536.0).round() as i64
        });
        Self {
            nodes,
            stencils,
            seen,
            stop: fixed(stop) as i32,
            variance: shape.variance.to_array().map(fixed),
            tilt_shift: (shape.variance * stop).to_array().map(fixed),
            mean: shape.mean.to_array().map(fixed),
            too_blurred,
            per_variance: (ONE as f64 / variance).round() as i64,
            box_radius: (BOX_DEVIATION_PX / variance.sqrt() * 256.0).ceil() as i64,
        }
    }

    /// Adds (`sign` 1) a node's `light` (see [`SplatNode::light`]) to a sum, or takes it away (−1).
    #[inline(always)]
    pub fn draw<W: Word>(
        &self,
        index: u32,
        light: [f32; 4],
        placed: Placed,
        canvas: &mut Canvas<W>,
        sign: i64,
    ) {
        let node = &self.nodes.nodes[index as usize];
        let rows = &mut canvas.levels[node.level as usize];
        let mut image = Image {
            node,
            center: [node.center[0] >> node.level, node.center[1] >> node.level],
            radius: placed.radius / (1 << node.level),
            light: [light[0] as i64, light[1] as i64, light[2] as i64, light[3] as i64],
            dither: seed(node, self.nodes.middle),
        };
        let is_small = node.level == 0 && (placed.radius.abs() as i64) < self.box_radius;
        match self.nodes.cells(node) {
            None => {
                let moved = |k: usize| (node.tilt[k] as i64 * self.tilt_shift[k]) >> 14;
                image.shift([moved(0), moved(1)]);
                if is_small {
                    image.shift(self.mean);
                    self.draw_box(&image, rows, sign);
                } else {
                    self.draw_image(&image, None, rows, sign);
                }
            }
            Some(cells) if !is_small => self.draw_image(&image, Some(cells), rows, sign),
            Some(_) => {
                let seen = &self.seen[index as usize];
                image.shift([seen.mean[0] as i64, seen.mean[1] as i64]);
                for value in &mut image.light {
                    *value = (*value * seen.share as i64) >> 16;
                }
                self.draw_box(&image, rows, sign);
            }
        }
    }

    /// The rows of a picture of `height` rows that a node's light may reach.
    pub fn rows(&self, index: u32, placed: Placed, height: u32) -> std::ops::Range<u32> {
        let node = &self.nodes.nodes[index as usize];
        let center = (node.center[1] >> POSITION_BITS) as i64;
        let reach = (placed.radius.unsigned_abs() as i64 >> POSITION_BITS) * 65 / 64
            + (node.half_size[1] as i64 >> (POSITION_BITS - 1))
            + (4 << node.level);
        let row = |row: i64| row.clamp(0, height as i64) as u32;
        row(center - reach)..row(center + reach + 1)
    }

    /// A box of the mean and variance of footprint and aperture.
    #[inline(always)]
    fn draw_box<W: Word>(&self, image: &Image, rows: &mut Rows<W>, sign: i64) {
        let square = image.radius as i64 * image.radius as i64;
        let widened = |k: usize| {
            let half = image.node.half_size[k] as i64;
            integer_sqrt(half * half + ((3 * square * self.variance[k]) >> 14)) as i32
        };
        let half = [widened(0), widened(1)];
        let [top, bottom] = [image.center[1] - half[1], image.center[1] + half[1]];
        let (first, last) = ((top >> 8).max(rows.first), ((bottom - 1) >> 8).min(rows.end - 1));
        if first > last {
            return;
        }
        let density = (1i64 << 44) / (4 * half[0] as i64 * half[1] as i64);
        for row in first..=last {
            let overlap = (bottom.min((row + 1) << 8) - top.max(row << 8)) as i64;
            let height = (overlap * density) >> 12;
            let value = image.value(height, HEIGHT_BITS, row);
            rows.add_run(row, image.center[0] - half[0], image.center[0] + half[0], value, sign);
        }
    }

    /// The aperture's image, or what `cells` let through of it.
    #[inline(always)]
    fn draw_image<W: Word>(&self, image: &Image, cells: Option<&Cells>, rows: &mut Rows<W>, sign: i64) {
        let radius = self.blurred_radius(image);
        if radius.unsigned_abs() > (LARGEST_RADIUS_PX as u32) << POSITION_BITS {
            return self.draw_large(image, cells, rows, sign);
        }
        let (stencil, base) = self.stencils.at(radius, image.center[1]);
        let row_of = |run: Option<&StencilRun>| run.map_or(0, |run| base + run.row);
        if row_of(stencil.runs.last()) < rows.first || row_of(stencil.runs.first()) >= rows.end {
            return;
        }
        for run in &stencil.runs {
            let row = base + run.row;
            if row < rows.first || row >= rows.end {
                continue;
            }
            let span = [image.center[0] + run.start, image.center[0] + run.end];
            let value = image.value(run.height as i64, stencil.height_bits, row);
            match cells {
                None => rows.add_run(row, span[0], span[1], value, sign),
                Some(cells) => self.add_seen(
                    image,
                    cells,
                    row,
                    run.v,
                    [span[0] as i64, span[1] as i64],
                    value,
                    rows,
                    sign,
                ),
            }
        }
    }

    /// An image too large for a stencil: each pixel row is looked up in the shape.
    #[cold]
    fn draw_large<W: Word>(&self, image: &Image, cells: Option<&Cells>, rows: &mut Rows<W>, sign: i64) {
        let radius = image.radius as i64;
        let reach = radius.abs();
        let center = image.center.map(i64::from);
        let first = ((center[1] - reach) >> 8).max(rows.first as i64);
        let last = ((center[1] + reach) >> 8).min(rows.end as i64 - 1);
        // Times 2^36, for a run of transmission 1.
        let square_px = (radius as f64 / 256.0).powi(2) * self.stencils.shape.open_area;
        let height = (1u64 << LARGE_HEIGHT_BITS) as f64 / square_px;
        for row in first..=last {
            let v = (center[1] - ((row << 8) + 128)) as f64 / radius as f64;
            for run in self.stencils.shape.row_at(v) {
                let [a, b] = [run.start, run.end].map(|u| center[0] + (u * radius as f64).round() as i64);
                let span = [a.min(b), a.max(b)];
                let value = image.value((height * run.transmission) as i64, LARGE_HEIGHT_BITS, row as i32);
                let v = (v * ONE as f64) as i32;
                match cells {
                    None => {
                        let [start, end] = span.map(|x| rows.clamped(x));
                        rows.add_run(row as i32, start, end, value, sign);
                    }
                    Some(cells) => self.add_seen(image, cells, row as i32, v, span, value, rows, sign),
                }
            }
        }
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

    /// Adds the parts of a row's span that `cells` let through.
    #[allow(clippy::too_many_arguments)]
    #[inline(always)]
    fn add_seen<W: Word>(
        &self,
        image: &Image,
        cells: &Cells,
        row: i32,
        v: i32,
        span: [i64; 2],
        value: Light,
        rows: &mut Rows<W>,
        sign: i64,
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
        let reach = ((image.radius.unsigned_abs() as i64) << 14) / self.stop.max(1) as i64;
        let edge = |cell: i64| image.center[0] as i64 + ((reach * (cell - 8)) >> 3);
        let tilt = [image.node.tilt[0] as i64, image.node.tilt[1] as i64];
        let base = image.node.base as i64 + ((tilt[1] * of_baked) >> 14);
        while bits != 0 {
            let start = bits.trailing_zeros();
            let length = (bits >> start).trailing_ones();
            bits &= !(((1u32 << length) - 1) << start);
            let [from, to] = [start as i64, (start + length) as i64];
            let (from_x, to_x) = (edge(from).max(span[0]), edge(to).min(span[1]));
            if from_x >= to_x {
                continue;
            }
            let value = if tilt == [0, 0] && image.node.base == ONE as i16 {
                value
            } else {
                let middle = (from + to - 16) << 10;
                let middle = if image.radius < 0 { -middle } else { middle };
                let weight = (base + ((tilt[0] * middle) >> 14)).max(0);
                let mut weighted = value;
                for value in &mut weighted {
                    *value = (*value * weight) >> 14;
                }
                weighted
            };
            rows.add_run(row, rows.clamped(from_x), rows.clamped(to_x), value, sign);
        }
    }
}

impl Image<'_> {
    /// Moves the centre to that of the light whose mean aperture point is `mean` (1/16384).
    #[inline(always)]
    fn shift(&mut self, mean: [i64; 2]) {
        let radius = self.radius as i64;
        let (x, y) = ((radius * mean[0]) >> 14, (radius * mean[1]) >> 14);
        // Pixel rows go down, v goes up.
        self.center = [self.center[0].saturating_add(x as i32), self.center[1].saturating_sub(y as i32)];
    }

    /// The light of a pixel, rounded up or down at random so that the mean is kept.
    #[inline(always)]
    fn value(&self, height: i64, bits: u32, row: i32) -> Light {
        // By the row from the centre's, so that a frame's crop has the same bits.
        let row = (row - (self.center[1] >> POSITION_BITS)) as u32;
        let dither = self.dither.wrapping_add(row.wrapping_mul(0x9E37_79B1));
        let dither = (dither ^ dither >> 15).wrapping_mul(0x2C1B_3C6D) as i64 >> (32 - HEIGHT_BITS);
        let dither = dither << (bits - HEIGHT_BITS);
        let mut value = [0; 4];
        for c in 0..4 {
            value[c] = (self.light[c] * height + dither) >> bits;
        }
        value
    }
}

/// Where a node's dither starts: its place from the picture's middle, whatever else is in the light field.
#[inline(always)]
fn seed(node: &SplatNode, middle: [i32; 2]) -> u32 {
    let [x, y] = [(node.center[0] - middle[0]) as u32, (node.center[1] - middle[1]) as u32];
    (x.wrapping_mul(0x9E37_79B1) ^ y.wrapping_mul(0x85EB_CA77) ^ node.level as u32).wrapping_mul(0xC2B2_AE3D)
}

/// ⌊√x⌋ for 0 ≤ x < 2⁵².
#[inline(always)]
fn integer_sqrt(x: i64) -> i64 {
    (x as f64).sqrt() as i64
}
