//! Surface points that photographs are compared at, and what each is expected to show there.

use super::fitting::Compared;
use super::halves::{Half, half_of};
use super::lattice::Displacement;
use crate::photographs::exposures::Exposure;
use crate::photographs::odd::Belonging;
use crate::photographs::places::Blocks;
use crate::photographs::seeing::{KeptPicture, Sighting};
use crate::photographs::telling::{Calibrated, Sample, robust_mean, roots};
use glam::{DVec2, Vec3};
use rayon::prelude::*;
use scene::View;

/// Points that a photograph is asked at, about.
const OF_A_VIEW: usize = 12_000;
/// A point that fewer photographs see says nothing.
const FEWEST: usize = 3;
/// Others that tell a photograph what to expect count so much at least.
const LEAST_OTHERS: f32 = 0.3;

/// A point as a photograph sees it.
struct Seen {
    view: u16,
    weight: f32,
    /// Where its camera says that it is.
    pixel: DVec2,
    /// What undoes its exposure there.
    to_radiance: Vec3,
}

/// All points.
pub(super) struct Points {
    /// By point.
    all: Vec<Vec<Seen>>,
    /// By view: the points that it sees, and its place among those that do.
    of_view: Vec<Vec<(u32, u16)>>,
}

/// By point and photograph that sees it: what others lead to expect, if they do.
pub(super) type Expected = Vec<Vec<Option<f32>>>;

impl Points {
    /// Texels that may be asked, not too many of them, where photographs belong.
    pub fn of(
        radiance: &Calibrated<'_>,
        views: &[View],
        exposures: &[Exposure],
        belonging: &[Belonging],
    ) -> Self {
        let (texels, sightings) = (radiance.texels, radiance.sightings);
        let blocks = Blocks::of(texels.size());
        let may_be_asked = |texel: &usize| {
            sightings.range(*texel).len() >= FEWEST && half_of(&blocks, texels, *texel) == Half::Asked
        };
        let asked: Vec<usize> = (0..texels.count()).filter(may_be_asked).collect();
        let count: usize = asked.iter().map(|&texel| sightings.range(texel).len()).sum();
        let step = count.div_ceil(OF_A_VIEW * views.len()).max(1);
        let of_texel = |&texel: &usize| -> Vec<Seen> {
            let seen = |sighting: &Sighting| {
                let number = usize::from(sighting.view);
                let pixel = views[number].project(texels.position(texel))?;
                let weight = sighting.weight() * belonging[number].at(pixel);
                let to_radiance = exposures[number].to_radiance(&views[number], pixel);
                (weight > 0.0).then_some(Seen { view: sighting.view, weight, pixel, to_radiance })
            };
            sightings.of_texel(texel).iter().filter_map(seen).collect()
        };
        let all: Vec<Vec<Seen>> = asked.par_iter().step_by(step).map(of_texel).collect();
        let mut of_view = vec![Vec::new(); views.len()];
        for (point, seen) in all.iter().enumerate() {
            for (place, seen) in seen.iter().enumerate() {
                of_view[usize::from(seen.view)].push((point as u32, place as u16));
            }
        }
        Self { all, of_view }
    }

    /// What others lead to expect of each photograph at each point that it sees, all displaced.
    pub fn expected(&self, pictures: &[KeptPicture], displacements: &[Displacement]) -> Expected {
        let of_point = |(samples, belonging): &mut (Vec<Sample>, Vec<f32>), seen: &Vec<Seen>| {
            samples.clear();
            samples.extend(seen.iter().map(|seen| {
                let number = usize::from(seen.view);
                let picture = &pictures[number];
                let shown = picture.at(picture.place(displacements[number].moved(seen.pixel)));
                let clipped = shown.clipped.clamp(0.0, 1.0);
                Sample { light: shown.light * seen.to_radiance, weight: seen.weight, clipped }
            }));
            let mean = robust_mean(samples, belonging);
            let counts = |(sample, belongs): (&Sample, &f32)| sample.counts(mean) * belongs;
            let all: f32 = samples.iter().zip(&*belonging).map(counts).sum();
            let by_others = |(sample, belongs): (&Sample, &f32)| {
                let own = counts((sample, belongs));
                let others = all - own;
                // What was at its limit is not where it seems to be.
                let is_told = sample.clipped == 0.0 && others >= LEAST_OTHERS;
                is_told.then(|| root((mean * all - sample.light * own) / others))
            };
            samples.iter().zip(&*belonging).map(by_others).collect()
        };
        self.all.par_iter().map_init(Default::default, of_point).collect()
    }

    /// A photograph, displaced, beside what others lead to expect.
    pub fn compared(
        &self,
        view: usize,
        picture: &KeptPicture,
        displacement: &Displacement,
        expected: &Expected,
    ) -> Vec<Compared> {
        let step = f64::from(picture.reduction);
        let compared = |&(point, place): &(u32, u16)| {
            let (point, place) = (point as usize, usize::from(place));
            let expected = expected[point][place]?;
            let seen = &self.all[point][place];
            let at = displacement.moved(seen.pixel);
            let shown = |pixel: DVec2| {
                let shown = picture.at(picture.place(pixel));
                f64::from(root(shown.light * seen.to_radiance))
            };
            let along = |axis: DVec2| (shown(at + axis * step) - shown(at - axis * step)) / (2.0 * step);
            Some(Compared {
                pixel: seen.pixel,
                off: f64::from(expected) - shown(at),
                slope: DVec2::new(along(DVec2::X), along(DVec2::Y)),
                weight: f64::from(seen.weight),
            })
        };
        self.of_view[view].iter().filter_map(compared).collect()
    }
}

/// The mean root of its channels: noise is about the same for dark and bright.
fn root(light: Vec3) -> f32 {
    roots(light).element_sum() / 3.0
}
