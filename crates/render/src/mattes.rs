//! Which share of each pixel things have: alpha, and Cryptomatte of objects and materials.
//!
//! The share of a thing in a pixel is the coverage of what of it lands there over that of all. Whoever makes the picture makes mattes
//! (`source`): pictures in which some things send 1 and all others nothing, three at once. A scene may have thousands of things, but a pixel
//! shows few: things whose light lands in no common tile of the picture are drawn together (`packing`), and taken apart again where
//! they are counted (`tally`).

mod packing;
mod source;
mod tally;
mod things;

pub(crate) use packing::{Footprints, Packing};
pub(crate) use source::{BlackBackground, LightFieldMattes, MatteSource, SampleParts, TruthMattes};
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

/// What is wanted of mattes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct MatteRequest {
    /// Cryptomatte of objects and materials, beside alpha.
    pub crypto: bool,
}

/// The share of each pixel that is not background, and what has it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Mattes {
    /// Row by row, in [0, 1].
    pub alpha: Vec<f32>,
    /// Of objects and of materials, if they were wanted: their shares sum to alpha.
    pub crypto: Vec<Cryptomatte>,
    /// What they lack, a sentence each.
    pub warnings: Vec<String>,
}

impl Mattes {
    /// Those of a picture of a scene.
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
        // Each color of either kind, and those that are drawn together.
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

/// The share of each pixel that a set has; 0 where nothing is covered.
pub(crate) fn shares(picture: &Picture, set: usize) -> impl Iterator<Item = f32> {
    let share =
        move |(rgb, &coverage): (&[f32; 3], &f32)| if coverage > 0.0 { rgb[set] / coverage } else { 0.0 };
    picture.radiance.iter().zip(&picture.coverage).map(share)
}
