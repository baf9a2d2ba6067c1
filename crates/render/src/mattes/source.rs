//! Sources of mattes: the light field of the picture, or the rays of the ground truth.

use crate::error::RenderError;
use crate::mattes::packing::{Footprints, Packing};
use crate::mattes::things::Things;
use focus::Focus;
use glam::{DVec3, Vec3};
use lens::{Camera, Picture};
use progress::Progress;
use rayon::prelude::*;
use salf::Salf;
use scene::{Scene, SurfacePoint};
use splat::SETS;
use trace::truth::TruthOptions;
use trace::{OutgoingRadiance, Radiance, Tracer};

/// Which of the sets that are drawn at once something belongs to.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sets(pub [bool; SETS]);

impl Sets {
    /// Membership in the first set only, or in none.
    pub fn first_only(is_in: bool) -> Self {
        Self::from_flags([is_in].into_iter())
    }

    /// Membership by one flag per set; missing flags are false.
    pub fn from_flags(is_in: impl Iterator<Item = bool>) -> Self {
        let mut sets = Self::default();
        sets.0.iter_mut().zip(is_in).for_each(|(set, is_in)| *set = is_in);
        sets
    }
}

/// The sets of a part of the scene; `None` is the background.
pub(crate) type SetsOfPart<'a> = dyn Fn(Option<u32>) -> Sets + Sync + 'a;

/// A renderer of mattes.
pub(crate) trait MatteSource {
    /// Draws the coverage of up to [`SETS`] sets of parts, as red, green and blue, and the total coverage.
    fn draw(&mut self, sets: &SetsOfPart, progress: &dyn Progress) -> Result<Picture, RenderError>;

    /// Which things may be drawn together. Valid after a call of [`Self::draw`].
    fn packing(&self, things: &Things, size: [u32; 2]) -> Packing;
}

/// The part of background samples.
const NO_PART: u32 = u32::MAX;

/// The part of the scene of each sample of a light field.
pub(crate) struct SampleParts(Vec<u32>);

impl SampleParts {
    /// Looks up which part of the scene each sample lies on.
    pub fn new(salf: &Salf, scene: &Scene) -> Self {
        let runs: Vec<_> = salf.samples.runs().collect();
        let part = |point: SurfacePoint| scene.triangles[point.triangle as usize].part;
        let parts_of_run = |run: &salf::Run| {
            let parts = run.locations().map(|spot| spot.address.surface.map_or(NO_PART, part));
            (run.indices.start as usize, parts.collect::<Vec<_>>())
        };
        let run_parts: Vec<_> = runs.par_iter().map(parts_of_run).collect();
        let mut parts = vec![NO_PART; salf.samples.len()];
        for (first, of_run) in run_parts {
            parts[first..first + of_run.len()].copy_from_slice(&of_run);
        }
        Self(parts)
    }

    /// The part that the sample with this number lies on; `None` for the background.
    pub fn part(&self, sample: u32) -> Option<u32> {
        Some(self.0[sample as usize]).filter(|part| *part != NO_PART)
    }
}

/// Mattes drawn from the picture's light field.
pub(crate) struct LightFieldMattes {
    pub mattes: splat::Mattes,
    pub sample_parts: SampleParts,
    /// Cells per side of a pixel.
    pub cells_a_side: u32,
}

impl MatteSource for LightFieldMattes {
    fn draw(&mut self, sets: &SetsOfPart, progress: &dyn Progress) -> Result<Picture, RenderError> {
        let Self { mattes, sample_parts, .. } = self;
        let picture = mattes.draw(&|sample| sets(sample_parts.part(sample)).0, progress)?;
        Ok(picture.averaged(self.cells_a_side))
    }

    fn packing(&self, things: &Things, size: [u32; 2]) -> Packing {
        let mut footprints = Footprints::empty(things.names.len(), size);
        let cells = self.cells_a_side;
        self.mattes.reaches(|sample, window| {
            if let Some(part) = self.sample_parts.part(sample) {
                let window = window.map(|range| range.start / cells..range.end.div_ceil(cells));
                footprints.add(things.of_part(part), window);
            }
        });
        footprints.pack()
    }
}

/// Mattes drawn by the rays of the ground truth.
pub(crate) struct TruthMattes<'a> {
    pub tracer: &'a Tracer,
    pub radiance: &'a dyn Radiance,
    pub focus: &'a Focus,
    pub camera: &'a Camera,
    pub options: TruthOptions,
}

impl MatteSource for TruthMattes<'_> {
    fn draw(&mut self, sets: &SetsOfPart, progress: &dyn Progress) -> Result<Picture, RenderError> {
        let Self { tracer, radiance, focus, camera, options } = self;
        let light = MatteLight { scene: tracer.scene(), radiance: *radiance, sets };
        Ok(trace::truth::render(tracer, &light, *focus, camera, options, progress)?.picture)
    }

    fn packing(&self, things: &Things, size: [u32; 2]) -> Packing {
        Packing::separate(things.names.len(), size)
    }
}

/// Light for mattes: parts in a set emit 1 in that set's channel, split into own and carried light as in the scene.
pub(crate) struct MatteLight<'a> {
    pub scene: &'a Scene,
    pub radiance: &'a dyn Radiance,
    pub sets: &'a SetsOfPart<'a>,
}

impl MatteLight<'_> {
    /// The light of a part, or of the background.
    pub fn color_of_part(&self, part: Option<u32>) -> Vec3 {
        let Sets(sets) = (self.sets)(part);
        Vec3::from_array(sets.map(|is_in| if is_in { 1.0 } else { 0.0 }))
    }
}

impl Radiance for MatteLight<'_> {
    fn outgoing(&self, point: SurfacePoint, eye: DVec3) -> OutgoingRadiance {
        let light = self.color_of_part(Some(self.scene.triangles[point.triangle as usize].part));
        let carried_share = self.radiance.outgoing(point, eye).carried_share;
        let carried = light * carried_share;
        OutgoingRadiance { own: light - carried, carried, carried_share, ..OutgoingRadiance::default() }
    }

    fn environment(&self, _direction: DVec3) -> Vec3 {
        self.color_of_part(None)
    }
}

/// The light of a scene with a black background.
pub(crate) struct BlackBackground<'a>(pub &'a dyn Radiance);

impl Radiance for BlackBackground<'_> {
    fn outgoing(&self, point: SurfacePoint, eye: DVec3) -> OutgoingRadiance {
        self.0.outgoing(point, eye)
    }

    fn environment(&self, _direction: DVec3) -> Vec3 {
        Vec3::ZERO
    }
}
