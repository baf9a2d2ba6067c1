//! Surface points at which photographs are compared, and the predicted value of each photograph there.

use super::folds::{Fold, fold_of};
use super::gauss_newton::Comparison;
use super::lattice::Displacement;
use crate::photographs::exposures::Exposure;
use crate::photographs::fitting::{CalibratedObservations, Sample, robust_mean, roots};
use crate::photographs::observations::{Observation, PackedPicture};
use crate::photographs::texels::TexelBlocks;
use crate::photographs::transients::InlierMap;
use glam::{DVec2, Vec3};
use rayon::prelude::*;
use scene::View;

/// Approximate number of points compared per photograph.
const POINTS_PER_VIEW: usize = 12_000;
/// Points observed by fewer photographs are skipped.
const MIN_VIEWS: usize = 3;
/// Minimum total weight of the other photographs for a prediction.
const MIN_OTHERS_WEIGHT: f32 = 0.3;

/// A point as observed by one photograph.
struct PointView {
    view: u16,
    weight: f32,
    /// Projection of the point by the photograph's camera, px.
    pixel: DVec2,
    /// Factor from pixel values to radiance there.
    to_radiance: Vec3,
}

/// The points of the comparison.
pub(super) struct ComparisonPoints {
    /// Observations by point.
    all: Vec<Vec<PointView>>,
    /// By view: the points it observes, and the index of its observation among those of the point.
    by_view: Vec<Vec<(u32, u16)>>,
}

/// By point and observing photograph: the value predicted by the others, if it can be predicted.
pub(super) type Predictions = Vec<Vec<Option<f32>>>;

impl ComparisonPoints {
    /// Selects a limited number of texels of the fitting fold, without transient objects.
    pub fn new(
        calibrated: &CalibratedObservations<'_>,
        views: &[View],
        exposures: &[Exposure],
        inlier_maps: &[InlierMap],
    ) -> Self {
        let (texels, observations) = (calibrated.texels, calibrated.observations);
        let blocks = TexelBlocks::new(texels.size());
        let is_usable = |texel: &usize| {
            observations.range(*texel).len() >= MIN_VIEWS && fold_of(&blocks, texels, *texel) == Fold::Fitting
        };
        let candidates: Vec<usize> = (0..texels.count()).filter(is_usable).collect();
        let count: usize = candidates.iter().map(|&texel| observations.range(texel).len()).sum();
        let step = count.div_ceil(POINTS_PER_VIEW * views.len()).max(1);
        let texel_views = |&texel: &usize| -> Vec<PointView> {
            let point_view = |observation: &Observation| {
                let view_index = usize::from(observation.view);
                let pixel = views[view_index].project(texels.position(texel))?;
                let weight = observation.weight() * inlier_maps[view_index].at(pixel);
                let to_radiance = exposures[view_index].to_radiance(&views[view_index], pixel);
                (weight > 0.0).then_some(PointView { view: observation.view, weight, pixel, to_radiance })
            };
            observations.of_texel(texel).iter().filter_map(point_view).collect()
        };
        let all: Vec<Vec<PointView>> = candidates.par_iter().step_by(step).map(texel_views).collect();
        let mut by_view = vec![Vec::new(); views.len()];
        for (point, point_views) in all.iter().enumerate() {
            for (index, point_view) in point_views.iter().enumerate() {
                by_view[usize::from(point_view.view)].push((point as u32, index as u16));
            }
        }
        Self { all, by_view }
    }

    /// What the others predict each photograph to show at each of its points, with all displacements applied.
    pub fn predict(&self, pictures: &[PackedPicture], displacements: &[Displacement]) -> Predictions {
        let predict_point = |(samples, inlier_weights): &mut (Vec<Sample>, Vec<f32>),
                             point_views: &Vec<PointView>| {
            samples.clear();
            samples.extend(point_views.iter().map(|point_view| {
                let view_index = usize::from(point_view.view);
                let picture = &pictures[view_index];
                let shown = picture.at(picture.place(displacements[view_index].moved(point_view.pixel)));
                let clipped = shown.clipped.clamp(0.0, 1.0);
                Sample { light: shown.light * point_view.to_radiance, weight: point_view.weight, clipped }
            }));
            let mean = robust_mean(samples, inlier_weights);
            let effective_weight =
                |(sample, inlier_weight): (&Sample, &f32)| sample.weight_against(mean) * inlier_weight;
            let all: f32 = samples.iter().zip(&*inlier_weights).map(effective_weight).sum();
            let predict_from_others = |(sample, inlier_weight): (&Sample, &f32)| {
                let own = effective_weight((sample, inlier_weight));
                let others = all - own;
                // The position of clipped pixels is unreliable.
                let is_predictable = sample.clipped == 0.0 && others >= MIN_OTHERS_WEIGHT;
                is_predictable.then(|| mean_root((mean * all - sample.light * own) / others))
            };
            samples.iter().zip(&*inlier_weights).map(predict_from_others).collect()
        };
        self.all.par_iter().map_init(Default::default, predict_point).collect()
    }

    /// Compares what the displaced photograph of view `view` shows at its points with the predictions. Points without
    /// a prediction are left out.
    pub fn compare(
        &self,
        view: usize,
        picture: &PackedPicture,
        displacement: &Displacement,
        predictions: &Predictions,
    ) -> Vec<Comparison> {
        let step = f64::from(picture.reduction);
        let compare_point = |&(point, index): &(u32, u16)| {
            let (point, index) = (point as usize, usize::from(index));
            let predicted = predictions[point][index]?;
            let point_view = &self.all[point][index];
            let at = displacement.moved(point_view.pixel);
            let shown = |pixel: DVec2| {
                let shown = picture.at(picture.place(pixel));
                f64::from(mean_root(shown.light * point_view.to_radiance))
            };
            let gradient_along =
                |axis: DVec2| (shown(at + axis * step) - shown(at - axis * step)) / (2.0 * step);
            Some(Comparison {
                pixel: point_view.pixel,
                residual: f64::from(predicted) - shown(at),
                slope: DVec2::new(gradient_along(DVec2::X), gradient_along(DVec2::Y)),
                weight: f64::from(point_view.weight),
            })
        };
        self.by_view[view].iter().filter_map(compare_point).collect()
    }
}

/// Mean square root over the channels; noise of roots is about the same for dark and bright.
fn mean_root(light: Vec3) -> f32 {
    roots(light).element_sum() / 3.0
}
