//! Labels for a picture: costs by plane sweep, aggregated, and the best label chosen; in strips, so that memory stays
//! bounded.

pub mod choice;
pub mod coarse;
pub mod halves;
pub mod labels;
pub mod semi_global;
pub mod sweep;

use crate::matching::choice::{Choice, choose};
use crate::matching::labels::Labels;
use crate::matching::semi_global::{Penalties, aggregate};
use crate::matching::sweep::{ShiftedView, plane_sweep};
use crate::planes::Planes;
use progress::{Cancelled, Progress, Stage};
use rayon::prelude::*;

/// Costs in memory at once (three numbers of 16 bits each): 240 MB.
const COSTS: usize = 40_000_000;

/// Rows by which strips overlap: paths of costs begin there and have converged where they count.
const OVERLAP: usize = 32;

/// The label chosen for every pixel of the reference, row by row: its disparity, and how far it leads over the next
/// best.
///
/// # Errors
/// [`Cancelled`] if `progress` asks to stop.
pub fn match_labels(
    reference: &Planes,
    others: &[ShiftedView<'_>],
    labels: &Labels,
    progress: &dyn Progress,
) -> Result<Vec<Choice>, Cancelled> {
    let (width, height) = (reference.width(), reference.height());
    let rows = (COSTS / (width * labels.count)).max(3 * OVERLAP);
    let core = if rows >= height { height } else { rows - 2 * OVERLAP };
    let mut chosen = Vec::with_capacity(width * height);
    for top in (0..height).step_by(core) {
        let end = (top + core).min(height);
        let strip = top.saturating_sub(OVERLAP)..(end + OVERLAP).min(height);
        let share = |y: usize| y as f32 / height as f32;
        let stage = Stage::new(progress, share(top), share(end));
        let volume = plane_sweep(reference, others, labels, strip.clone(), &stage)?;
        stage.report(0.85);
        let sums = aggregate(&volume, reference, &Penalties::default(), &stage)?;
        let own = (top - strip.start) * width * labels.count..(end - strip.start) * width * labels.count;
        chosen.par_extend(sums[own].par_chunks(labels.count).map(|costs| choose(costs, labels)));
        stage.report(1.0);
    }
    Ok(chosen)
}
