//! The noise level of the views: from the differences of the nearest of them where they show the same point.

use crate::matching::sweep::ShiftedView;
use crate::planes::Planes;
use numerics::{MAD_OF_NORMAL, upper_median};

/// The noise of 8-bit values from a noise-free renderer; the unit of certainties.
const MIN_NOISE: f32 = 0.003;

/// The standard deviation of the noise of a value, from the median of the differences to the nearest views.
pub fn estimate_noise(reference: &Planes, others: &[ShiftedView<'_>], disparity: &[f32]) -> f32 {
    let length = |view: &ShiftedView<'_>| view.offset[0].hypot(view.offset[1]);
    let nearest = others.iter().map(length).fold(f32::MAX, f32::min);
    let width = reference.width();
    let mut sizes = Vec::new();
    for view in others.iter().filter(|view| length(view) < 1.5 * nearest) {
        // Every seventh pixel is plenty, and follows no pattern of eight or of rows.
        for index in (0..disparity.len()).step_by(7) {
            let (x, y, d) = (index % width, index / width, disparity[index]);
            let place = (x as f32 - d * view.offset[0], y as f32 - d * view.offset[1]);
            let Some(there) = view.planes.sample_bilinear(place.0, place.1) else { continue };
            let own = reference.pixel(x, y);
            let mut differences: [f32; 3] = std::array::from_fn(|c| (there[c] - own[c]).abs());
            differences.sort_unstable_by(f32::total_cmp);
            sizes.push(differences[1]);
        }
    }
    let Some(median) = upper_median(&mut sizes) else { return MIN_NOISE };
    // A difference of two values, one of them a mean of up to four: √(1 + 4/9) = 1.2 standard deviations.
    (median / MAD_OF_NORMAL as f32 / 1.2).max(MIN_NOISE)
}
