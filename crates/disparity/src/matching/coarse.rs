//! A coarse estimate on small pictures: which disparities there are, and where.

use crate::matching::labels::Labels;
use crate::matching::match_labels;
use crate::matching::sweep::{FULL_COST, ShiftedView};
use crate::planes::Planes;
use progress::{Cancelled, Progress};

/// Pixels of the longer side that are enough for a coarse estimate.
const SIDE: usize = 176;

/// Views that are enough for it.
const VIEWS: usize = 24;

/// The parallax that is searched if no range is given: this share of a picture's width, between reference and
/// farthest view.
const SEARCH: f32 = 0.15;

/// Spacing of labels: pixels of the small picture in the farthest view.
const STEP_PX: f32 = 0.5;

/// How much better than any other a label must be to count for the range, as a share of eight paths' full costs.
const LEAD: f32 = 0.04;

/// The share of the counted pixels that disparities of [`BIN`] labels must have to be in the range. Outliers (gloss, repetitive
/// patterns) are scattered; even a thin rod is not.
const POPULATED: f32 = 0.003;

/// Labels that are counted together.
const BIN: f32 = 2.0;

/// The factor, at least 1, by which pictures of `width` × `height` px are shrunk for a coarse estimate.
pub fn shrink_factor(width: usize, height: usize) -> usize {
    (width.max(height) / SIDE).clamp(1, width.min(height) / crate::MIN_SIDE_PX)
}

/// Indices of evenly spread views, the farthest first: enough for a coarse estimate, or all.
pub fn select_spread_views(offsets: &[[f32; 2]]) -> Vec<usize> {
    let mut chosen: Vec<usize> = Vec::new();
    let mut clearance: Vec<f32> = offsets.iter().map(|o| o[0].hypot(o[1])).collect();
    while chosen.len() < VIEWS.min(offsets.len()) {
        let Some(next) = (0..offsets.len()).max_by(|&a, &b| clearance[a].total_cmp(&clearance[b])) else {
            break;
        };
        chosen.push(next);
        for (other, clearance) in clearance.iter_mut().enumerate() {
            let distance = (0..2).map(|k| (offsets[other][k] - offsets[next][k]).powi(2)).sum::<f32>().sqrt();
            *clearance = clearance.min(distance);
        }
    }
    chosen
}

/// The coarse estimate.
pub struct CoarseEstimate {
    /// Disparities of the small picture, in its own pixels.
    pub disparity: Vec<f32>,
    /// The range of all certain disparities with a margin, in pixels of the small picture.
    pub range: (f32, f32),
}

/// Estimates the disparities of small pictures, in `range` or as far as parallax is searched.
///
/// # Errors
/// [`Cancelled`] if `progress` asks to stop.
pub fn estimate_coarse(
    reference: &Planes,
    others: &[ShiftedView<'_>],
    reach: f32,
    range: Option<(f32, f32)>,
    progress: &dyn Progress,
) -> Result<CoarseEstimate, Cancelled> {
    let farthest = SEARCH * reference.width() as f32 / reach;
    let (low, high) = range.unwrap_or((-farthest, farthest));
    let labels = Labels::covering(low, high, STEP_PX / reach);
    let chosen = match_labels(reference, others, &labels, progress)?;
    let lead = (LEAD * 8.0 * FULL_COST) as i16;
    let certain: Vec<f32> = chosen.iter().filter(|c| c.lead > lead).map(|c| c.disparity).collect();
    // Nothing is certain: the whole range that was searched stays possible.
    let range = populated(&certain, &labels).unwrap_or((low, high));
    // Small pictures leave half a pixel open, and the ends of slanted surfaces.
    let margin = STEP_PX / reach + 0.06 * (range.1 - range.0);
    let range = ((range.0 - margin).max(low), (range.1 + margin).min(high));
    Ok(CoarseEstimate { disparity: chosen.iter().map(|c| c.disparity).collect(), range })
}

/// The least and the greatest disparity that is no outlier.
fn populated(certain: &[f32], labels: &Labels) -> Option<(f32, f32)> {
    let width = BIN * labels.step;
    let bin = |d: &f32| (((d - labels.low) / width).max(0.0) as usize).min(labels.count);
    let mut counts = vec![0u32; labels.count + 1];
    certain.iter().for_each(|d| counts[bin(d)] += 1);
    let min_count = (POPULATED * certain.len() as f32).max(2.0);
    let inside = || certain.iter().copied().filter(|d| counts[bin(d)] as f32 >= min_count);
    let low = inside().reduce(f32::min)?;
    Some((low, inside().reduce(f32::max)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scattered_disparities_are_not_in_the_range_and_a_small_thing_is() {
        let labels = Labels { low: -12.0, step: 0.25, count: 97 };
        let mut certain: Vec<f32> = (0..10_000).map(|i| -1.0 + i as f32 / 10_000.0).collect();
        certain.extend((0..200).map(|i| -12.0 + i as f32 * 0.05));
        assert_eq!(populated(&certain, &labels).map(|r| r.1), certain.get(9_999).copied());
        assert!(populated(&certain, &labels).unwrap().0 > -1.6);
        certain.extend([3.0; 60]);
        assert_eq!(populated(&certain, &labels).unwrap().1, 3.0);
        assert_eq!(populated(&[], &labels), None);
    }

    #[test]
    fn views_of_a_coarse_estimate_are_far_apart() {
        let offsets: Vec<[f32; 2]> =
            (0..81).filter(|i| *i != 40).map(|i| [(i % 9) as f32 - 4.0, (i / 9) as f32 - 4.0]).collect();
        let chosen = select_spread_views(&offsets);
        assert_eq!(chosen.len(), VIEWS);
        let corners = chosen.iter().filter(|&&i| offsets[i].iter().all(|o| o.abs() == 4.0)).count();
        assert_eq!(corners, 4);
        assert_eq!(select_spread_views(&offsets[..3]).len(), 3);
    }
}
