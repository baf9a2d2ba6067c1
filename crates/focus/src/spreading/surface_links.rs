//! Which texels are neighbours on the surface.

use crate::Canvas;
use crate::spreading::nearest_islands::join_islands;
use crate::spreading::surface_link::SurfaceLink;
use progress::{Cancelled, Progress};
use rayon::prelude::*;

/// All pairs of neighbouring texels of a canvas.
///
/// * Texels side by side in a chart; where depth jumps between them, they conduct little.
/// * Texels of other charts, or elsewhere in the same one, that are as near as those side by side: the surface goes on
///   across a seam, or touches another part.
/// * The nearest texels of islands that none of these join, across a gap.
#[derive(Clone, Debug)]
pub(crate) struct SurfaceLinks {
    pub links: Vec<SurfaceLink>,
    /// How many of them, the first ones, join texels that touch.
    pub touching: usize,
}

/// Conductance between parts that touch: objects that stand on each other are seldom meant together.
const CONTACT_CONDUCTANCE: f32 = 0.02;

/// A texel searches across seams within this multiple of the distance to its nearest neighbour in the chart: the
/// diagonal of a square of texels, and a little more.
const SEAM_REACH: f64 = 1.5;

/// Neighbours across a seam, at most.
const MAX_SEAM_LINKS: usize = 2;

/// Texels whose normals have a smaller cosine are two sides of a thin wall.
const LEAST_COSINE: f32 = -0.5;

/// Texels of one chart that are at most this far apart in it, in columns or rows, are neighbours there, or too near each
/// other to be a seam.
const SAME_PLACE: u32 = 2;

/// Distances are expected to be up to this multiple of what the texels' areas say.
const EXPECTED_SPREAD: f64 = 2.0;

impl SurfaceLinks {
    /// The neighbours on a canvas.
    ///
    /// # Errors
    /// `progress` was cancelled.
    pub fn new(canvas: &Canvas, progress: &dyn Progress) -> Result<Self, Cancelled> {
        let side_by_side = chart_neighbours(canvas);
        progress.check()?;
        let spacings = spacings(canvas, &side_by_side);
        let mut links: Vec<SurfaceLink> = side_by_side
            .par_iter()
            .map(|&texels| SurfaceLink { texels, conductance: without_jump(canvas, &spacings, texels) })
            .collect();
        progress.check()?;
        progress.report(0.2);
        links.extend(seams(canvas, &spacings));
        progress.check()?;
        progress.report(0.6);
        let touching = links.len();
        join_islands(canvas, &spacings, &mut links, progress)?;
        progress.report(1.0);
        Ok(Self { links, touching })
    }
}

/// Pairs of texels of one chart in neighbouring columns or rows.
fn chart_neighbours(canvas: &Canvas) -> Vec<[u32; 2]> {
    const NOT_COVERED: u32 = u32::MAX;
    let [width, height] = canvas.size();
    let address = |x: u32, y: u32| y as usize * width as usize + x as usize;
    let mut index_at = vec![NOT_COVERED; width as usize * height as usize];
    for (index, texel) in (0..).zip(canvas.texels()) {
        index_at[address(texel.x, texel.y)] = index;
    }
    let mut pairs = Vec::with_capacity(2 * canvas.texels().len());
    for (index, texel) in (0..).zip(canvas.texels()) {
        let right = (texel.x + 1 < width).then(|| index_at[address(texel.x + 1, texel.y)]);
        let below = (texel.y + 1 < height).then(|| index_at[address(texel.x, texel.y + 1)]);
        for other in [right, below].into_iter().flatten().filter(|other| *other != NOT_COVERED) {
            if canvas.texel(other as usize).chart == texel.chart {
                pairs.push([index, other]);
            }
        }
    }
    pairs
}

/// The distance from each texel to the nearest one beside it in its chart; the side of a square of its area if there is
/// none.
fn spacings(canvas: &Canvas, side_by_side: &[[u32; 2]]) -> Vec<f64> {
    let mut spacings = vec![f64::INFINITY; canvas.texels().len()];
    for texels in side_by_side {
        let distance = distance_between(canvas, *texels);
        for texel in texels {
            let own = &mut spacings[*texel as usize];
            *own = own.min(distance);
        }
    }
    let or_by_area = |(index, spacing): (usize, f64)| {
        if spacing.is_finite() { spacing } else { canvas.texel(index).area.sqrt() }
    };
    spacings.into_iter().enumerate().map(or_by_area).collect()
}

/// World distance between the centroids of two texels.
pub(crate) fn distance_between(canvas: &Canvas, [a, b]: [u32; 2]) -> f64 {
    canvas.texel(a as usize).position.distance(canvas.texel(b as usize).position)
}

/// 1 between texels as far apart as their areas say (a surface seen at a grazing angle has large ones), and less the
/// farther they are apart: the surface was cut between them.
fn without_jump(canvas: &Canvas, spacings: &[f64], texels: [u32; 2]) -> f32 {
    let [a, b] = texels.map(|texel| canvas.texel(texel as usize).area);
    let across = texels.map(|texel| spacings[texel as usize]).into_iter().fold(f64::INFINITY, f64::min);
    let distance = distance_between(canvas, texels);
    // a.max(b) / across, compared without a quotient: `across` may be 0.
    let expected = EXPECTED_SPREAD * a.max(b).max(across * across);
    let excess = distance * across;
    if excess <= expected { 1.0 } else { ((expected / excess).powi(3) as f32).max(spread::LEAST_AFFINITY) }
}

/// Links across seams and contacts, sorted by their texels.
fn seams(canvas: &Canvas, spacings: &[f64]) -> Vec<SurfaceLink> {
    let of_texel = |index: usize| {
        let texel = canvas.texel(index);
        let mut nearest: Vec<(f32, u32)> = Vec::new();
        canvas.visit_within(texel.position, SEAM_REACH * spacings[index], |other, distance| {
            let neighbour = canvas.texel(other);
            let is_same_place = neighbour.chart == texel.chart
                && neighbour.x.abs_diff(texel.x) <= SAME_PLACE
                && neighbour.y.abs_diff(texel.y) <= SAME_PLACE;
            if !is_same_place && neighbour.normal.dot(texel.normal) >= LEAST_COSINE {
                nearest.push((distance, other as u32));
            }
        });
        nearest.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        nearest.truncate(MAX_SEAM_LINKS);
        nearest.into_iter().map(move |(_, other)| [other.min(index as u32), other.max(index as u32)])
    };
    let mut pairs: Vec<[u32; 2]> = (0..spacings.len()).into_par_iter().flat_map_iter(of_texel).collect();
    pairs.par_sort_unstable();
    pairs.dedup();
    let link = |texels: [u32; 2]| {
        let [a, b] = texels.map(|texel| canvas.texel(texel as usize).part);
        SurfaceLink { texels, conductance: if a == b { 1.0 } else { CONTACT_CONDUCTANCE } }
    };
    pairs.into_iter().map(link).collect()
}
