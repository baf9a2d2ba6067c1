//! Repair of depth by hand: strokes over a picture that change its disparities before they become a surface.

use numerics::{smooth_fraction, upper_median};
use serde::{Deserialize, Serialize};

/// The effect of a stroke on the depth beneath it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DepthRepair {
    /// Pulls toward the camera.
    Nearer,
    /// Pushes away from it.
    Farther,
    /// Smooths among pixels of similar colour: regions that differ in the picture stay separate.
    Smooth,
    /// Spreads the depth at the stroke's beginning over all of it, with a hard edge: values between two depths would
    /// make a skin.
    Spread,
}

/// A stroke over a picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DepthStroke {
    /// Its effect.
    pub repair: DepthRepair,
    /// The stroke's points, pixels from the picture's upper left corner.
    #[serde(rename = "way")]
    pub path: Vec<[f32; 2]>,
    /// Its radius, px, > 0.
    pub radius_px: f32,
    /// The share of the radius with full strength, in [0, 1].
    pub hardness: f32,
    /// Its strength, in [0, 1]: of the largest shift, or of the step to the mean.
    pub strength: f32,
}

/// The shift of one full stroke, as a share of the range of the picture's disparities.
const MAX_SHIFT_SHARE: f32 = 0.1;
/// The largest coordinate or radius, px: beyond it no stroke lies on a picture.
const MAX_COORDINATE_PX: f32 = 1e6;
/// The radius of smoothing, as a share of the stroke's radius, and at most.
const SMOOTHING_RADIUS_SHARE: f32 = 0.5;
const MAX_SMOOTHING_RADIUS_PX: f32 = 24.0;
/// Samples to either side within that radius.
const SAMPLES_PER_SIDE: isize = 4;
/// The difference at which colours are no longer similar, in square roots of linear light.
const COLOR_SIGMA: f32 = 0.06;
/// The least weight with which a pixel takes the depth that is spread.
const MIN_SPREAD_WEIGHT: f32 = 0.5;

impl DepthStroke {
    /// Whether its numbers are within their ranges.
    pub fn is_valid(&self) -> bool {
        let is_share = |share: f32| (0.0..=1.0).contains(&share);
        is_share(self.hardness)
            && is_share(self.strength)
            && self.radius_px > 0.0
            && self.radius_px <= MAX_COORDINATE_PX
            && self.path.iter().flatten().all(|at| at.abs() <= MAX_COORDINATE_PX)
    }

    /// The same on a picture whose pixels are `pixel_scale` of this one's wide.
    fn scaled_down(&self, pixel_scale: f32) -> Self {
        let path = self.path.iter().map(|place| place.map(|at| at / pixel_scale)).collect();
        Self { path, radius_px: self.radius_px / pixel_scale, ..self.clone() }
    }

    /// The pixels that it covers, row by row, with their weights in (0, 1].
    fn covered(&self, [width, height]: [usize; 2]) -> Vec<(usize, f32)> {
        let radius = self.radius_px;
        let mut nearest = std::collections::BTreeMap::<usize, f32>::new();
        let span = |low: f32, high: f32, count: usize| {
            let first = (low - radius - 0.5).ceil().max(0.0) as usize;
            let last = (high + radius - 0.5).floor().min(count as f32 - 1.0);
            first..(last + 1.0).max(0.0) as usize
        };
        let single = self.path.first().filter(|_| self.path.len() == 1).map(|&at| [at, at]);
        for [[ax, ay], [bx, by]] in self.path.array_windows().copied().chain(single) {
            let (dx, dy) = (bx - ax, by - ay);
            let squared = dx * dx + dy * dy;
            for y in span(ay.min(by), ay.max(by), height) {
                for x in span(ax.min(bx), ax.max(bx), width) {
                    let (px, py) = (x as f32 + 0.5 - ax, y as f32 + 0.5 - ay);
                    let along =
                        if squared > 0.0 { ((px * dx + py * dy) / squared).clamp(0.0, 1.0) } else { 0.0 };
                    let distance = (px - along * dx).hypot(py - along * dy);
                    if distance <= radius {
                        let shortest = nearest.entry(y * width + x).or_insert(distance);
                        *shortest = shortest.min(distance);
                    }
                }
            }
        }
        let weight = |distance: f32| {
            let share = distance / radius;
            if share <= self.hardness {
                return 1.0;
            }
            smooth_fraction((1.0 - share) / (1.0 - self.hardness))
        };
        let covered = nearest.into_iter().map(|(pixel, distance)| (pixel, weight(distance)));
        covered.filter(|(_, weight)| *weight > 0.0).collect()
    }
}

/// Applies strokes in order to the disparities of a picture (linear RGB, row by row; no NaNs). Disparities stay within their original
/// range. `pixel_scale`: the width of one of these pixels in pixels of the strokes' picture.
pub fn apply_depth_strokes(
    size: [usize; 2],
    mut disparity: Vec<f32>,
    picture: &[[f32; 3]],
    strokes: &[DepthStroke],
    pixel_scale: f32,
) -> Vec<f32> {
    let low = disparity.iter().copied().fold(f32::INFINITY, f32::min);
    let high = disparity.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    for stroke in strokes.iter().filter(|stroke| stroke.is_valid()) {
        let stroke = stroke.scaled_down(pixel_scale);
        let covered = stroke.covered(size);
        let step = stroke.strength * MAX_SHIFT_SHARE * (high - low);
        let changed: Vec<f32> = match stroke.repair {
            DepthRepair::Nearer => {
                covered.iter().map(|&(at, weight)| disparity[at] + weight * step).collect()
            }
            DepthRepair::Farther => {
                covered.iter().map(|&(at, weight)| disparity[at] - weight * step).collect()
            }
            DepthRepair::Smooth => {
                let smoothing_radius_px =
                    (stroke.radius_px * SMOOTHING_RADIUS_SHARE).min(MAX_SMOOTHING_RADIUS_PX);
                let toward = |&(at, weight): &(usize, f32)| {
                    let mean = mean_of_similar(size, &disparity, picture, at, smoothing_radius_px);
                    disparity[at] + (mean - disparity[at]) * weight * stroke.strength
                };
                covered.iter().map(toward).collect()
            }
            DepthRepair::Spread => {
                let Some(level) = start_disparity(size, &disparity, &stroke) else { continue };
                let spread = |&(at, weight): &(usize, f32)| {
                    if weight >= MIN_SPREAD_WEIGHT { level } else { disparity[at] }
                };
                covered.iter().map(spread).collect()
            }
        };
        for ((at, _), changed) in covered.into_iter().zip(changed) {
            disparity[at] = changed.clamp(low, high);
        }
    }
    disparity
}

/// The mean disparity around a pixel, over pixels of similar colour.
fn mean_of_similar(
    [width, height]: [usize; 2],
    disparity: &[f32],
    picture: &[[f32; 3]],
    pixel: usize,
    smoothing_radius_px: f32,
) -> f32 {
    let step = (smoothing_radius_px / SAMPLES_PER_SIDE as f32).ceil().max(1.0) as isize;
    let (x, y) = ((pixel % width) as isize, (pixel / width) as isize);
    let own = picture[pixel].map(encoded);
    let (mut sum, mut weights) = (0.0, 0.0);
    for dy in -SAMPLES_PER_SIDE..=SAMPLES_PER_SIDE {
        for dx in -SAMPLES_PER_SIDE..=SAMPLES_PER_SIDE {
            let (x, y) = (x + dx * step, y + dy * step);
            if !(0..width as isize).contains(&x) || !(0..height as isize).contains(&y) {
                continue;
            }
            let other = y as usize * width + x as usize;
            let color = picture[other].map(encoded);
            let difference: f32 = own.iter().zip(color).map(|(a, b)| (a - b) * (a - b)).sum();
            let weight = (-difference / (2.0 * COLOR_SIGMA * COLOR_SIGMA)).exp();
            sum += weight * disparity[other];
            weights += weight;
        }
    }
    // The pixel itself has weight 1: the weights are never 0.
    sum / weights
}

fn encoded(linear: f32) -> f32 {
    linear.clamp(0.0, 1.0).sqrt()
}

/// The disparity where a stroke begins: the median of a small disc; `None` for a stroke that begins outside the
/// picture.
fn start_disparity(size: [usize; 2], disparity: &[f32], stroke: &DepthStroke) -> Option<f32> {
    let start = *stroke.path.first()?;
    let disc =
        DepthStroke { path: vec![start], radius_px: (stroke.radius_px * 0.25).max(1.0), ..stroke.clone() };
    let mut values: Vec<f32> = disc.covered(size).into_iter().map(|(at, _)| disparity[at]).collect();
    upper_median(&mut values)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [usize; 2] = [40, 30];

    /// A near card of 10 × 10 pixels, in red, before a far wall in grey.
    fn card() -> (Vec<f32>, Vec<[f32; 3]>) {
        let is_card = |at: usize| (10..20).contains(&(at % 40)) && (10..20).contains(&(at / 40));
        let disparity = (0..1200).map(|at| if is_card(at) { 1.0 } else { 0.0 }).collect();
        let picture = (0..1200).map(|at| if is_card(at) { [0.8, 0.1, 0.1] } else { [0.4; 3] }).collect();
        (disparity, picture)
    }

    fn stroke(repair: DepthRepair, path: &[[f32; 2]], radius_px: f32) -> DepthStroke {
        DepthStroke { repair, path: path.to_vec(), radius_px, hardness: 0.5, strength: 1.0 }
    }

    fn after(strokes: &[DepthStroke]) -> Vec<f32> {
        let (disparity, picture) = card();
        apply_depth_strokes(SIZE, disparity, &picture, strokes, 1.0)
    }

    #[test]
    fn pulling_and_pushing_stay_within_the_range_and_beneath_the_stroke() {
        let wall = stroke(DepthRepair::Nearer, &[[30.0, 5.0], [30.0, 25.0]], 3.0);
        let once = after(std::slice::from_ref(&wall));
        assert!((once[15 * 40 + 30] - 0.1).abs() < 1e-6);
        assert_eq!((once[15 * 40 + 35], once[15 * 40 + 15]), (0.0, 1.0), "beside it nothing changes");
        let much = after(&vec![wall.clone(); 20]);
        assert_eq!(much[15 * 40 + 30], 1.0);
        let back = after(&[wall.clone(), DepthStroke { repair: DepthRepair::Farther, ..wall }]);
        assert!(back[15 * 40 + 30].abs() < 1e-6);
    }

    #[test]
    fn depth_spreads_from_where_a_stroke_begins_with_a_hard_edge() {
        let spread = after(&[stroke(DepthRepair::Spread, &[[15.0, 15.0], [30.0, 15.0]], 4.0)]);
        assert_eq!(spread[15 * 40 + 28], 1.0);
        assert!(spread.iter().all(|&value| value == 0.0 || value == 1.0));
        let beside = after(&[stroke(DepthRepair::Spread, &[[-50.0, 15.0], [30.0, 15.0]], 4.0)]);
        assert_eq!(beside, card().0, "it begins where there is no picture");
    }

    #[test]
    fn smoothing_keeps_apart_what_the_picture_separates() {
        let (mut disparity, picture) = card();
        disparity[5 * 40 + 30] = 0.5;
        let smooth = stroke(DepthRepair::Smooth, &[[5.0, 15.0], [35.0, 5.0]], 12.0);
        let smooth = apply_depth_strokes(SIZE, disparity, &picture, &[smooth], 1.0);
        assert!(smooth[5 * 40 + 30] < 0.05, "{}", smooth[5 * 40 + 30]);
        assert!(smooth[15 * 40 + 15] > 0.99 && smooth[15 * 40 + 22] < 0.01);
    }

    #[test]
    fn strokes_reach_a_coarser_surface_alike() {
        let (disparity, picture) = card();
        let fine = stroke(DepthRepair::Nearer, &[[60.0, 10.0], [60.0, 50.0]], 6.0);
        let coarse = stroke(DepthRepair::Nearer, &[[30.0, 5.0], [30.0, 25.0]], 3.0);
        let repaired = |stroke, pixel_scale| {
            apply_depth_strokes(SIZE, disparity.clone(), &picture, &[stroke], pixel_scale)
        };
        assert_eq!(repaired(fine, 2.0), repaired(coarse, 1.0));
    }

    #[test]
    fn strokes_beyond_reason_change_nothing() {
        let wide = DepthStroke { radius_px: f32::INFINITY, ..stroke(DepthRepair::Nearer, &[[1.0; 2]], 1.0) };
        let lost = stroke(DepthRepair::Nearer, &[[f32::NAN; 2]], 3.0);
        let flat = DepthStroke { radius_px: 0.0, ..wide.clone() };
        assert_eq!(after(&[wide, lost, flat, stroke(DepthRepair::Smooth, &[], 3.0)]), card().0);
        let large = stroke(DepthRepair::Nearer, &[[-1e6; 2], [1e6; 2]], 1e6);
        assert!(after(&[large]).iter().all(|&value| value >= 0.1 - 1e-6));
    }
}
