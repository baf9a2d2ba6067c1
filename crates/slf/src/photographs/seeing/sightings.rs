//! Which photograph sees which texel, how well, and what it shows there.
//!
//! A photograph is read once. What it sees is told by its [`DepthPicture`]: a weight in (0, 1] that falls smoothly to 0 toward edges of
//! depth, the picture's border and glancing angles, so that nothing begins or ends abruptly on the surface.

use super::depth_picture::MAX_EDGE_DISTANCE;
use super::kept_picture::PackedPicture;
use super::reading::{LoadedView, ViewLoader};
use crate::photographs::error::PhotographError;
use crate::photographs::numbers::ramp;
use crate::photographs::places::{DirectionGrid, Texels};
use glam::{DVec2, DVec3, Vec3};
use progress::{Progress, Stage};
use rayon::prelude::*;
use scene::{Scene, View};
use std::ops::Range;

/// Glancing views (cosine) see nothing that can be told from its neighbours; from the second value on they count in full.
const GRAZING_COSINES: [f32; 2] = [0.08, 0.35];
/// So many pixels from an edge of depth a photograph begins to count, and counts in full.
const EDGE_RAMP_PX: [f32; 2] = [1.0, 4.0];
/// The same for what is beyond the surface, in shares of the picture's longer side: meshes end early, and what they left out stands
/// beside them.
const BACKGROUND_EDGE_RAMP: [f32; 2] = [0.01, 0.04];
/// The same from the picture's border.
const BORDER_RAMP_PX: [f32; 2] = [1.0, 8.0];

/// What a texel looks like to one photograph.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Observation {
    pub view: u16,
    /// How well it is seen, in (0, 1] by 255ths.
    weight: u8,
    /// The share of clipped pixels, by 127ths; [`BLOCKED`] beside it.
    clipped: u8,
    /// Linear light, as the photograph has it until that is scaled, as square roots.
    root: [u16; 3],
}

/// Everything that photographs show of the surface.
pub(crate) struct Observations {
    pub pictures: Vec<PackedPicture>,
    /// `all[start[t]..start[t + 1]]` are of texel t, by view.
    start: Vec<u32>,
    all: Vec<Observation>,
    /// By view, how well each cell of a [`Sphere`] is seen beyond the surface, by 255ths.
    pub background_weights: Vec<Vec<u8>>,
    brightest: f32,
}

/// Of a sighting: what the texel mirrors toward the photograph is another part of the scene.
const BLOCKED: u8 = 128;

impl Observation {
    pub fn weight(&self) -> f32 {
        f32::from(self.weight) / 255.0
    }

    pub fn clipped(&self) -> f32 {
        f32::from(self.clipped & !BLOCKED) / 127.0
    }

    /// Whether what the texel mirrors toward the photograph is another part of the scene, and not what surrounds it.
    pub fn is_blocked(&self) -> bool {
        self.clipped & BLOCKED != 0
    }
}

impl Observations {
    /// Reads the photographs and looks what they see of texels and of cells at infinity.
    ///
    /// # Errors
    /// The first view's, by order, whose picture or mask cannot be had; that the work was stopped.
    pub fn new(
        scene: &Scene,
        texels: &Texels,
        sphere: &DirectionGrid,
        views: &[View],
        loader: &ViewLoader<'_>,
        progress: &dyn Progress,
    ) -> Result<Self, PhotographError> {
        let loaded_views =
            loader.load_each(scene, views, &Stage::new(progress, 0.0, 0.8), |view, loaded_views| {
                let visibility = ViewVisibility { view, loaded: &loaded_views };
                let weights = (visibility.texel_weights(texels), visibility.background_weights(sphere));
                (loaded_views.picture, weights)
            })?;
        let (pictures, weights_by_view): (Vec<_>, Vec<_>) = loaded_views.into_iter().unzip();
        let (mut weights, background_weights): (Vec<_>, Vec<_>) = weights_by_view.into_iter().unzip();
        retain_one_side(texels, views, &mut weights);
        let brightest = pictures.iter().map(PackedPicture::brightest).fold(1.0, f32::max);
        let (start, all) = gather_observations(texels, views, &pictures, &weights, brightest);
        Ok(Self { pictures, start, all, background_weights, brightest })
    }

    /// What photographs show of a texel, by view.
    pub fn of_texel(&self, texel: usize) -> &[Observation] {
        &self.all[self.range(texel)]
    }

    /// The numbers of a texel's sightings among all.
    pub fn range(&self, texel: usize) -> Range<usize> {
        self.start[texel] as usize..self.start[texel + 1] as usize
    }

    pub fn count(&self) -> usize {
        self.all.len()
    }

    /// Multiplies what views show, each at a pixel position, with factors of at most `most`.
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

    /// Has what views show looked up anew at other places: each view at a pixel position tells where else, and by what it is multiplied,
    /// or nothing. What lies near the border there counts less.
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

    /// Has views count by shares in [0, 1], each at a pixel position.
    pub fn reweight(&mut self, texels: &Texels, views: &[View], share: impl Fn(usize, DVec2) -> f32 + Sync) {
        self.update_projected(texels, views, |observation, view_index, pixel| {
            // Next to nothing is left of what does not count: none would have no place among the others.
            observation.weight = quantize_255(observation.weight() * share(view_index, pixel)).max(1);
        });
    }

    /// Has it told of each texel and view whether what is mirrored from there is blocked.
    pub fn mark_blocked(&mut self, is_blocked: impl Fn(usize, usize) -> bool + Sync) {
        self.update_each(|observation, texel| {
            observation.clipped &= !BLOCKED;
            if is_blocked(texel, usize::from(observation.view)) {
                observation.clipped |= BLOCKED;
            }
        });
    }

    /// Changes all sightings, each given with its view's number and its pixel position.
    fn update_projected(
        &mut self,
        texels: &Texels,
        views: &[View],
        update: impl Fn(&mut Observation, usize, DVec2) + Sync,
    ) {
        self.update_each(|observation, texel| {
            let view_index = usize::from(observation.view);
            // It was projected before, by the same lens.
            let pixel = views[view_index].project(texels.position(texel)).unwrap_or_default();
            update(observation, view_index, pixel);
        });
    }

    /// Changes all sightings, each given with its texel.
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

    /// The light that a sighting shows.
    pub fn light(&self, observation: &Observation) -> Vec3 {
        decode_light(observation.root, self.brightest)
    }
}

/// Texels that are worked on as one, by their numbers, and their sightings, which begin at `start`.
fn texel_chunks<'a>(start: &[u32], all: &'a mut [Observation]) -> Vec<(Range<usize>, &'a mut [Observation])> {
    const BLOCK: usize = 4096;
    let texels = start.len() - 1;
    let mut rest = all;
    let mut blocks = Vec::new();
    for first in (0..texels).step_by(BLOCK) {
        let range = first..(first + BLOCK).min(texels);
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

/// How a place counts that is so many pixels from an edge of depth.
fn edge_weight(pixels: u8, ramp_px: [f32; 2]) -> f32 {
    // Edges farther away are told of no more.
    if pixels >= MAX_EDGE_DISTANCE { 1.0 } else { ramp(f32::from(pixels), ramp_px) }
}

/// A photograph, and what it can see.
pub(crate) struct ViewVisibility<'a> {
    pub view: &'a View,
    pub loaded: &'a LoadedView,
}

impl ViewVisibility<'_> {
    /// How well it sees every texel, by 255ths; 0 not at all.
    fn texel_weights(&self, texels: &Texels) -> Vec<u8> {
        let weight = |texel: usize| self.surface_weight(texels.position(texel), texels.normal(texel));
        (0..texels.count()).into_par_iter().map(|texel| quantize_255(weight(texel))).collect()
    }

    /// How well it sees a place of the surface with this normal, in [0, 1]; 0 not at all.
    pub fn surface_weight(&self, position: DVec3, normal: Vec3) -> f32 {
        let cosine = normal.dot((self.view.position() - position).as_vec3().normalize_or_zero()).abs();
        let angle_weight = ramp(cosine, GRAZING_COSINES);
        if angle_weight == 0.0 {
            return 0.0;
        }
        angle_weight
            * self.position_weight(position, EDGE_RAMP_PX, |place| {
                self.loaded.depth.visible_edge_distance(self.view, position, place)
            })
    }

    /// How well it sees every cell at infinity, by 255ths.
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

    /// How a position counts, if the depths see it: so many pixels from an edge.
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

    /// How a place in the picture counts by itself: its distance from the border, and the mask.
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

/// How a place counts that is so near the picture's border.
pub(crate) fn border_weight(picture: &PackedPicture, place: DVec2) -> f32 {
    let size = DVec2::new(f64::from(picture.width), f64::from(picture.height));
    ramp(place.min(size - place).min_element() as f32, BORDER_RAMP_PX)
}

fn quantize_255(share: f32) -> u8 {
    (share * 255.0 + 0.5) as u8
}

fn quantize_127(share: f32) -> u8 {
    (share.clamp(0.0, 1.0) * 127.0 + 0.5) as u8
}

/// A texel has one light, so of views of its front and its back only those of the side that is seen better count.
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

/// All sightings, by texel.
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
                // It was projected before, by the same lens.
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
