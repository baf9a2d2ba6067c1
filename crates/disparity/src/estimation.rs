//! The stages from views to disparities.

use crate::error::DisparityError;
use crate::map::DisparityMap;
use crate::matching::coarse::{CoarseEstimate, estimate_coarse, select_spread_views, shrink_factor};
use crate::matching::labels::Labels;
use crate::matching::match_labels;
use crate::matching::sweep::ShiftedView;
use crate::noise::estimate_noise;
use crate::other_view::{fill_holes, warp};
use crate::planes::Planes;
use crate::refinement::Refinement;
use crate::refinement::evidence::Evidence;
use crate::request::DisparityRequest;
use crate::specks::remove_specks;
use crate::validation::validate;
use crate::view::View;
use crate::vignetting::Gain;
use progress::{Cancelled, Progress, Stage};
use rayon::prelude::*;

/// Spacing of labels: pixels in the farthest view. Refinement resolves finer steps.
const STEP_PX: f32 = 0.3;

/// The most labels: 0.3 pixels at a parallax of 75; wider ranges have wider steps.
const MAX_LABELS: usize = 250;

/// Standard deviation, in pixels of the farthest view, at which confidence is halved.
const HALF_CONFIDENCE_PX: f32 = 0.15;

/// The disparities of the reference, then of the other requested views, in that order.
///
/// # Errors
/// The views are fewer than two, differ in size, share a position or hold non-finite values; a requested view or range does not exist; or
/// `progress` cancels.
pub fn estimate_disparities(
    views: &[View<'_>],
    request: &DisparityRequest,
    progress: &dyn Progress,
) -> Result<Vec<DisparityMap>, DisparityError> {
    validate(views, request)?;
    let field = prepare_field(views, request, &Stage::new(progress, 0.0, 0.15))?;
    let reference = request.reference;
    let share = if request.others.is_empty() { 1.0 } else { 0.5 };
    let first = field.reference_map(reference, &Stage::new(progress, 0.15, share))?;
    let mut maps = vec![first];
    for (k, &view) in request.others.iter().enumerate() {
        let part = |k: usize| share + (1.0 - share) * k as f32 / request.others.len() as f32;
        let stage = Stage::new(progress, part(k), part(k + 1));
        let map =
            if view == reference { maps[0].clone() } else { field.other_map(&maps[0], view, &stage)? };
        maps.push(map);
    }
    progress.report(1.0);
    Ok(maps)
}

/// Views after vignetting compensation, and the labels.
struct PreparedField {
    planes: Vec<Planes>,
    places: Vec<[f64; 2]>,
    weights: Vec<f32>,
    labels: Labels,
    /// The largest coordinate of an offset from the reference.
    reach: f32,
    noise: std::sync::OnceLock<f32>,
}

/// Compensates vignetting and estimates the range of disparities, on small pictures.
fn prepare_field(
    views: &[View<'_>],
    request: &DisparityRequest,
    progress: &dyn Progress,
) -> Result<PreparedField, Cancelled> {
    let mut planes: Vec<Planes> = views.par_iter().map(|view| Planes::from_picture(&view.picture)).collect();
    let places: Vec<[f64; 2]> = views.iter().map(|view| view.position).collect();
    let offsets: Vec<[f32; 2]> =
        places.iter().map(|place| offset(places[request.reference], *place)).collect();
    let reach = offsets.iter().flatten().fold(0.0f32, |reach, o| reach.max(o.abs()));
    let factor = shrink_factor(planes[0].width(), planes[0].height());
    let mut small: Vec<Planes> = planes.par_iter().map(|planes| planes.shrunk(factor)).collect();
    let reference = small[request.reference].clone();
    progress.report(0.3);
    progress.check()?;

    // Once without parallax, once with the coarse estimate of it.
    let coarse = |disparity: Option<&[f32]>, small: &[Planes]| -> Vec<Gain> {
        let gains = small.par_iter().zip(&offsets);
        gains.map(|(view, offset)| Gain::fit(&reference, view, *offset, disparity)).collect()
    };
    let rough = coarse(None, &small);
    let rough_weights: Vec<f32> =
        small.par_iter_mut().zip(&rough).map(|(view, gain)| gain.apply(view)).collect();
    let others: Vec<usize> = (0..views.len()).filter(|view| *view != request.reference).collect();
    let other_offsets: Vec<[f32; 2]> = others.iter().map(|&view| offsets[view]).collect();
    let shifted: Vec<ShiftedView<'_>> = select_spread_views(&other_offsets)
        .into_iter()
        .map(|k| others[k])
        .map(|view| ShiftedView { planes: &small[view], offset: offsets[view], weight: rough_weights[view] })
        .collect();
    let scale = 1.0 / factor as f32;
    let range = request.range.map(|(low, high)| (low * scale, high * scale));
    let CoarseEstimate { disparity, range: estimated_range } =
        estimate_coarse(&reference, &shifted, reach, range, &Stage::new(progress, 0.3, 0.8))?;
    let fine = coarse(Some(&disparity), &small);
    let mut weights: Vec<f32> = planes
        .par_iter_mut()
        .zip(rough.par_iter().zip(&fine))
        .map(|(view, (rough, fine))| rough.apply(view) * fine.apply(view))
        .collect();
    weights[request.reference] = 1.0;

    // A given range is used as it is; an estimated one ends where the coarse estimate does.
    let (low, high) = request.range.unwrap_or((estimated_range.0 / scale, estimated_range.1 / scale));
    let step = (STEP_PX / reach).max((high - low) / (MAX_LABELS - 1) as f32);
    let labels = Labels::covering(low, high, step);
    Ok(PreparedField { planes, places, weights, labels, reach, noise: std::sync::OnceLock::new() })
}

/// Some of the views, spread evenly.
fn spread_views<'a>(views: &[ShiftedView<'a>]) -> Vec<ShiftedView<'a>> {
    let offsets: Vec<_> = views.iter().map(|view| view.offset).collect();
    select_spread_views(&offsets).into_iter().map(|k| views[k]).collect()
}

/// The offset from one position to another.
fn offset(from: [f64; 2], to: [f64; 2]) -> [f32; 2] {
    std::array::from_fn(|k| (to[k] - from[k]) as f32)
}

impl PreparedField {
    /// All other views as shifted relative to one.
    fn shifted(&self, reference: usize) -> Vec<ShiftedView<'_>> {
        (0..self.planes.len())
            .filter(|view| *view != reference)
            .map(|view| ShiftedView {
                planes: &self.planes[view],
                offset: offset(self.places[reference], self.places[view]),
                weight: self.weights[view],
            })
            .collect()
    }

    fn reference_map(&self, view: usize, progress: &dyn Progress) -> Result<DisparityMap, Cancelled> {
        let (picture, others) = (&self.planes[view], self.shifted(view));
        let subset = spread_views(&others);
        let chosen = match_labels(picture, &others, &self.labels, &Stage::new(progress, 0.0, 0.5))?;
        let labelled: Vec<f32> = chosen.iter().map(|choice| choice.disparity).collect();
        // Disparities of one surface differ by three labels at most.
        let same = 3.0 * self.labels.step;
        let mut disparity = remove_specks(&labelled, picture.width(), same);
        let noise = *self.noise.get_or_init(|| estimate_noise(picture, &others, &disparity));
        let refinement = Refinement {
            reference: picture,
            others: &others,
            subset: &subset,
            labels: self.labels,
            noise,
            reach: self.reach,
        };
        let evidence = refinement.run(&mut disparity, &|_| false, &Stage::new(progress, 0.5, 1.0))?;
        let disparity = remove_specks(&disparity, picture.width(), same);
        let confidence = evidence.iter().map(|pixel| self.confidence(pixel)).collect();
        Ok(DisparityMap { view, width: picture.width(), height: picture.height(), disparity, confidence })
    }

    fn other_map(
        &self,
        reference: &DisparityMap,
        view: usize,
        progress: &dyn Progress,
    ) -> Result<DisparityMap, Cancelled> {
        let (picture, others) = (&self.planes[view], self.shifted(view));
        let from = offset(self.places[reference.view], self.places[view]);
        let warped = warp(&reference.disparity, &reference.confidence, reference.width, from);
        let chosen = spread_views(&others);
        let noise = self.noise.get().copied().unwrap_or_default();
        let refinement = Refinement {
            reference: picture,
            others: &chosen,
            subset: &chosen,
            labels: self.labels,
            noise,
            reach: self.reach,
        };
        let (disparity, evidence) = fill_holes(&refinement, &warped.disparity, &chosen, progress)?;
        let disparity = remove_specks(&disparity, picture.width(), 3.0 * self.labels.step);
        let confidence = (0..disparity.len())
            .map(|i| {
                if warped.disparity[i].is_nan() {
                    self.confidence(&evidence[i])
                } else {
                    warped.confidence[i]
                }
            })
            .collect();
        Ok(DisparityMap { view, width: picture.width(), height: picture.height(), disparity, confidence })
    }

    /// Agreement of the views in which a point is visible, how many they are, and how sharply they determine its
    /// place.
    fn confidence(&self, evidence: &Evidence) -> f32 {
        let half = (self.reach / HALF_CONFIDENCE_PX).powi(2);
        let sharpness = evidence.certainty / (evidence.certainty + half);
        (evidence.agreement * evidence.agreement * evidence.visibility * sharpness).clamp(0.0, 1.0)
    }
}
