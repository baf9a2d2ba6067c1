//! Alpha, and Cryptomatte of objects and materials: the share of each pixel that each thing covers.
//!
//! A thing's share of a pixel is its coverage there divided by the total coverage. The renderer of the picture also draws the mattes
//! (`source`): pictures in which some things emit 1 and all others 0, three sets at once. A scene may have thousands of things, but a
//! pixel shows few of them: things whose light never lands in the same tile of the picture are drawn together (`packing`) and separated
//! again when they are counted (`tally`).

mod packing;
mod source;
mod tally;
mod things;

pub(crate) use packing::{Footprints, Packing};
pub(crate) use source::{
    BlackBackground, LightFieldMattes, MatteLight, MatteSource, SampleParts, SetsOfPart, TruthMattes,
};
pub(crate) use tally::{Entry, Ranking, Tally, left_out_warning, ranks_of};
pub(crate) use things::Things;

use crate::error::RenderError;
use lens::Picture;
use light::Steps;
use progress::Stage;
use project::Cryptomatte;
use scene::Scene;
use source::Sets;
use splat::SETS;

/// Which mattes to render.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct MatteRequest {
    /// Whether to render Cryptomatte of objects and materials in addition to alpha.
    pub crypto: bool,
}

/// The mattes of a picture.
#[derive(Clone, Debug, Default)]
pub(crate) struct Mattes {
    /// The share of each pixel that is not background, in [0, 1], row by row.
    pub alpha: Vec<f32>,
    /// Cryptomatte of objects and of materials, if requested. Their shares sum to alpha.
    pub crypto: Vec<Cryptomatte>,
    /// What the mattes lack, one sentence each.
    pub warnings: Vec<String>,
}

impl Mattes {
    /// Renders the mattes that `request` asks for of a picture of `scene`.
    ///
    /// # Errors
    /// Errors of `source`, or the work was cancelled.
    pub fn render(
        scene: &Scene,
        mut source: impl MatteSource,
        request: MatteRequest,
        steps: &dyn Steps,
    ) -> Result<Self, RenderError> {
        let is_surface = |part: Option<u32>| Sets::first_only(part.is_some());
        let picture = source.draw(&is_surface, &*steps.begin("alpha"))?;
        let alpha = shares(&picture, 0).map(|share| share.clamp(0.0, 1.0)).collect::<Vec<f32>>();
        let mut mattes = Self { alpha, ..Self::default() };
        if !request.crypto {
            return Ok(mattes);
        }
        let size = [picture.width, picture.height];
        let kinds = [Things::objects(scene), Things::materials(scene)];
        let packings = kinds.each_ref().map(|things| source.packing(things, size));
        let mut tallies = kinds.each_ref().map(|_| Tally::new(size));
        // All (kind, color) pairs; up to `SETS` of them are drawn in one pass.
        let colors: Vec<(usize, usize)> = (0..kinds.len())
            .flat_map(|kind| (0..packings[kind].colors()).map(move |color| (kind, color)))
            .collect();
        let progress = steps.begin("mattes");
        let passes = colors.len().div_ceil(SETS).max(1) as f32;
        for (pass, together) in colors.chunks(SETS).enumerate() {
            let in_sets = |part: Option<u32>| {
                let is_in = |(kind, color): &(usize, usize)| {
                    part.is_some_and(|part| packings[*kind].color_of(kinds[*kind].of_part(part)) == *color)
                };
                Sets::from_flags(together.iter().map(is_in))
            };
            let stage = Stage::new(&*progress, pass as f32 / passes, (pass + 1) as f32 / passes);
            let picture = source.draw(&in_sets, &stage)?;
            for (set, &(kind, color)) in together.iter().enumerate() {
                tallies[kind].add(shares(&picture, set), |x, y| packings[kind].owner(color, x, y));
            }
        }
        for (things, tally) in kinds.into_iter().zip(tallies) {
            let (ranks, left_out) = tally.ranks(&mattes.alpha);
            mattes.warnings.extend(left_out_warning(things.plural_name, left_out));
            mattes.crypto.push(Cryptomatte { kind: things.kind.into(), names: things.names, ranks });
        }
        Ok(mattes)
    }
}

/// The share of each pixel that a set covers; 0 where nothing is covered.
pub(crate) fn shares(picture: &Picture, set: usize) -> impl Iterator<Item = f32> {
    let share =
        move |(rgb, &coverage): (&[f32; 3], &f32)| if coverage > 0.0 { rgb[set] / coverage } else { 0.0 };
    picture.radiance.iter().zip(&picture.coverage).map(share)
}
