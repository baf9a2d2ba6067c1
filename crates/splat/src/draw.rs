//! Drawing a node: the aperture's image, thrown by its footprint.
//!
//! Everything here is integer arithmetic, so that any machine draws the same bits. A node far out of focus is a stencil of
//! the aperture on its level, one nearly in focus a box of the same mean and variance. Levels blur what is drawn on them
//! (a pixel's box, and the upsampling), and a footprint is itself a blur; stencils are made smaller or larger so that the
//! variance on the picture is that of footprint and aperture together.

use crate::canvas::{Canvas, PIXEL, POSITION_BITS, Rows, Word};
use crate::lens_in_use::Placed;
use crate::nodes::{Cells, Light, Nodes, ONE, SplatNode};
use crate::seen::Seen;
use crate::stencil::{HEIGHT_BITS, LARGEST_RADIUS_PX, Stencil, StencilRun, Stencils};

/// Aperture images of a smaller standard deviation, px, are boxes.
const BOX_DEVIATION_PX: f64 = 0.75;

/// Smaller changes of a node's weight over the aperture, as a share of it in 1/16384, only move its image.
const EVEN: i64 = ONE as i64 / 40;

/// The parts of a run whose weight changes along it, by that change.
fn parts_of(tilt: i64) -> i64 {
    match tilt.abs() {
        tilt if tilt < ONE as i64 / 10 => 1,
        tilt if tilt < ONE as i64 / 3 => 2,
        _ => 4,
    }
}

/// Half the longest side of a stretched footprint, 1/4096 px.
const LARGEST_HALF: i64 = 10 << POSITION_BITS;

/// The light of larger images, in pixel rows, is what their area says; that of smaller ones what their rows say.
const MOST_ROWS: i64 = 1 << 12;

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
    /// What levels blur too much, as squares of a stencil's radius: by level, (1/4096 px of the level)².
    too_blurred: [i64; salf::tree::LEVELS],
    /// 16384 over the mean variance.
    per_variance: i64,
    /// Aperture images of a smaller radius, 1/4096 px, are boxes.
    box_radius: i64,
    /// Parts of the aperture whose images are boxes.
    parts: Vec<BoxPart>,
    /// From which |radius| on, 1/4096 px, stencils follow boxes, and to which they mix.
    stencil_radius: i64,
}

/// A part of the aperture: its share times 2²⁴, mean and variance times 16384.
#[derive(Clone, Copy)]
struct BoxPart {
    share: i64,
    mean: [i64; 2],
    variance: [i64; 2],
}

/// All of the light, as a share.
pub const WHOLE: i64 = 1 << 24;

/// What a node sees that sees all.
const ALL: Cells = [u16::MAX; 16];

/// A node's image on its level: centre and signed radius, 1/4096 px of the level.
struct Image<'a> {
    node: &'a SplatNode,
    center: [i32; 2],
    radius: i32,
    light: Light,
    /// How much of the light is drawn, times 2²⁴.
    share: i64,
    /// Where its dither starts.
    dither: u32,
}

impl<'a> Pen<'a> {
    pub fn new(
        nodes: &'a Nodes,
        stencils: &'a Stencils,
        seen: &'a [Seen],
        stop: f64,
        is_exact: bool,
    ) -> Self {
        let shape = &stencils.shape;
        let variance = (shape.variance.x + shape.variance.y) / 2.0;
        let fixed = |x: f64| (x * ONE as f64).round() as i64;
        // On level ℓ the picture gets the variance σ²r'² + (4^ℓ/3 − 1/4) px² and should get σ²r² + footprint + 1/12.
        let too_blurred = std::array::from_fn(|level| {
            let side_squared = 4f64.powi(level as i32);
            ((1.0 / 3.0 - 1.0 / (3.0 * side_squared)) / variance * (PIXEL as f64).powi(2)).round() as i64
        });
        let parts = stencils.parts[usize::from(is_exact)].iter().map(|part| BoxPart {
            share: (part.share * WHOLE as f64).round() as i64,
            mean: part.mean.to_array().map(fixed),
            variance: part.variance.to_array().map(fixed),
        });
        let deviations =
            |factor: f64| (factor * BOX_DEVIATION_PX / variance.sqrt() * PIXEL as f64).ceil() as i64;
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
            parts: parts.collect(),
            stencil_radius: deviations(if is_exact { 2.0 } else { 1.0 }),
            box_radius: deviations(1.0),
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
        if placed.is_split {
            return self.draw_split(index, light, placed, canvas, sign);
        }
        let rows = &mut canvas.levels[node.level as usize];
        self.draw_whole(index, node, light, placed, rows, sign);
    }

    /// A sample of a large cell, as samples of a pixel each.
    #[cold]
    fn draw_split<W: Word>(
        &self,
        index: u32,
        light: [f32; 4],
        placed: Placed,
        canvas: &mut Canvas<W>,
        sign: i64,
    ) {
        let node = &self.nodes.nodes[index as usize];
        let count = 1 << node.level;
        let half_size = [node.half_size[0] >> node.level, node.half_size[1] >> node.level]
            .map(|half| half.max(PIXEL as u16 / 32));
        let offset = |k: i32, axis: usize| (2 * k + 1 - count) * half_size[axis] as i32;
        for (y, x) in (0..count * count).map(|k| (k / count, k % count)) {
            let center = [node.center[0] + offset(x, 0), node.center[1] + offset(y, 1)];
            let part = SplatNode { center, half_size, level: 0, ..*node };
            self.draw_whole(index, &part, light, placed, &mut canvas.levels[0], sign);
        }
    }

    #[inline(always)]
    fn draw_whole<W: Word>(
        &self,
        index: u32,
        node: &SplatNode,
        light: [f32; 4],
        placed: Placed,
        rows: &mut Rows<W>,
        sign: i64,
    ) {
        let mut image = Image {
            node,
            center: [node.center[0] >> node.level, node.center[1] >> node.level],
            radius: placed.radius / (1 << node.level),
            light: [light[0] as i64, light[1] as i64, light[2] as i64, light[3] as i64],
            share: WHOLE,
            dither: seed(node, self.nodes.middle),
        };
        let tilt = node.tilt[0].abs() as i64 + node.tilt[1].abs() as i64;
        let is_even = tilt < EVEN;
        let radius = placed.radius.unsigned_abs() as i64;
        match self.nodes.cells(node) {
            None => {
                let far = if node.level > 0 { 1 << 16 } else { self.part_of_stencil(radius) };
                if far == 0 && is_even && radius < self.box_radius / 2 {
                    image.lean(node, self.tilt_shift);
                    image.shift(self.mean);
                    return self.draw_box(&image, node.half_size, self.variance, rows, sign);
                }
                if far < 1 << 16 {
                    let near = Image { share: WHOLE - (far << 8), ..image };
                    self.draw_parts(&near, placed.depth_share, rows, sign);
                }
                image.share = far << 8;
                if far > 0 && is_even {
                    image.lean(node, self.tilt_shift);
                    self.draw_image(&mut image, None, rows, sign);
                } else if far > 0 {
                    let lean = node.tilt[0] as i64 * self.mean[0] + node.tilt[1] as i64 * self.mean[1];
                    let share = ((far << 8) * (((node.base as i64) << 14) + lean)) >> 28;
                    self.draw_image(&mut image, Some((&ALL, share as u32)), rows, sign);
                }
            }
            Some(cells) if node.level > 0 || radius >= self.box_radius => {
                let share = self.seen[index as usize].share;
                self.draw_image(&mut image, Some((cells, share)), rows, sign);
            }
            Some(_) => {
                let seen = &self.seen[index as usize];
                image.shift([seen.mean[0] as i64, seen.mean[1] as i64]);
                image.share = seen.share as i64;
                self.draw_box(&image, node.half_size, self.variance, rows, sign);
            }
        }
    }

    /// How much of a node's light is drawn as a stencil, times 65536; the rest is boxes. Where one form follows the
    /// other on a surface they mix, for they differ a little.
    #[inline(always)]
    fn part_of_stencil(&self, radius: i64) -> i64 {
        let part = (((radius - self.stencil_radius) << 16) / self.stencil_radius).clamp(0, 1 << 16);
        // Smoothly, or the coverage would show where it begins.
        (((part * part) >> 16) * ((3 << 16) - 2 * part)) >> 16
    }

    /// The boxes of the aperture's parts, each with the node's weight toward it.
    ///
    /// Across a slanted surface the radius r changes, and neighbours move apart or together by 1 + u·∂r/∂x; the footprint
    /// is stretched as much, so that they still meet. For an unpainted surface ∂r/∂x is its weight's relative tilt.
    #[inline(always)]
    fn draw_parts<W: Word>(&self, image: &Image, depth_share: i32, rows: &mut Rows<W>, sign: i64) {
        let node = image.node;
        let tilt = [0, 1].map(|k| (node.tilt[k] as i64 * self.stop as i64) >> 14);
        for (index, part_of) in self.parts.iter().enumerate() {
            let weight = node.base as i64 + ((tilt[0] * part_of.mean[0] + tilt[1] * part_of.mean[1]) >> 14);
            if weight <= 0 {
                continue;
            }
            let exact =
                ((node.base as i64) << 10) + ((tilt[0] * part_of.mean[0] + tilt[1] * part_of.mean[1]) >> 4);
            let share = (((image.share * part_of.share) >> 24) * exact) >> 24;
            let mut part = Image { share, dither: image.dither.wrapping_add(index as u32), ..*image };
            // Within the part the light leans toward where the weight is.
            let lean = |k: usize| part_of.mean[k] + tilt[k] * part_of.variance[k] / weight;
            part.shift([lean(0), lean(1)]);
            let stretched = |k: usize| {
                let slope = (tilt[k] * depth_share as i64) >> 14;
                let factor = (ONE as i64 + ((slope * part_of.mean[k]) >> 14)).abs().max(ONE as i64 / 16);
                ((node.half_size[k] as i64 * factor) >> 14).min(LARGEST_HALF) as u16
            };
            self.draw_box(&part, [stretched(0), stretched(1)], part_of.variance, rows, sign);
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

    /// A box of the variance of footprint and aperture together.
    #[inline(always)]
    fn draw_box<W: Word>(
        &self,
        image: &Image,
        half_size: [u16; 2],
        variance: [i64; 2],
        rows: &mut Rows<W>,
        sign: i64,
    ) {
        let square = image.radius as i64 * image.radius as i64;
        let widened = |k: usize| {
            let half = half_size[k] as i64;
            integer_sqrt(half * half + ((3 * square * variance[k]) >> 14)).max(PIXEL as i64 / 32) as i32
        };
        let half = [widened(0), widened(1)];
        let [top, bottom] = [image.center[1] - half[1], image.center[1] + half[1]];
        let first = (top >> POSITION_BITS).max(rows.first);
        let last = ((bottom - 1) >> POSITION_BITS).min(rows.end - 1);
        if first > last {
            return;
        }
        let density = (1i64 << 52) / (4 * half[0] as i64 * half[1] as i64);
        for row in first..=last {
            let overlap = (bottom.min((row + 1) << POSITION_BITS) - top.max(row << POSITION_BITS)) as i64;
            let height = (overlap * density) >> 16;
            let value = image.value(height, HEIGHT_BITS, row);
            rows.add_run(row, image.center[0] - half[0], image.center[0] + half[0], value, sign);
        }
    }

    /// The aperture's image, or what `cells` let through of it: then of the light `share` (times 2²⁴) in all.
    #[inline(always)]
    fn draw_image<W: Word>(
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

    /// An image too large for a stencil: each pixel row is looked up in the shape.
    #[cold]
    fn draw_large<W: Word>(
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

    /// Adds the parts of a row's span that `cells` let through, of a `height` with so many bits behind the point.
    #[allow(clippy::too_many_arguments)]
    #[inline(always)]
    fn add_seen<W: Word>(
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
    fn seen_runs(
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

impl Image<'_> {
    /// Moves the centre by what the node's tilt moves its light's mean aperture point.
    #[inline(always)]
    fn lean(&mut self, node: &SplatNode, tilt_shift: [i64; 2]) {
        let moved = |k: usize| (node.tilt[k] as i64 * tilt_shift[k]) >> 14;
        self.shift([moved(0), moved(1)]);
    }

    /// Moves the centre to that of the light whose mean aperture point is `mean` (1/16384).
    #[inline(always)]
    fn shift(&mut self, mean: [i64; 2]) {
        let radius = self.radius as i64;
        // Rounded alike for either sign.
        let (x, y) = (radius * mean[0] / ONE as i64, radius * mean[1] / ONE as i64);
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
        let height = (height * self.share) >> 24;
        let mut value = self.light;
        for light in &mut value {
            *light = (*light * height + dither) >> bits;
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
