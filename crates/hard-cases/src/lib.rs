//! The numerically hard cases, by name.
//!
//! Each [`Case`] puts one awkward input through the product, measures what comes out against a closed form or a
//! reasoned bound, and applies *the same check* to a deliberately wrong computation, which must fail it: a check
//! that passes both proves nothing. [`suite`] lists them, [`run`] runs them; `docs/hard-cases.md` shows the table.
//!
//! | file | idea |
//! | --- | --- |
//! | `defocus` | κ where other forms of the formula have a pole |
//! | `offsets` | focus offsets that make no sense |
//! | `aperture_plane` | surfaces on, behind and across the aperture, and up to the horizon |
//! | `scaling` | the same scene in other units |
//! | `rays` | closed meshes and close shells |
//! | `triangles` | triangles without area, needles, duplicates |
//! | `texels` | texels whose centre lies beside their triangle, paint at a seam |
//! | `ranges` | the very bright beside the very dim |
//! | `furnace` | a scene of radiance 1 is 1 |
//! | `energy` | light is neither made nor lost |
//! | `sampling` | aperture points have the density of the transmission |
//! | `masks` | aperture pictures without light, with little, with very many texels |
//! | `lobes` | how a surface scatters: energy, reciprocity, density |
//! | `rooms` | light that goes to and fro, and the sky |
//! | `glass` | what is let through |
//! | `mirrors` | what is mirrored keeps the standard focus |
//! | `panes` | half there is half there |

mod aperture_plane;
mod case;
mod chance;
mod defocus;
mod energy;
mod furnace;
mod glass;
mod light_field;
mod lobes;
mod masks;
mod measure;
mod mirrors;
mod offsets;
mod panes;
mod random;
mod ranges;
mod rays;
mod rooms;
mod sampling;
mod scaling;
mod scenery;
mod shot;
mod texels;
mod triangles;

pub use case::{Case, Effort, Outcome};

use progress::{Cancelled, Progress};

/// All cases, in the order of the table.
pub fn suite() -> Vec<Case> {
    [
        defocus::CASES,
        offsets::CASES,
        aperture_plane::CASES,
        scaling::CASES,
        rays::CASES,
        triangles::CASES,
        texels::CASES,
        ranges::CASES,
        furnace::CASES,
        energy::CASES,
        sampling::CASES,
        masks::CASES,
        lobes::CASES,
        rooms::CASES,
        glass::CASES,
        mirrors::CASES,
        panes::CASES,
        chance::CASES,
    ]
    .concat()
}

/// Runs the cases whose names contain `filter` (all if it is empty).
///
/// Progress goes by cases, the longest of which take some seconds at [`Effort::Full`].
pub fn run(filter: &str, effort: Effort, progress: &dyn Progress) -> Result<Vec<Outcome>, Cancelled> {
    let chosen: Vec<_> = suite().into_iter().filter(|case| case.name.contains(filter)).collect();
    let count = chosen.len() as f32;
    let outcomes = chosen.iter().enumerate().map(|(index, case)| {
        progress.check()?;
        let outcome = case.run(effort, &CancelOnly(progress))?;
        progress.report((index + 1) as f32 / count);
        Ok(outcome)
    });
    outcomes.collect()
}

/// Lets a case be cancelled, but not tell how far each of its pictures is.
struct CancelOnly<'a>(&'a dyn Progress);

impl Progress for CancelOnly<'_> {
    fn report(&self, _fraction: f32) {}
    fn cancelled(&self) -> bool {
        self.0.cancelled()
    }
}
