//! The numerically hard cases, by name.
//!
//! Each [`Case`] runs the product on one awkward input, compares the result with a closed form or a derived
//! bound, and applies *the same check* to a deliberately wrong computation, which must fail it: a check that
//! passes both proves nothing. [`suite`] lists the cases, [`run`] runs them; `docs/hard-cases.md` shows the
//! table.
//!
//! | file | cases |
//! | --- | --- |
//! | `optics/defocus` | the defocus κ where other forms of its formula have a pole |
//! | `optics/offsets` | invalid focus offsets |
//! | `optics/aperture_plane` | surfaces on, behind and across the aperture plane, and up to the horizon |
//! | `optics/scaling` | the same scene in other units |
//! | `optics/character` | a lens's character, the splat against rays |
//! | `optics/sampling` | aperture points are distributed with the transmission as density |
//! | `optics/masks` | aperture masks that are black, of one texel, of very many texels |
//! | `geometry/rays` | closed meshes and nearly coincident shells |
//! | `geometry/triangles` | zero-area triangles, needles, duplicates |
//! | `geometry/texels` | texels whose centre lies outside their triangle; paint at a seam |
//! | `light/ranges` | very bright light next to very dim light |
//! | `light/furnace` | a scene of radiance 1 is 1 |
//! | `light/energy` | energy is conserved |
//! | `light/lobes` | scattering: energy, reciprocity, sampling density |
//! | `light/rooms` | interreflection and skies |
//! | `light/glass` | transmission |
//! | `light/mirrors` | mirrored light keeps the standard focus |
//! | `light/panes` | partial opacity |
//! | `light/chance` | lamps that paths find by chance |
//! | `light/white` | white surfaces close together |
//!
//! ```
//! use hard_cases::{Effort, run};
//! use progress::Unwatched;
//!
//! let outcomes = run("aperture mask all black", Effort::Reduced, &Unwatched)?;
//! assert!(outcomes[0].pass && outcomes[0].control_fails);
//! # Ok::<(), progress::Cancelled>(())
//! ```

mod case;
mod geometry;
mod light;
mod optics;
mod support;

pub use case::{Case, Effort, Outcome};

use geometry::{rays, texels, triangles};
use light::{chance, energy, furnace, glass, lobes, mirrors, panes, ranges, rooms, white};
use optics::{aperture_plane, character, defocus, masks, offsets, sampling, scaling};
use progress::{Cancelled, Progress};

/// All cases, in the order of the table.
pub fn suite() -> Vec<Case> {
    [
        defocus::CASES,
        offsets::CASES,
        aperture_plane::CASES,
        scaling::CASES,
        character::CASES,
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
        white::CASES,
    ]
    .concat()
}

/// Runs the cases whose names contain `filter` (all if it is empty).
///
/// Progress is reported per case; the longest take two minutes at [`Effort::Full`].
///
/// # Errors
/// [`Cancelled`] if `progress` is cancelled.
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

/// Passes on cancellation, but not the progress of single pictures.
struct CancelOnly<'a>(&'a dyn Progress);

impl Progress for CancelOnly<'_> {
    fn report(&self, _fraction: f32) {}
    fn cancelled(&self) -> bool {
        self.0.cancelled()
    }
}
