//! Matting: pixels at jumps of depth that show both sides, the share of each, and the colours of each.
//!
//! A pixel that an edge passes through shows I = α·F + (1 − α)·B: a share of the foreground and a share of the background. Out of focus
//! the two separate, and a surface of the colour I would have a fringe. F is expected to be as a few pixels further inside, B as other
//! views show it or as a few pixels further outside; α is the most likely one, given the variance of both, and that depth puts the edge
//! between two pixels (0 or 1, give or take rounding). Where F and B are too similar or vary too much, α stays at that. The residual of I
//! is distributed in proportion to the variances (Chuang et al., *A Bayesian approach to digital matting*, 2001), so that the composite
//! is the picture.

use crate::color_stats::{ColorAccumulator, ColorStats, noise_variance, squared_distance};
use crate::mesh::cells::{Grid, Links};
use rayon::prelude::*;

/// From this share on a pixel shows one side only.
const WHOLE: f32 = 0.9;
/// Radius around a pixel in which the colours of its two sides are sampled.
const AROUND: isize = 3;
/// The same where there are none.
const FAR_AROUND: isize = 12;
/// The standard deviation of a share that only depth determines: an edge anywhere within a pixel.
const BY_DEPTH: f32 = 0.3;
/// The number of standard deviations from 0 or 1 that makes a mixture.
const MIN_DEVIATIONS: f32 = 2.0;
/// The least share of the squared distance from the side's colour that a mixture must explain.
const EXPLAINED: f32 = 0.5;

/// A pixel that shows both sides of a jump.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MixedPixel {
    pub cell: usize,
    /// The share of the foreground, in (0, 1).
    pub share: f32,
    /// Whether its depth is that of the background.
    pub is_beyond: bool,
    pub before: ColorStats,
    pub behind: ColorStats,
}

/// Pixels next to jumps, which may show both sides.
pub(crate) fn find_edges(
    grid: Grid,
    disparity: &[f32],
    links: &Links,
    colors: &[[f32; 3]],
    jump: f32,
) -> Vec<MixedPixel> {
    let jumps = Jumps::new(grid, disparity, links, jump);
    let edge_at = |cell: usize| {
        let own = disparity[cell];
        let (levels, is_beyond) = match (jumps.behind[cell], jumps.before[cell]) {
            (Some(behind), _) => ([own, behind], false),
            (None, Some(before)) => ([before, own], true),
            (None, None) => return None,
        };
        let [before, behind] = sides(grid, disparity, colors, &jumps, jump, cell, levels)?;
        Some(MixedPixel { cell, share: f32::from(u8::from(!is_beyond)), is_beyond, before, behind })
    };
    (0..grid.count()).into_par_iter().filter_map(edge_at).collect()
}

/// The edge pixels that do show both sides. Those with the depth of the farther side get that of the nearer one, which they are part of:
/// returns the changed disparities, too.
pub(crate) fn find_mixtures(
    grid: Grid,
    disparity: &[f32],
    links: &Links,
    colors: &[[f32; 3]],
    edges: &[MixedPixel],
    jump: f32,
) -> (Vec<f32>, Vec<MixedPixel>) {
    let mixtures: Vec<MixedPixel> =
        edges.iter().filter_map(|edge| detect_mixture(colors[edge.cell], *edge)).collect();
    let across =
        disparity_across(grid, disparity, links, mixtures.iter().filter(|pixel| pixel.is_beyond), jump);
    (across, mixtures)
}

/// Pixels next to jumps that show only the other side.
pub(crate) fn find_misplaced(
    grid: Grid,
    disparity: &[f32],
    links: &Links,
    colors: &[[f32; 3]],
    jump: f32,
) -> Vec<MixedPixel> {
    let edges = find_edges(grid, disparity, links, colors, jump);
    let is_misplaced = |pixel: &MixedPixel| match pixel.is_beyond {
        true => pixel.share >= WHOLE,
        false => pixel.share <= 1.0 - WHOLE,
    };
    let mixtures = edges.into_iter().filter_map(|edge| detect_mixture(colors[edge.cell], edge));
    mixtures.filter(is_misplaced).collect()
}

/// The disparities where pixels next to jumps have that of the other side.
pub(crate) fn disparity_across<'a>(
    grid: Grid,
    disparity: &[f32],
    links: &Links,
    pixels: impl IntoIterator<Item = &'a MixedPixel>,
    jump: f32,
) -> Vec<f32> {
    let mut across = disparity.to_vec();
    for pixel in pixels {
        let (mut sum, mut count) = (0.0, 0.0);
        for (side, other) in grid.around(pixel.cell) {
            let step = disparity[other] - disparity[pixel.cell];
            if !links.has(pixel.cell, side) && if pixel.is_beyond { step > jump } else { step < -jump } {
                sum += disparity[other];
                count += 1.0;
            }
        }
        if count > 0.0 {
            across[pixel.cell] = sum / count;
        }
    }
    across
}

/// Separates a mixture, now that the background is known: its share, and the colours of both sides, which compose
/// exactly to it.
pub(crate) fn unmix(color: [f32; 3], mixed: &MixedPixel) -> (f32, [[f32; 3]; 2]) {
    let share = estimate_share(color, mixed).0.clamp(MIN_SHARE, 1.0 - MIN_SHARE);
    let (a, b) = (share, 1.0 - share);
    let spread = a * a * mixed.before.variance + b * b * mixed.behind.variance;
    let mut sides = [mixed.before.color, mixed.behind.color];
    for c in 0..3 {
        let left = color[c] - a * sides[0][c] - b * sides[1][c];
        let before = sides[0][c] + left * a * mixed.before.variance / spread;
        // No light is negative.
        let before = before.clamp(0.0, (color[c] / a).max(0.0));
        sides[0][c] = before;
        sides[1][c] = (color[c] - a * before) / b;
    }
    (share, sides)
}

/// Shares are quantised to 8 bits; less than one step is none.
const MIN_SHARE: f32 = 1.0 / 256.0;

/// Jumps of depth: by cell, the disparity on the other side.
struct Jumps {
    /// Disparity behind the cell's own side.
    behind: Vec<Option<f32>>,
    /// Disparity in front of it.
    before: Vec<Option<f32>>,
}

impl Jumps {
    fn new(grid: Grid, disparity: &[f32], links: &Links, jump: f32) -> Self {
        let mut jumps = Self { behind: vec![None; grid.count()], before: vec![None; grid.count()] };
        let far = |current: Option<f32>, other: f32| Some(current.map_or(other, |value| value.min(other)));
        let near = |current: Option<f32>, other: f32| Some(current.map_or(other, |value| value.max(other)));
        for cell in 0..grid.count() {
            for (side, other) in grid.around(cell) {
                if links.has(cell, side) {
                    continue;
                }
                let step = disparity[cell] - disparity[other];
                if step > jump {
                    jumps.behind[cell] = far(jumps.behind[cell], disparity[other]);
                } else if step < -jump {
                    jumps.before[cell] = near(jumps.before[cell], disparity[other]);
                }
            }
        }
        jumps
    }

    /// Whether a cell is not next to a jump.
    fn is_plain(&self, cell: usize) -> bool {
        self.behind[cell].is_none() && self.before[cell].is_none()
    }
}

/// The colours around a cell of the two sides of its jump, which have these disparities.
fn sides(
    grid: Grid,
    disparity: &[f32],
    colors: &[[f32; 3]],
    jumps: &Jumps,
    jump: f32,
    cell: usize,
    [before, behind]: [f32; 2],
) -> Option<[ColorStats; 2]> {
    let [x, y] = [cell % grid.width, cell / grid.width].map(|at| at as isize);
    // The colours of one depth within a radius: of whole pixels, or of all.
    let around = |level: f32, reach: isize, of_all: bool| {
        let mut accumulator = ColorAccumulator::default();
        for (dy, dx) in (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| (dy, dx))) {
            let (x, y) = (x + dx, y + dy);
            if x < 0 || y < 0 || x >= grid.width as isize || y >= grid.height as isize {
                continue;
            }
            let other = grid.at(x as usize, y as usize);
            if (disparity[other] - level).abs() <= jump && (of_all || jumps.is_plain(other)) {
                // Nearer ones have more weight.
                accumulator.add(colors[other], 1.0 / (1.0 + (dx * dx + dy * dy) as f32));
            }
        }
        accumulator.stats()
    };
    let behind = around(behind, AROUND, false)?;
    // What is too thin to have an inside continues elsewhere, as hair on a head; otherwise all of its pixels count.
    let before = around(before, AROUND, false)
        .or_else(|| around(before, FAR_AROUND, false))
        .or_else(|| around(before, AROUND, true))?;
    Some([before, behind])
}

/// The share of the foreground, and its standard deviation.
fn estimate_share(color: [f32; 3], mixed: &MixedPixel) -> (f32, f32) {
    let expected = if mixed.is_beyond { 0.0 } else { 1.0 };
    let between = squared_distance(mixed.before.color, mixed.behind.color);
    let along: f32 = (0..3)
        .map(|c| (color[c] - mixed.behind.color[c]) * (mixed.before.color[c] - mixed.behind.color[c]))
        .sum();
    let by_depth = 1.0 / (BY_DEPTH * BY_DEPTH);
    let mut share: f32 = 0.5;
    let mut precision = by_depth;
    // The variances of both sides are weighted by their shares.
    for _ in 0..3 {
        let noise = noise_variance(color);
        let variance = share * share * mixed.before.variance + (1.0 - share).powi(2) * mixed.behind.variance;
        let variance = (variance + noise) / 3.0;
        precision = by_depth + between / variance;
        share = ((expected * by_depth + along / variance) / precision).clamp(0.0, 1.0);
    }
    (share, precision.sqrt().recip())
}

/// Whether a pixel is a mixture, and its share.
fn detect_mixture(color: [f32; 3], mixed: MixedPixel) -> Option<MixedPixel> {
    let (share, deviation) = estimate_share(color, &mixed);
    let (pure, mixed_share) =
        if mixed.is_beyond { (mixed.behind, share) } else { (mixed.before, 1.0 - share) };
    let mean = std::array::from_fn(|c| share * mixed.before.color[c] + (1.0 - share) * mixed.behind.color[c]);
    let is_explained =
        squared_distance(color, mean) <= (1.0 - EXPLAINED) * squared_distance(color, pure.color);
    (mixed_share > MIN_DEVIATIONS * deviation && mixed_share >= MIN_SHARE && is_explained)
        .then_some(MixedPixel { share, ..mixed })
}
