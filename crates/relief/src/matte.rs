//! Pixels at jumps of depth that show both sides: how much of each, and in which colours.
//!
//! A pixel that an edge passes through shows I = α·F + (1 − α)·B: so much of what stands before and so much of what lies behind. Out of focus
//! the two go apart, and a surface of the colour I would have a fringe. F is expected to be as a few pixels further inside, B as other views
//! show it or as a few pixels further outside; α is the most likely one, given how much both vary there, and that depth puts the edge between
//! two pixels (0 or 1, give or take what rounding leaves open). Where F and B are too much alike to tell, or vary too much, that is what it
//! stays. What is left of I is shared out as either side varies (Chuang et al., *A Bayesian approach to digital matting*, 2001), so that the
//! picture stays what it is.

use crate::cells::{Grid, Links};
use crate::look::{ColorAccumulator, ColorStats, noise_variance, squared_distance};
use rayon::prelude::*;

/// From this share on a pixel shows one side only.
const WHOLE: f32 = 0.9;
/// How far around a pixel what its two sides look like is looked for.
const AROUND: isize = 3;
/// The same where nothing is there.
const FAR_AROUND: isize = 12;
/// The standard deviation of a share where only depth tells it: an edge anywhere within a pixel.
const BY_DEPTH: f32 = 0.3;
/// So many standard deviations off 0 or 1 it is a mixture.
const MIN_DEVIATIONS: f32 = 2.0;
/// Of how far a pixel is off the colour of its side, squared, a mixture explains at least so much.
const EXPLAINED: f32 = 0.5;

/// A pixel that shows both sides of a jump.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MixedPixel {
    pub cell: usize,
    /// What stands before is this much of it, in (0, 1).
    pub share: f32,
    /// Whether it would be taken for what lies behind.
    pub is_beyond: bool,
    pub before: ColorStats,
    pub behind: ColorStats,
}

/// Pixels beside jumps, which may show both sides.
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

/// Those of the edges that do show both sides. Those of the farther side are then taken for the nearer one's, which they are part of: the
/// disparities with that, too.
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

/// Pixels beside jumps that show only what is on the other side.
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

/// The disparities where pixels beside jumps have that of what is on the other side.
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

/// A mixture, told anew: once it is known what lies behind. The colours of both sides, of which it is made exactly.
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

/// Shares are told in steps of an eighth bit; less than one is none.
const MIN_SHARE: f32 = 1.0 / 256.0;

/// Where depth jumps: by cell, what lies on the other side.
struct Jumps {
    /// Disparity of what lies behind the cell's own side.
    behind: Vec<Option<f32>>,
    /// Disparity of what stands before it.
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

    /// Whether a cell lies at no jump.
    fn is_plain(&self, cell: usize) -> bool {
        self.behind[cell].is_none() && self.before[cell].is_none()
    }
}

/// What the two sides of a cell's jump, of these disparities, look like around it.
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
    // Of what lies in one depth around it, so far: the whole pixels, or all.
    let around = |level: f32, reach: isize, of_all: bool| {
        let mut accumulator = ColorAccumulator::default();
        for (dy, dx) in (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| (dy, dx))) {
            let (x, y) = (x + dx, y + dy);
            if x < 0 || y < 0 || x >= grid.width as isize || y >= grid.height as isize {
                continue;
            }
            let other = grid.at(x as usize, y as usize);
            if (disparity[other] - level).abs() <= jump && (of_all || jumps.is_plain(other)) {
                // Nearer ones tell more.
                accumulator.add(colors[other], 1.0 / (1.0 + (dx * dx + dy * dy) as f32));
            }
        }
        accumulator.stats()
    };
    let behind = around(behind, AROUND, false)?;
    // What is too thin to have an inside goes on elsewhere, as hair on a head; or it is told by what there is of it.
    let before = around(before, AROUND, false)
        .or_else(|| around(before, FAR_AROUND, false))
        .or_else(|| around(before, AROUND, true))?;
    Some([before, behind])
}

/// The share of what stands before, and its standard deviation.
fn estimate_share(color: [f32; 3], mixed: &MixedPixel) -> (f32, f32) {
    let expected = if mixed.is_beyond { 0.0 } else { 1.0 };
    let between = squared_distance(mixed.before.color, mixed.behind.color);
    let along: f32 = (0..3)
        .map(|c| (color[c] - mixed.behind.color[c]) * (mixed.before.color[c] - mixed.behind.color[c]))
        .sum();
    let by_depth = 1.0 / (BY_DEPTH * BY_DEPTH);
    let mut share: f32 = 0.5;
    let mut precision = by_depth;
    // How much either side varies counts as much as there is of it.
    for _ in 0..3 {
        let noise = noise_variance(color);
        let variance = share * share * mixed.before.variance + (1.0 - share).powi(2) * mixed.behind.variance;
        let variance = (variance + noise) / 3.0;
        precision = by_depth + between / variance;
        share = ((expected * by_depth + along / variance) / precision).clamp(0.0, 1.0);
    }
    (share, precision.sqrt().recip())
}

/// Whether a pixel is a mixture, and of how much.
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
