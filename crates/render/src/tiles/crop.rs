//! Drawing a crop of a picture: the light field around it is baked square by square, and each square is added to the sums.

use crate::error::RenderError;
use crate::mattes::{Footprints, MatteRequest, Packing, Ranking, SampleParts, Tally, Things, shares};
use crate::tiles::lit_picture::LitPicture;
use glam::{IVec2, Vec2};
use lens::Picture;
use light::Steps;
use progress::{Progress, Stage};
use salf::{PartsBaker, Surroundings};
use scene::Scene;
use splat::{Crop, CropError, CropOptions, CropPicture, CropSums, Integers, Kind, SETS, SplatError};
use std::array::from_fn;

/// Number of squares of 64 × 64 px whose light field is in memory at once.
const SQUARES_AT_ONCE: usize = 64;

/// Number of mattes, of three sets each, that are summed at once.
const MAX_MATTES_AT_ONCE: usize = 8;

/// Bytes of the sums of one pixel, over all levels.
const BYTES_PER_SUM: u64 = 48;

/// Bytes of the resolved values of one pixel.
const BYTES_PER_RESOLVED_PIXEL: u64 = 56;

/// Memory limit of a crop, bytes.
const MAX_BYTES: u64 = 400 << 20;

/// Why a crop was not drawn.
pub(crate) enum CropFailure {
    /// Integer sums of this kind overflowed.
    TooFine(Kind),
    /// Any other error.
    Other(RenderError),
}

impl From<CropError> for CropFailure {
    fn from(error: CropError) -> Self {
        match error {
            CropError::Cancelled => Self::Other(RenderError::Cancelled),
            CropError::TooFine(kind) => Self::TooFine(kind),
            CropError::TooBright => Self::Other(SplatError::Overflow.into()),
        }
    }
}

impl<E: Into<RenderError>> From<E> for CropFailure {
    fn from(error: E) -> Self {
        Self::Other(error.into())
    }
}

/// A drawn crop.
pub(crate) struct DrawnCrop {
    /// The sums.
    pub picture: CropPicture,
    /// Alpha of each pixel, if requested.
    pub alpha: Option<Vec<f32>>,
    /// The mattes of each kind of things, if requested.
    pub mattes: Vec<Ranking>,
}

/// The content of a set of a matte.
#[derive(Clone, Copy)]
enum Set {
    /// All surfaces.
    Surface,
    /// The things of a kind that share a color.
    Color { kind: usize, color: usize },
}

/// Draws crops of a picture.
pub(crate) struct CropDrawer<'a> {
    lit: &'a LitPicture,
    baker: PartsBaker<'a>,
    scene: &'a Scene,
    things: Vec<Things>,
}

impl<'a> CropDrawer<'a> {
    /// A drawer for crops of `lit`.
    pub fn new(lit: &'a LitPicture) -> Self {
        let baker = lit.baker();
        let scene: &Scene = lit.tracer.scene();
        let has_things = lit.mattes.is_some_and(|request| request.crypto);
        let things =
            if has_things { vec![Things::objects(scene), Things::materials(scene)] } else { Vec::new() };
        Self { lit, baker, scene, things }
    }

    /// Maximum number of pixels of the finer picture in one crop.
    pub fn max_px(&self) -> u64 {
        let mattes = match self.lit.mattes {
            None => 0,
            Some(MatteRequest { crypto: false }) => 1,
            Some(MatteRequest { crypto: true }) => MAX_MATTES_AT_ONCE as u64,
        };
        let pictures = if self.baker.may_be_painted() { 2 } else { 1 };
        MAX_BYTES / (BYTES_PER_SUM * (pictures + mattes) + BYTES_PER_RESOLVED_PIXEL)
    }

    /// Draws a crop, given in pixels of the picture, with these integers.
    ///
    /// # Errors
    /// The integers do not suffice, the picture cannot be rendered, or the work was cancelled.
    pub fn draw(&self, crop: Crop, integers: Integers, steps: &dyn Steps) -> Result<DrawnCrop, CropFailure> {
        let LitPicture { finer, options, .. } = self.lit;
        let (cells, tolerance) = (options.cells_a_side, options.splat_tolerance);
        let fine =
            Crop { corner: crop.corner.map(|px| px * cells), size: crop.size.map(|side| side * cells) };
        let packings = self.packings(crop);
        let sets = matte_sets(self.lit.mattes, &packings);
        let mattes: Vec<&[Set]> = sets.chunks(SETS).collect();
        let mut groups = mattes.chunks(MAX_MATTES_AT_ONCE);
        let group = groups.next().unwrap_or_default();
        let mut sums = CropSums::new(CropOptions {
            camera: finer,
            crop: fine,
            tolerance,
            integers,
            may_be_painted: self.baker.may_be_painted(),
            mattes: group.len(),
        });
        let first = IVec2::from_array(fine.corner.map(|px| px as i32));
        let window = [first, first + IVec2::from_array(fine.size.map(|side| side as i32))];
        let near = CropSums::near_px(tolerance) + CropSums::blur_px(tolerance);
        let surroundings = self.baker.survey_surroundings(window, near, &*steps.begin("surroundings"))?;
        self.add_all(&mut sums, &surroundings, group, &packings, &*steps.begin("tile"))?;
        let picture = sums.picture()?;

        let mut alpha = None;
        let mut tallies: Vec<_> = self.things.iter().map(|_| Tally::new(crop.size)).collect();
        let mut count_mattes = |sums: &CropSums, group: &[&[Set]]| -> Result<(), CropFailure> {
            for (index, sets) in group.iter().enumerate() {
                let picture = sums.matte(index)?.averaged(cells);
                for (set, what) in sets.iter().enumerate() {
                    match *what {
                        Set::Surface => alpha = Some(alpha_of(&picture, set)),
                        Set::Color { kind, color } => {
                            tallies[kind]
                                .add(shares(&picture, set), |x, y| packings[kind].owner(color, x, y));
                        }
                    }
                }
            }
            Ok(())
        };
        count_mattes(&sums, group)?;
        for group in groups {
            sums.begin_mattes(group.len());
            self.add_all(&mut sums, &surroundings, group, &packings, &*steps.begin("mattes"))?;
            count_mattes(&sums, group)?;
        }
        let shown = alpha.as_deref().unwrap_or_default();
        let mattes = tallies.into_iter().map(|tally| tally.ranking(shown)).collect();
        Ok(DrawnCrop { picture, alpha, mattes })
    }

    /// Bakes the light field around a crop and adds it to the sums.
    fn add_all(
        &self,
        sums: &mut CropSums,
        surroundings: &Surroundings,
        mattes: &[&[Set]],
        packings: &[Packing],
        progress: &dyn Progress,
    ) -> Result<(), CropFailure> {
        let LitPicture { focus, options, .. } = self.lit;
        let batches = surroundings.squares.len().div_ceil(SQUARES_AT_ONCE) as f32;
        for (index, squares) in surroundings.squares.chunks(SQUARES_AT_ONCE).enumerate() {
            let stage = Stage::new(progress, index as f32 / batches, (index + 1) as f32 / batches);
            let (salf, _) = self.baker.bake(surroundings, squares, &Stage::new(&stage, 0.0, 0.7))?;
            let sample_parts = SampleParts::new(&salf, self.scene);
            let is_black = |sample: u32| sample_parts.part(sample).is_none();
            let is_black = options.is_premultiplied().then_some(&is_black as &(dyn Fn(u32) -> bool + Sync));
            let is_in = |set: Option<&Set>, part: u32| match set {
                None => false,
                Some(Set::Surface) => true,
                Some(Set::Color { kind, color }) => {
                    packings[*kind].color_of(self.things[*kind].of_part(part)) == *color
                }
            };
            let of_sample = |sets: &[Set], sample: u32| match sample_parts.part(sample) {
                None => [false; SETS],
                Some(part) => from_fn(|set| is_in(sets.get(set), part)),
            };
            let set_lookups: Vec<_> =
                mattes.iter().map(|sets| |sample: u32| of_sample(sets, sample)).collect();
            let set_lookup_refs: Vec<_> = set_lookups.iter().map(|lookup| lookup as _).collect();
            sums.add(&salf, focus, is_black, &set_lookup_refs, &Stage::new(&stage, 0.7, 1.0))?;
        }
        Ok(())
    }

    /// Which things of each kind are drawn together, from a bound on where their light may land.
    fn packings(&self, crop: Crop) -> Vec<Packing> {
        let cells = self.lit.options.cells_a_side as f32;
        let of_things = |things: &Things| {
            let mut footprints = Footprints::empty(things.names.len(), crop.size);
            for (part, [low, high]) in self.baker.footprints() {
                let corner = Vec2::from_array(crop.corner.map(|px| px as f32));
                let size = Vec2::from_array(crop.size.map(|side| side as f32));
                let [low, high] =
                    [low / cells - corner, high / cells - corner].map(|at| at.clamp(Vec2::ZERO, size));
                let window = [0, 1].map(|axis: usize| low[axis] as u32..high[axis].ceil() as u32);
                if window.iter().all(|range| !range.is_empty()) {
                    footprints.add(things.of_part(part), window);
                }
            }
            footprints.pack()
        };
        self.things.iter().map(of_things).collect()
    }
}

/// The sets of all mattes.
fn matte_sets(request: Option<MatteRequest>, packings: &[Packing]) -> Vec<Set> {
    let surface = request.map(|_| Set::Surface);
    let colors = packings
        .iter()
        .enumerate()
        .flat_map(|(kind, packing)| (0..packing.colors()).map(move |color| Set::Color { kind, color }));
    surface.into_iter().chain(colors).collect()
}

fn alpha_of(picture: &Picture, set: usize) -> Vec<f32> {
    shares(picture, set).map(|share| share.clamp(0.0, 1.0)).collect()
}
