//! Which photographs are compared: pairs that see one place from directions that differ enough to tell how far away it is.

use super::distance_map::DistanceMap;
use glam::DVec3;
use rayon::prelude::*;
use scene::{Scene, View};

/// Two photographs.
#[derive(Clone, Debug)]
pub(super) struct Pair {
    /// Their indices.
    pub views: [usize; 2],
    /// World points that the first one shows, spread over it.
    pub points: Vec<DVec3>,
}

/// How many photographs are searched for what the surface shows, and the most triangles of all of them together.
const MAX_CANDIDATES: usize = 24;
const MAX_TRIANGLES: usize = 6_000_000;
/// How many pairs are chosen; two for large meshes.
const MAX_PAIRS: usize = 4;
const LARGE_MESH: usize = 1_500_000;
/// Of each candidate so many points are followed into the other photographs.
const POINTS: usize = 40;
/// Most photographs that are searched for the second of a pair.
const MAX_PARTNERS: usize = 2000;

/// What a photograph shows of the surface.
struct CandidateView {
    view: usize,
    /// World points, spread over the picture.
    points: Vec<DVec3>,
    /// The share of the picture that the surface fills.
    share: f64,
}

/// The pairs, best spread over the capture; `None` if no photograph shows anything of the surface.
pub(super) fn choose_pairs(scene: &Scene, views: &[View]) -> Option<Vec<Pair>> {
    let affordable = (MAX_TRIANGLES / scene.triangles.len().max(1)).clamp(4, MAX_CANDIDATES);
    let max_pairs = if scene.triangles.len() > LARGE_MESH { 2 } else { MAX_PAIRS };
    let step = views.len().div_ceil(affordable).max(1);
    let sampled: Vec<usize> = (0..views.len()).step_by(step).collect();
    let candidate = |view: &usize| candidate_view(scene, &views[*view], *view);
    let at_once = at_once(scene);
    let mut candidates: Vec<CandidateView> = sampled
        .chunks(at_once)
        .flat_map(|chunk| chunk.par_iter().filter_map(candidate).collect::<Vec<_>>())
        .collect();
    if candidates.is_empty() {
        candidates.extend((0..views.len()).filter(|view| view % step != 0).find_map(|view| candidate(&view)));
    }
    let most = candidates.iter().map(|candidate| candidate.share).fold(0.0, f64::max);
    if candidates.is_empty() {
        return None;
    }
    candidates.retain(|candidate| candidate.share >= 0.25 * most);
    let mut pairs: Vec<Pair> = Vec::new();
    let mut next = candidates.iter().position(|candidate| candidate.share == most);
    while let Some(index) = next {
        let first = candidates.swap_remove(index);
        if let Some(second) = partner(views, &first) {
            let is_new = pairs.iter().all(|pair| pair.views != [second, first.view]);
            if is_new {
                pairs.push(Pair { views: [first.view, second], points: first.points });
            }
        }
        // Next, the photograph farthest from all that were chosen.
        let distance = |candidate: &CandidateView| {
            let from = |chosen: &usize| views[candidate.view].position().distance(views[*chosen].position());
            pairs.iter().flat_map(|pair| &pair.views).map(from).fold(f64::INFINITY, f64::min)
        };
        next = match pairs.len() < max_pairs {
            true => (0..candidates.len())
                .max_by(|a, b| distance(&candidates[*a]).total_cmp(&distance(&candidates[*b]))),
            false => None,
        };
    }
    Some(pairs)
}

/// How many maps of a mesh may be made at once: each has some hundred bytes a vertex.
pub(super) fn at_once(scene: &Scene) -> usize {
    if scene.positions.len() > 500_000 { 2 } else { 8 }
}

/// What the photograph of this index shows of the surface, if anything.
fn candidate_view(scene: &Scene, view: &View, index: usize) -> Option<CandidateView> {
    /// px along the longer side
    const SIDE: f64 = 64.0;
    let [width, height] = view.lens.size_px();
    let factor = (f64::from(width.max(height)) / SIDE).max(1.0);
    let map = DistanceMap::new(scene, view, factor);
    let hits: Vec<[usize; 2]> = map.hits().collect();
    let share = hits.len() as f64 / (map.width * map.height) as f64;
    let step = hits.len().div_ceil(POINTS).max(1);
    let points: Vec<DVec3> = hits.iter().step_by(step).filter_map(|[x, y]| map.point(view, *x, *y)).collect();
    (!points.is_empty()).then_some(CandidateView { view: index, points, share })
}

/// The photograph that sees most of the same points from the most telling directions.
fn partner(views: &[View], first: &CandidateView) -> Option<usize> {
    let origin = views[first.view].position();
    let score = |second: usize| -> f64 {
        let view = &views[second];
        let of_point = |point: &DVec3| {
            let is_visible = view.project(*point).is_some_and(|pixel| view.lens.is_in_picture(pixel));
            let angle = (origin - *point).angle_between(view.position() - *point).to_degrees();
            if is_visible { parallax_weight(angle) } else { 0.0 }
        };
        first.points.iter().map(of_point).sum()
    };
    let step = views.len().div_ceil(MAX_PARTNERS).max(1);
    let others = (0..views.len()).step_by(step).filter(|second| *second != first.view);
    let scored = others.map(|second| (second, score(second))).filter(|(_, score)| *score > 0.0);
    scored.max_by(|(_, a), (_, b)| a.total_cmp(b)).map(|(second, _)| second)
}

/// How much two directions that differ by `degrees` tell: less, and depth hardly moves what is seen; more, and it looks different.
fn parallax_weight(degrees: f64) -> f64 {
    (degrees / 20.0).min((50.0 - degrees) / 25.0).clamp(0.0, 1.0)
}
