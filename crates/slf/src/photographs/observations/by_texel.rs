//! Observations of texels by photographs: weight and light.
//!
//! Each photograph is read once. Its [`DepthMap`](super::depth_map::DepthMap) decides what it observes: the weight, in
//! (0, 1], falls smoothly to 0 toward depth edges, the picture's border and grazing angles, so that no contribution
//! starts or ends abruptly on the surface.

use super::depth_map::MAX_EDGE_DISTANCE;
use super::loading::{LoadedView, ViewLoader};
use super::packed_picture::PackedPicture;
use crate::photographs::error::PhotographError;
use crate::photographs::texels::{DirectionGrid, Texels};
use glam::{DVec2, DVec3, Vec3};
use numerics::smoothstep;
use progress::{Progress, Stage};
use rayon::prelude::*;
use scene::{Scene, View};
use std::ops::Range;

/// Cosines between which a grazing view ramps from no weight to full weight; grazing pixels mix neighbouring texels.
const GRAZING_COSINES: [f32; 2] = [0.08, 0.35];
/// Distances from a depth edge between which the weight ramps up, px.
const EDGE_RAMP_PX: [f32; 2] = [1.0, 4.0];
/// The same for the background, as shares of the picture's longer side. Meshes end too early, and the parts they lack
/// are next to their outlines.
const BACKGROUND_EDGE_RAMP: [f32; 2] = [0.01, 0.04];
/// The same from the picture's border, px.
const BORDER_RAMP_PX: [f32; 2] = [1.0, 8.0];

/// One photograph's observation of one texel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Observation {
    pub view: u16,
    /// Weight in (0, 1], in 255ths.
    weight: u8,
    /// Share of clipped pixels, in 127ths, combined with [`BLOCKED`].
    clipped: u8,
    /// Square roots of linear light, on the photograph's own scale until [`Observations::scale_light`].
    root: [u16; 3],
}

/// All observations of the surface and the background.
pub(crate) struct Observations {
    pub pictures: Vec<PackedPicture>,
    /// `all[start[t]..start[t + 1]]` belong to texel t, by view.
    start: Vec<u32>,
    all: Vec<Observation>,
    /// By view and cell of a [`DirectionGrid`]: weight of its observation as background, in 255ths.
    pub background_weights: Vec<Vec<u8>>,
    brightest: f32,
}

/// Flag of an observation: the texel mirrors another part of the scene toward the photograph.
const BLOCKED: u8 = 128;

impl Observation {
    /// The observation's weight, in [0, 1].
    pub fn weight(&self) -> f32 {
        f32::from(self.weight) / 255.0
    }

    /// The share of it that is clipped in the photograph, in [0, 1].
    pub fn clipped(&self) -> f32 {
        f32::from(self.clipped & !BLOCKED) / 127.0
    }

    /// Whether the texel mirrors another part of the scene toward the photograph rather than the surroundings.
    pub fn is_blocked(&self) -> bool {
        self.clipped & BLOCKED != 0
    }
}

impl Observations {
    /// Loads the photographs and collects what they show of texels and of cells at infinity.
    ///
    /// # Errors
    /// The error of the first view, by order, whose picture or mask cannot be read; [`PhotographError::Cancelled`] if
    /// `progress` asks to stop.
    pub fn new(
        scene: &Scene,
        texels: &Texels,
        sphere: &DirectionGrid,
        views: &[View],
        loader: &ViewLoader<'_>,
        progress: &dyn Progress,
    ) -> Result<Self, PhotographError> {
        let loaded_views =
            loader.load_each(scene, views, &Stage::new(progress, 0.0, 0.8), |view, loaded| {
                let visibility = ViewVisibility { view, loaded: &loaded };
                let weights = (visibility.texel_weights(texels), visibility.background_weights(sphere));
                (loaded.picture, weights)
            })?;
        let (pictures, weights_by_view): (Vec<_>, Vec<_>) = loaded_views.into_iter().unzip();
        let (mut weights, background_weights): (Vec<_>, Vec<_>) = weights_by_view.into_iter().unzip();
        retain_one_side(texels, views, &mut weights);
        let brightest = pictures.iter().map(PackedPicture::brightest).fold(1.0, f32::max);
        let (start, all) = gather_observations(texels, views, &pictures, &weights, brightest);
        Ok(Self { pictures, start, all, background_weights, brightest })
    }

    /// Observations of a texel, in the order of the views.
    pub fn of_texel(&self, texel: usize) -> &[Observation] {
        &self.all[self.range(texel)]
    }

    /// The range of a texel's observations in the list of all.
    pub fn range(&self, texel: usize) -> Range<usize> {
        self.start[texel] as usize..self.start[texel + 1] as usize
    }

    /// The number of all observations.
    pub fn count(&self) -> usize {
        self.all.len()
    }

    /// Multiplies the light of each view at a pixel position by a factor of at most `max_factor`.
    pub fn scale_light(
        &mut self,
        texels: &Texels,
        views: &[View],
        max_factor: f32,
        factor: impl Fn(usize, DVec2) -> Vec3 + Sync,
    ) {
        let before = self.brightest;
        self.brightest *= max_factor.max(1.0);
        let after = self.brightest;
        self.update_projected(texels, views, |observation, view_index, pixel| {
            observation.root =
                encode_light(decode_light(observation.root, before) * factor(view_index, pixel), after);
        });
    }

    /// Resamples views at other pixel positions: `elsewhere` returns the new position and a factor for the light there,
    /// or `None` to leave the observation unchanged. Positions near the border lose weight.
    pub fn resample(
        &mut self,
        texels: &Texels,
        views: &[View],
        elsewhere: impl Fn(usize, DVec2) -> Option<(DVec2, Vec3)> + Sync,
    ) {
        let (brightest, pictures) = (self.brightest, std::mem::take(&mut self.pictures));
        self.update_projected(texels, views, |observation, view_index, pixel| {
            if let Some((pixel, factor)) = elsewhere(view_index, pixel) {
                let picture = &pictures[view_index];
                let place = picture.place(pixel);
                let sample = picture.at(place);
                observation.root = encode_light(sample.light * factor, brightest);
                observation.clipped = quantize_127(sample.clipped);
                observation.weight =
                    quantize_255(observation.weight() * border_weight(picture, place)).max(1);
            }
        });
        self.pictures = pictures;
    }

    /// Multiplies the weight of each view at a pixel position by a share in [0, 1].
    pub fn reweight(&mut self, texels: &Texels, views: &[View], share: impl Fn(usize, DVec2) -> f32 + Sync) {
        self.update_projected(texels, views, |observation, view_index, pixel| {
            // Rejected observations keep a minimal weight, since they keep their place in the list.
            observation.weight = quantize_255(observation.weight() * share(view_index, pixel)).max(1);
        });
    }

    /// Sets for each texel and view whether the mirrored direction is blocked by the scene.
    pub fn mark_blocked(&mut self, is_blocked: impl Fn(usize, usize) -> bool + Sync) {
        self.update_each(|observation, texel| {
            observation.clipped &= !BLOCKED;
            if is_blocked(texel, usize::from(observation.view)) {
                observation.clipped |= BLOCKED;
            }
        });
    }

    /// Updates all observations, each with its view's index and its pixel position.
    fn update_projected(
        &mut self,
        texels: &Texels,
        views: &[View],
        update: impl Fn(&mut Observation, usize, DVec2) + Sync,
    ) {
        self.update_each(|observation, texel| {
            let view_index = usize::from(observation.view);
            // Cannot fail: the same lens projected the point before.
            let pixel = views[view_index].project(texels.position(texel)).unwrap_or_default();
            update(observation, view_index, pixel);
        });
    }

    /// Updates all observations, each with its texel.
    fn update_each(&mut self, update: impl Fn(&mut Observation, usize) + Sync) {
        let start = &self.start;
        texel_chunks(start, &mut self.all).into_par_iter().for_each(|(range, block)| {
            let first = start[range.start];
            for texel in range {
                let (from, to) = (start[texel] - first, start[texel + 1] - first);
                block[from as usize..to as usize]
                    .iter_mut()
                    .for_each(|observation| update(observation, texel));
            }
        });
    }

    /// The light of an observation, linear RGB.
    pub fn light(&self, observation: &Observation) -> Vec3 {
        decode_light(observation.root, self.brightest)
    }
}

/// Splits the texels into chunks for parallel work, each with its observations; `start` lists where those of each texel
/// begin.
fn texel_chunks<'a>(start: &[u32], all: &'a mut [Observation]) -> Vec<(Range<usize>, &'a mut [Observation])> {
    const CHUNK: usize = 4096;
    let texels = start.len() - 1;
    let mut rest = all;
    let mut blocks = Vec::new();
    for first in (0..texels).step_by(CHUNK) {
        let range = first..(first + CHUNK).min(texels);
        let (block, after) = rest.split_at_mut((start[range.end] - start[range.start]) as usize);
        blocks.push((range, block));
        rest = after;
    }
    blocks
}

fn decode_light(root: [u16; 3], brightest: f32) -> Vec3 {
    let root = Vec3::from_array(root.map(|v| f32::from(v) / 65535.0));
    root * root * brightest
}

fn encode_light(light: Vec3, brightest: f32) -> [u16; 3] {
    light.to_array().map(|v| ((v / brightest).clamp(0.0, 1.0).sqrt() * 65535.0 + 0.5) as u16)
}

/// Weight of a position at this distance from a depth edge.
fn edge_weight(pixels: u8, ramp_px: [f32; 2]) -> f32 {
    // Distances are measured no farther.
    if pixels >= MAX_EDGE_DISTANCE { 1.0 } else { smoothstep(f32::from(pixels), ramp_px) }
}

/// A loaded photograph, to determine what it observes.
pub(crate) struct ViewVisibility<'a> {
    pub view: &'a View,
    pub loaded: &'a LoadedView,
}

impl ViewVisibility<'_> {
    /// Weights of all texels, in 255ths; 0 if not observed.
    fn texel_weights(&self, texels: &Texels) -> Vec<u8> {
        let weight = |texel: usize| self.surface_weight(texels.position(texel), texels.normal(texel));
        (0..texels.count()).into_par_iter().map(|texel| quantize_255(weight(texel))).collect()
    }

    /// Weight of a surface position with this normal, in [0, 1]; 0 if not observed.
    pub fn surface_weight(&self, position: DVec3, normal: Vec3) -> f32 {
        let cosine = normal.dot((self.view.position() - position).as_vec3().normalize_or_zero()).abs();
        let angle_weight = smoothstep(cosine, GRAZING_COSINES);
        if angle_weight == 0.0 {
            return 0.0;
        }
        angle_weight
            * self.position_weight(position, EDGE_RAMP_PX, |place| {
                self.loaded.depth.visible_edge_distance(self.view, position, place)
            })
    }

    /// Weights of all cells at infinity, in 255ths.
    fn background_weights(&self, sphere: &DirectionGrid) -> Vec<u8> {
        let eye = self.view.position();
        let longer = self.loaded.picture.width.max(self.loaded.picture.height) as f32;
        let ramp_px = BACKGROUND_EDGE_RAMP.map(|share| share * longer);
        let weight = |cell: usize| {
            let position = eye + sphere.direction(cell).as_dvec3();
            self.position_weight(position, ramp_px, |place| self.loaded.depth.background_edge_distance(place))
        };
        (0..sphere.count()).map(|cell| quantize_255(weight(cell))).collect()
    }

    /// Weight of a position for which `edge_distance` returns a distance from edges, px.
    fn position_weight(
        &self,
        position: DVec3,
        ramp_px: [f32; 2],
        edge_distance: impl Fn(DVec2) -> Option<u8>,
    ) -> f32 {
        let Some(pixel) = self.view.project(position) else { return 0.0 };
        let place = self.loaded.picture.place(pixel);
        let Some(pixels) = edge_distance(place) else { return 0.0 };
        edge_weight(pixels, ramp_px) * self.picture_weight(pixel, place)
    }

    /// Weight of a position in the picture alone: distance from the border, and the mask.
    fn picture_weight(&self, pixel: DVec2, place: DVec2) -> f32 {
        if !self.view.lens.is_in_picture(pixel) {
            return 0.0;
        }
        let is_masked = self.loaded.mask.as_ref().is_some_and(|mask| {
            let (x, y) = (pixel.x as u32, pixel.y as u32);
            x < mask.width && y < mask.height && !mask.is_valid[(y * mask.width + x) as usize]
        });
        if is_masked {
            return 0.0;
        }
        border_weight(&self.loaded.picture, place)
    }
}

/// Weight of a position by its distance from the picture's border.
pub(crate) fn border_weight(picture: &PackedPicture, place: DVec2) -> f32 {
    let size = DVec2::new(f64::from(picture.width), f64::from(picture.height));
    smoothstep(place.min(size - place).min_element() as f32, BORDER_RAMP_PX)
}

fn quantize_255(share: f32) -> u8 {
    (share * 255.0 + 0.5) as u8
}

fn quantize_127(share: f32) -> u8 {
    (share.clamp(0.0, 1.0) * 127.0 + 0.5) as u8
}

/// A texel has one light, so only views of its better observed side (front or back) count.
fn retain_one_side(texels: &Texels, views: &[View], weights: &mut [Vec<u8>]) {
    let is_front = |texel: usize, view: &View| {
        texels.normal(texel).as_dvec3().dot(view.position() - texels.position(texel)) >= 0.0
    };
    let front_wins: Vec<bool> = (0..texels.count())
        .into_par_iter()
        .map(|texel| {
            let balance: i32 = views
                .iter()
                .zip(&*weights)
                .filter(|(_, weights)| weights[texel] > 0)
                .map(
                    |(view, w)| {
                        if is_front(texel, view) { i32::from(w[texel]) } else { -i32::from(w[texel]) }
                    },
                )
                .sum();
            balance >= 0
        })
        .collect();
    weights.par_iter_mut().zip(views).for_each(|(weights, view)| {
        for (texel, weight) in weights.iter_mut().enumerate() {
            if *weight > 0 && is_front(texel, view) != front_wins[texel] {
                *weight = 0;
            }
        }
    });
}

/// All observations, by texel.
fn gather_observations(
    texels: &Texels,
    views: &[View],
    pictures: &[PackedPicture],
    weights: &[Vec<u8>],
    brightest: f32,
) -> (Vec<u32>, Vec<Observation>) {
    let mut start = vec![0u32; texels.count() + 1];
    for texel in 0..texels.count() {
        let count = weights.iter().filter(|weights| weights[texel] > 0).count() as u32;
        start[texel + 1] = start[texel] + count;
    }
    let empty = Observation { view: 0, weight: 0, clipped: 0, root: [0; 3] };
    let mut all = vec![empty; start[texels.count()] as usize];
    texel_chunks(&start, &mut all).into_par_iter().for_each(|(range, block)| {
        let mut slots = block.iter_mut();
        for texel in range {
            for (view_index, view) in views.iter().enumerate() {
                let weight = weights[view_index][texel];
                if weight == 0 {
                    continue;
                }
                let Some(slot) = slots.next() else { return };
                let position: DVec3 = texels.position(texel);
                // Cannot fail: the same lens projected the point before.
                let pixel = view.project(position).unwrap_or_default();
                let sample = pictures[view_index].at(pictures[view_index].place(pixel));
                let clipped = quantize_127(sample.clipped);
                *slot = Observation {
                    view: view_index as u16,
                    weight,
                    clipped,
                    root: encode_light(sample.light, brightest),
                };
            }
        }
    });
    (start, all)
}
