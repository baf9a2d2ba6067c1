//! A first look at small pictures: which disparities there are, and where.

use crate::labels::Labels;
use crate::matching::matched;
use crate::planes::Planes;
use crate::sweep::{FULL_COST, Shifted};
use progress::{Cancelled, Progress};

/// Pixels a side that are plenty for a first look.
const SIDE: usize = 176;

/// Views that are plenty for it.
const VIEWS: usize = 24;

/// The parallax that is looked for where no range is given: this share of a picture's width, between reference and farthest view.
const SEARCH: f32 = 0.15;

/// Labels from one to the next: pixels of the small picture in the farthest view.
const STEP_PX: f32 = 0.5;

/// How much better than any other a label must be to count for the range, of eight paths' full costs.
const LEAD: f32 = 0.04;

/// The share of the pixels that count which may lie outside of the range, at each end: stray ones do, a thin rod does not.
const STRAY: f32 = 0.002;

/// By how much pictures are shrunk for a first look.
pub fn shrinking(width: usize, height: usize) -> usize {
    (width.max(height) / SIDE).clamp(1, width.min(height) / crate::SMALLEST)
}

/// Views spread evenly, the farthest first: enough for a first look, or all.
pub fn spread(offsets: &[[f32; 2]]) -> Vec<usize> {
    let mut chosen: Vec<usize> = Vec::new();
    let mut clearance: Vec<f32> = offsets.iter().map(|o| o[0].hypot(o[1])).collect();
    while chosen.len() < VIEWS.min(offsets.len()) {
        let Some(next) = (0..offsets.len()).max_by(|&a, &b| clearance[a].total_cmp(&clearance[b])) else { break };
        chosen.push(next);
        for (other, clearance) in clearance.iter_mut().enumerate() {
            let apart = (0..2).map(|k| (offsets[other][k] - offsets[next][k]).powi(2)).sum::<f32>().sqrt();
            *clearance = clearance.min(apart);
        }
    }
    chosen
}

/// The first look.
pub struct FirstLook {
    /// Disparities of the small picture, in its own pixels.
    pub disparity: Vec<f32>,
    /// The range that holds all that is certain and a margin, in pixels of the small picture.
    pub range: (f32, f32),
}

/// Looks at small pictures for disparities in `range`, or as far as parallax is looked for.
pub fn first_look(
    reference: &Planes,
    others: &[Shifted<'_>],
    reach: f32,
    range: Option<(f32, f32)>,
    progress: &dyn Progress,
) -> Result<FirstLook, Cancelled> {
    let farthest = SEARCH * reference.width() as f32 / reach;
    let (low, high) = range.unwrap_or((-farthest, farthest));
    let labels = Labels::covering(low, high, STEP_PX / reach);
    let chosen = matched(reference, others, &labels, progress)?;
    let lead = (LEAD * 8.0 * FULL_COST) as i16;
    let mut certain: Vec<f32> = chosen.iter().filter(|c| c.lead > lead).map(|c| c.disparity).collect();
    certain.sort_unstable_by(f32::total_cmp);
    let range = match certain.as_slice() {
        // Nothing is certain: what was looked at stays possible.
        [] => (low, high),
        [first, .., last] if certain.len() < 100 => (*first, *last),
        certain => {
            let stray = (STRAY * certain.len() as f32) as usize;
            (certain[stray], certain[certain.len() - 1 - stray])
        }
    };
    // Small pictures leave half a pixel open, and the ends of slanted surfaces.
    let margin = STEP_PX / reach + 0.06 * (range.1 - range.0);
    let range = ((range.0 - margin).max(low), (range.1 + margin).min(high));
    Ok(FirstLook { disparity: chosen.iter().map(|c| c.disparity).collect(), range })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn views_of_a_first_look_are_far_apart() {
        let offsets: Vec<[f32; 2]> =
            (0..81).filter(|i| *i != 40).map(|i| [(i % 9) as f32 - 4.0, (i / 9) as f32 - 4.0]).collect();
        let chosen = spread(&offsets);
        assert_eq!(chosen.len(), VIEWS);
        let corners = chosen.iter().filter(|&&i| offsets[i].iter().all(|o| o.abs() == 4.0)).count();
        assert_eq!(corners, 4);
        assert_eq!(spread(&offsets[..3]).len(), 3);
    }
}
