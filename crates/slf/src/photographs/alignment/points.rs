//! Surface points that photographs are compared at, and what each is expected to show there.

use super::fitting::Comparison;
use super::halves::{Fold, fold_of};
use super::lattice::Displacement;
use crate::photographs::exposures::Exposure;
use crate::photographs::odd::InlierMap;
use crate::photographs::places::TexelBlocks;
use crate::photographs::seeing::{Observation, PackedPicture};
use crate::photographs::telling::{CalibratedObservations, Sample, robust_mean, roots};
use glam::{DVec2, Vec3};
use rayon::prelude::*;
use scene::View;

/// Points that a photograph is asked at, about.
const POINTS_PER_VIEW: usize = 12_000;
/// A point that fewer photographs see says nothing.
const MIN_VIEWS: usize = 3;
/// Others that tell a photograph what to expect count so much at least.
const MIN_OTHERS_WEIGHT: f32 = 0.3;

/// A point as a photograph sees it.
struct PointView {
    view: u16,
    weight: f32,
    /// Where its camera says that it is.
    pixel: DVec2,
    /// What undoes its exposure there.
    to_radiance: Vec3,
}

/// All points.
pub(super) struct ComparisonPoints {
    /// By point.
    all: Vec<Vec<PointView>>,
    /// By view: the points that it sees, and its place among those that do.
    by_view: Vec<Vec<(u32, u16)>>,
}

/// By point and photograph that sees it: what others lead to expect, if they do.
pub(super) type Predictions = Vec<Vec<Option<f32>>>;

impl ComparisonPoints {
    /// Texels that may be asked, not too many of them, where photographs belong.
    pub fn new(
        radiance: &CalibratedObservations<'_>,
        views: &[View],
        exposures: &[Exposure],
        inlier_maps: &[InlierMap],
    ) -> Self {
        let (texels, observations) = (radiance.texels, radiance.observations);
        let blocks = TexelBlocks::new(texels.size());
        let is_usable = |texel: &usize| {
            observations.range(*texel).len() >= MIN_VIEWS && fold_of(&blocks, texels, *texel) == Fold::Fitting
        };
        let candidates: Vec<usize> = (0..texels.count()).filter(is_usable).collect();
        let count: usize = candidates.iter().map(|&texel| observations.range(texel).len()).sum();
        let step = count.div_ceil(POINTS_PER_VIEW * views.len()).max(1);
        let texel_views = |&texel: &usize| -> Vec<PointView> {
            let point_view = |observation: &Observation| {
                let number = usize::from(observation.view);
                let pixel = views[number].project(texels.position(texel))?;
                let weight = observation.weight() * inlier_maps[number].at(pixel);
                let to_radiance = exposures[number].to_radiance(&views[number], pixel);
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

    /// What others lead to expect of each photograph at each point that it sees, all displaced.
    pub fn predict(&self, pictures: &[PackedPicture], displacements: &[Displacement]) -> Predictions {
        let predict_point = |(samples, inlier_weights): &mut (Vec<Sample>, Vec<f32>),
                             point_views: &Vec<PointView>| {
            samples.clear();
            samples.extend(point_views.iter().map(|point_view| {
                let number = usize::from(point_view.view);
                let picture = &pictures[number];
                let shown = picture.at(picture.place(displacements[number].moved(point_view.pixel)));
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
                // What was at its limit is not where it seems to be.
                let is_predictable = sample.clipped == 0.0 && others >= MIN_OTHERS_WEIGHT;
                is_predictable.then(|| mean_root((mean * all - sample.light * own) / others))
            };
            samples.iter().zip(&*inlier_weights).map(predict_from_others).collect()
        };
        self.all.par_iter().map_init(Default::default, predict_point).collect()
    }

    /// A photograph, displaced, beside what others lead to expect.
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

/// The mean root of its channels: noise is about the same for dark and bright.
fn mean_root(light: Vec3) -> f32 {
    roots(light).element_sum() / 3.0
}
