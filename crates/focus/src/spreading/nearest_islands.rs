//! Islands of texels, joined across the gaps between them.

use crate::Canvas;
use crate::spreading::surface_link::SurfaceLink;
use progress::{Cancelled, Progress};
use rayon::prelude::*;

/// A gap is at most this many texels wide.
const MAX_GAP_TEXELS: f64 = 48.0;

/// The conductance across a gap one texel wide; it falls with the square of the width.
const GAP_CONDUCTANCE: f64 = 0.02;

/// An island searches from this many of its texels, evenly chosen: a small one from all.
const MAX_STARTS: usize = 256;

/// A texel of another part counts as this many times farther away: the pickets of a fence hang together with each other
/// rather than with the ground.
const OTHER_PART_FACTOR: f64 = 4.0;

/// Across a gap within the same part that is at most this many texels wide, an island is joined along its whole border.
const SEAM_TEXELS: f64 = 3.0;
/// The conductance of each link of such a border: more than between other parts that touch.
const SEAM_CONDUCTANCE: f32 = 0.2;

/// Rounds in which every island joins its nearest neighbour: each at least halves their number.
const MAX_ROUNDS: usize = 8;

/// The nearest texel of another island.
#[derive(Clone, Copy)]
struct Nearest {
    /// The distance, longer to other parts.
    reach: f64,
    distance: f64,
    texels: [u32; 2],
}

/// Joins each island to its nearest neighbour, and the resulting islands again (Borůvka's algorithm, within
/// [`MAX_GAP_TEXELS`]). The largest does not search: the others find it.
pub(crate) fn join_islands(
    canvas: &Canvas,
    spacings: &[f64],
    links: &mut Vec<SurfaceLink>,
    progress: &dyn Progress,
) -> Result<(), Cancelled> {
    for _ in 0..MAX_ROUNDS {
        progress.check()?;
        let pairs: Vec<_> = links.iter().map(|link| (link.texels[0], link.texels[1], 1.0)).collect();
        let (island_of, count) = spread::Graph::new(spacings.len(), &pairs).components();
        let mut islands = vec![Vec::new(); count];
        for (texel, island) in island_of.iter().enumerate() {
            islands[*island as usize].push(texel as u32);
        }
        let Some(largest) = (0..count).max_by_key(|island| (islands[*island].len(), count - island)) else {
            return Ok(());
        };
        let joined: Vec<SurfaceLink> = islands
            .par_iter()
            .enumerate()
            .filter(|(island, _)| *island != largest)
            .filter_map(|(_, texels)| Some((texels, nearest_to(canvas, spacings, texels, &island_of)?)))
            .flat_map_iter(|(texels, nearest)| {
                let seam = seam_of(canvas, spacings, texels, nearest, &island_of);
                [gap_link(spacings, nearest)].into_iter().chain(seam)
            })
            .collect();
        if joined.is_empty() {
            return Ok(());
        }
        links.extend(joined);
    }
    Ok(())
}

/// The nearest texel of another island, seen from some texels of one.
fn nearest_to(canvas: &Canvas, spacings: &[f64], texels: &[u32], island_of: &[u32]) -> Option<Nearest> {
    let mut best: Option<Nearest> = None;
    for &start in texels.iter().step_by(texels.len().div_ceil(MAX_STARTS)) {
        let from = canvas.texel(start as usize);
        let farthest = MAX_GAP_TEXELS * spacings[start as usize];
        let mut radius = 2.0 * spacings[start as usize];
        loop {
            radius = radius.min(farthest).min(best.map_or(f64::INFINITY, |best| best.reach));
            let mut is_found = false;
            canvas.visit_within(from.position, radius, |other, distance| {
                if island_of[other] == island_of[start as usize] {
                    return;
                }
                is_found = true;
                let is_same_part = canvas.texel(other).part == from.part;
                let distance = f64::from(distance);
                let reach = distance * if is_same_part { 1.0 } else { OTHER_PART_FACTOR };
                if best.is_none_or(|best| reach < best.reach) {
                    best = Some(Nearest { reach, distance, texels: [start, other as u32] });
                }
            });
            if radius >= farthest || best.is_some_and(|best| radius >= best.reach) || radius <= 0.0 {
                break;
            }
            // Something nearby may still be of another part, which a farther one of the same part precedes.
            radius *= if is_found { OTHER_PART_FACTOR } else { 2.0 };
        }
    }
    best
}

/// What of an island lies along a narrow gap to the same part, texel by texel, if it is joined across one: a head that is set upon a body hangs together with it
/// by their whole border, of which some is alike, and not by one place.
fn seam_of(
    canvas: &Canvas,
    spacings: &[f64],
    texels: &[u32],
    nearest: Nearest,
    island_of: &[u32],
) -> Vec<SurfaceLink> {
    let [part, other_part] = nearest.texels.map(|texel| canvas.texel(texel as usize).part);
    let is_narrow = nearest.distance <= SEAM_TEXELS * spacings[nearest.texels[0] as usize];
    if part != other_part || !is_narrow {
        return Vec::new();
    }
    let across = |&start: &u32| {
        let (from, mut best) = (canvas.texel(start as usize), None::<Nearest>);
        canvas.visit_within(from.position, SEAM_TEXELS * spacings[start as usize], |other, distance| {
            let distance = f64::from(distance);
            let is_across =
                island_of[other] != island_of[start as usize] && canvas.texel(other).part == from.part;
            if is_across && best.is_none_or(|best| distance < best.distance) {
                best = Some(Nearest { reach: distance, distance, texels: [start, other as u32] });
            }
        });
        best.map(|best| SurfaceLink { texels: best.texels, conductance: SEAM_CONDUCTANCE })
    };
    texels.iter().filter_map(across).collect()
}

fn gap_link(spacings: &[f64], Nearest { distance, texels, .. }: Nearest) -> SurfaceLink {
    let spacing = texels.map(|texel| spacings[texel as usize]).into_iter().fold(0.0, f64::max);
    let closeness = if distance > spacing { spacing / distance } else { 1.0 };
    let conductance = (GAP_CONDUCTANCE * closeness * closeness) as f32;
    SurfaceLink { texels, conductance: conductance.max(spread::LEAST_AFFINITY) }
}
