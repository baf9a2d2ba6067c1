//! Which photograph sees which texel, how well, and what it shows there.
//!
//! A photograph is read once. What it sees is told by its [`DepthPicture`]: a weight in (0, 1] that falls smoothly to 0 toward edges of
//! depth, the picture's border and glancing angles, so that nothing begins or ends abruptly on the surface.

use super::depth_picture::FAR_FROM_EDGES;
use super::kept_picture::KeptPicture;
use super::reading::{ReadView, Reading};
use crate::photographs::error::PhotographError;
use crate::photographs::numbers::ramp;
use crate::photographs::places::{Sphere, Texels};
use glam::{DVec2, DVec3, Vec3};
use progress::{Progress, Stage};
use rayon::prelude::*;
use scene::{Scene, View};
use std::ops::Range;

/// Glancing views (cosine) see nothing that can be told from its neighbours; from the second value on they count in full.
const GLANCING: [f32; 2] = [0.08, 0.35];
/// So many pixels from an edge of depth a photograph begins to count, and counts in full.
const FROM_EDGE: [f32; 2] = [1.0, 4.0];
/// The same for what is beyond the surface, in shares of the picture's longer side: meshes end early, and what they left out stands
/// beside them.
const BEYOND_FROM_EDGE: [f32; 2] = [0.01, 0.04];
/// The same from the picture's border.
const FROM_BORDER: [f32; 2] = [1.0, 8.0];

/// What a texel looks like to one photograph.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sighting {
    pub view: u16,
    /// How well it is seen, in (0, 1] by 255ths.
    weight: u8,
    /// The share of clipped pixels, by 127ths; [`BLOCKED`] beside it.
    clipped: u8,
    /// Linear light, as the photograph has it until that is scaled, as square roots.
    root: [u16; 3],
}

/// Everything that photographs show of the surface.
pub(crate) struct Sightings {
    pub pictures: Vec<KeptPicture>,
    /// `all[start[t]..start[t + 1]]` are of texel t, by view.
    start: Vec<u32>,
    all: Vec<Sighting>,
    /// By view, how well each cell of a [`Sphere`] is seen beyond the surface, by 255ths.
    pub beyond: Vec<Vec<u8>>,
    brightest: f32,
}

/// Of a sighting: what the texel mirrors toward the photograph is another part of the scene.
const BLOCKED: u8 = 128;

impl Sighting {
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

impl Sightings {
    /// Reads the photographs and looks what they see of texels and of cells at infinity.
    ///
    /// # Errors
    /// The first view's, by order, whose picture or mask cannot be had; that the work was stopped.
    pub fn of(
        scene: &Scene,
        texels: &Texels,
        sphere: &Sphere,
        views: &[View],
        reading: &Reading<'_>,
        progress: &dyn Progress,
    ) -> Result<Self, PhotographError> {
        let read = reading.each(scene, views, &Stage::new(progress, 0.0, 0.8), |view, read| {
            let look = Look { view, read: &read };
            let seen = (look.at_texels(texels), look.beyond(sphere));
            (read.picture, seen)
        })?;
        let (pictures, seen): (Vec<_>, Vec<_>) = read.into_iter().unzip();
        let (mut weights, beyond): (Vec<_>, Vec<_>) = seen.into_iter().unzip();
        keep_one_side(texels, views, &mut weights);
        let brightest = pictures.iter().map(KeptPicture::brightest).fold(1.0, f32::max);
        let (start, all) = gathered(texels, views, &pictures, &weights, brightest);
        Ok(Self { pictures, start, all, beyond, brightest })
    }

    /// What photographs show of a texel, by view.
    pub fn of_texel(&self, texel: usize) -> &[Sighting] {
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
    pub fn scale(
        &mut self,
        texels: &Texels,
        views: &[View],
        most: f32,
        factor: impl Fn(usize, DVec2) -> Vec3 + Sync,
    ) {
        let before = self.brightest;
        self.brightest *= most.max(1.0);
        let after = self.brightest;
        self.change(texels, views, |sighting, number, pixel| {
            sighting.root = root_of(light_of(sighting.root, before) * factor(number, pixel), after);
        });
    }

    /// Has what views show looked up anew at other places: each view at a pixel position tells where else, and by what it is multiplied,
    /// or nothing. What lies near the border there counts less.
    pub fn look_again(
        &mut self,
        texels: &Texels,
        views: &[View],
        elsewhere: impl Fn(usize, DVec2) -> Option<(DVec2, Vec3)> + Sync,
    ) {
        let (brightest, pictures) = (self.brightest, std::mem::take(&mut self.pictures));
        self.change(texels, views, |sighting, number, pixel| {
            if let Some((pixel, factor)) = elsewhere(number, pixel) {
                let picture = &pictures[number];
                let place = picture.place(pixel);
                let shown = picture.at(place);
                sighting.root = root_of(shown.light * factor, brightest);
                sighting.clipped = by_127ths(shown.clipped);
                sighting.weight = by_255ths(sighting.weight() * from_border(picture, place)).max(1);
            }
        });
        self.pictures = pictures;
    }

    /// Has views count by shares in [0, 1], each at a pixel position.
    pub fn weigh(&mut self, texels: &Texels, views: &[View], share: impl Fn(usize, DVec2) -> f32 + Sync) {
        self.change(texels, views, |sighting, number, pixel| {
            // Next to nothing is left of what does not count: none would have no place among the others.
            sighting.weight = by_255ths(sighting.weight() * share(number, pixel)).max(1);
        });
    }

    /// Has it told of each texel and view whether what is mirrored from there is blocked.
    pub fn block(&mut self, is_blocked: impl Fn(usize, usize) -> bool + Sync) {
        self.each(|sighting, texel| {
            sighting.clipped &= !BLOCKED;
            if is_blocked(texel, usize::from(sighting.view)) {
                sighting.clipped |= BLOCKED;
            }
        });
    }

    /// Changes all sightings, each given with its view's number and its pixel position.
    fn change(
        &mut self,
        texels: &Texels,
        views: &[View],
        change: impl Fn(&mut Sighting, usize, DVec2) + Sync,
    ) {
        self.each(|sighting, texel| {
            let number = usize::from(sighting.view);
            // It was projected before, by the same lens.
            let pixel = views[number].project(texels.position(texel)).unwrap_or_default();
            change(sighting, number, pixel);
        });
    }

    /// Changes all sightings, each given with its texel.
    fn each(&mut self, change: impl Fn(&mut Sighting, usize) + Sync) {
        let start = &self.start;
        blocks_of(start, &mut self.all).into_par_iter().for_each(|(range, block)| {
            let first = start[range.start];
            for texel in range {
                let (from, to) = (start[texel] - first, start[texel + 1] - first);
                block[from as usize..to as usize].iter_mut().for_each(|sighting| change(sighting, texel));
            }
        });
    }

    /// The light that a sighting shows.
    pub fn light(&self, sighting: &Sighting) -> Vec3 {
        light_of(sighting.root, self.brightest)
    }
}

/// Texels that are worked on as one, by their numbers, and their sightings, which begin at `start`.
fn blocks_of<'a>(start: &[u32], all: &'a mut [Sighting]) -> Vec<(Range<usize>, &'a mut [Sighting])> {
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

fn light_of(root: [u16; 3], brightest: f32) -> Vec3 {
    let root = Vec3::from_array(root.map(|v| f32::from(v) / 65535.0));
    root * root * brightest
}

fn root_of(light: Vec3, brightest: f32) -> [u16; 3] {
    light.to_array().map(|v| ((v / brightest).clamp(0.0, 1.0).sqrt() * 65535.0 + 0.5) as u16)
}

/// How a place counts that is so many pixels from an edge of depth.
fn from_edge(pixels: u8, counting: [f32; 2]) -> f32 {
    // Edges farther away are told of no more.
    if pixels >= FAR_FROM_EDGES { 1.0 } else { ramp(f32::from(pixels), counting) }
}

/// A photograph, and what it can see.
pub(crate) struct Look<'a> {
    pub view: &'a View,
    pub read: &'a ReadView,
}

impl Look<'_> {
    /// How well it sees every texel, by 255ths; 0 not at all.
    fn at_texels(&self, texels: &Texels) -> Vec<u8> {
        let weight = |texel: usize| self.at_surface(texels.position(texel), texels.normal(texel));
        (0..texels.count()).into_par_iter().map(|texel| by_255ths(weight(texel))).collect()
    }

    /// How well it sees a place of the surface with this normal, in [0, 1]; 0 not at all.
    pub fn at_surface(&self, position: DVec3, normal: Vec3) -> f32 {
        let cosine = normal.dot((self.view.position() - position).as_vec3().normalize_or_zero()).abs();
        let of_angle = ramp(cosine, GLANCING);
        if of_angle == 0.0 {
            return 0.0;
        }
        of_angle * self.at(position, FROM_EDGE, |place| self.read.depth.sees(self.view, position, place))
    }

    /// How well it sees every cell at infinity, by 255ths.
    fn beyond(&self, sphere: &Sphere) -> Vec<u8> {
        let eye = self.view.position();
        let longer = self.read.picture.width.max(self.read.picture.height) as f32;
        let counting = BEYOND_FROM_EDGE.map(|share| share * longer);
        let weight = |cell: usize| {
            let position = eye + sphere.direction(cell).as_dvec3();
            self.at(position, counting, |place| self.read.depth.sees_nothing(place))
        };
        (0..sphere.count()).map(|cell| by_255ths(weight(cell))).collect()
    }

    /// How a position counts, if the depths see it: so many pixels from an edge.
    fn at(&self, position: DVec3, counting: [f32; 2], seen: impl Fn(DVec2) -> Option<u8>) -> f32 {
        let Some(pixel) = self.view.project(position) else { return 0.0 };
        let place = self.read.picture.place(pixel);
        let Some(edge) = seen(place) else { return 0.0 };
        from_edge(edge, counting) * self.counts(pixel, place)
    }

    /// How a place in the picture counts by itself: its distance from the border, and the mask.
    fn counts(&self, pixel: DVec2, place: DVec2) -> f32 {
        if !self.view.lens.is_in_picture(pixel) {
            return 0.0;
        }
        let is_masked = self.read.mask.as_ref().is_some_and(|mask| {
            let (x, y) = (pixel.x as u32, pixel.y as u32);
            x < mask.width && y < mask.height && !mask.counts[(y * mask.width + x) as usize]
        });
        if is_masked {
            return 0.0;
        }
        from_border(&self.read.picture, place)
    }
}

/// How a place counts that is so near the picture's border.
pub(crate) fn from_border(picture: &KeptPicture, place: DVec2) -> f32 {
    let size = DVec2::new(f64::from(picture.width), f64::from(picture.height));
    ramp(place.min(size - place).min_element() as f32, FROM_BORDER)
}

fn by_255ths(share: f32) -> u8 {
    (share * 255.0 + 0.5) as u8
}

fn by_127ths(share: f32) -> u8 {
    (share.clamp(0.0, 1.0) * 127.0 + 0.5) as u8
}

/// A texel has one light, so of views of its front and its back only those of the side that is seen better count.
fn keep_one_side(texels: &Texels, views: &[View], weights: &mut [Vec<u8>]) {
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
fn gathered(
    texels: &Texels,
    views: &[View],
    pictures: &[KeptPicture],
    weights: &[Vec<u8>],
    brightest: f32,
) -> (Vec<u32>, Vec<Sighting>) {
    let mut start = vec![0u32; texels.count() + 1];
    for texel in 0..texels.count() {
        let count = weights.iter().filter(|weights| weights[texel] > 0).count() as u32;
        start[texel + 1] = start[texel] + count;
    }
    let nothing = Sighting { view: 0, weight: 0, clipped: 0, root: [0; 3] };
    let mut all = vec![nothing; start[texels.count()] as usize];
    blocks_of(&start, &mut all).into_par_iter().for_each(|(range, block)| {
        let mut slots = block.iter_mut();
        for texel in range {
            for (number, view) in views.iter().enumerate() {
                let weight = weights[number][texel];
                if weight == 0 {
                    continue;
                }
                let Some(slot) = slots.next() else { return };
                let position: DVec3 = texels.position(texel);
                // It was projected before, by the same lens.
                let pixel = view.project(position).unwrap_or_default();
                let shown = pictures[number].at(pictures[number].place(pixel));
                let clipped = by_127ths(shown.clipped);
                *slot =
                    Sighting { view: number as u16, weight, clipped, root: root_of(shown.light, brightest) };
            }
        }
    });
    (start, all)
}
