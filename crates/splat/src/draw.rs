//! Drawing a node: the aperture's image, thrown by its footprint.
//!
//! Everything here is integer arithmetic, so that any machine draws the same bits. A node far out of focus is a stencil of
//! the aperture on its level, one nearly in focus a box of the same mean and variance. Levels blur what is drawn on them
//! (a pixel's box, and the upsampling), and a footprint is itself a blur; stencils are made smaller or larger so that the
//! variance on the picture is that of footprint and aperture together.

mod boxes;
mod image;
mod large;
mod seen_runs;
mod stencilled;

pub use image::WHOLE;

use crate::canvas::{Canvas, PIXEL, POSITION_BITS, Rows, Word};
use crate::lens_in_use::Placed;
use crate::nodes::{Cells, Nodes, ONE, SplatNode};
use crate::seen::Seen;
use crate::stencil::Stencils;
use boxes::BoxPart;
use image::{Image, seed};

/// Aperture images of a smaller standard deviation, px, are boxes.
const BOX_DEVIATION_PX: f64 = 0.75;

/// Smaller changes of a node's weight over the aperture, as a share of it in 1/16384, only move its image.
const EVEN: i64 = ONE as i64 / 40;

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

/// What a node sees that sees all.
const ALL: Cells = [u16::MAX; 16];

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
}
