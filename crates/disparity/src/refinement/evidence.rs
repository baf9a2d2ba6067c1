//! What the views contribute to the disparity of a pixel, given its present one: a Gauss–Newton step, and its certainty.
//!
//! With ∇I the reference's gradient, a view at offset b in which the point is visible shows I(x) + δ ∇I·b at the place for disparity d if
//! d + δ is right. So with r the differences there, over all channels and all views from which the point is not hidden (`occlusion`),
//!
//! ```text
//! δ = Σ w r (∇I·b) / Σ w (∇I·b)²,     1/var δ = Σ w (∇I·b)² / 3σ²
//! ```
//!
//! (Lucas and Kanade, *An Iterative Image Registration Technique*, IJCAI 1981, for one offset; one unknown per pixel, as the offsets are
//! known). The weights w are those of Geman and McClure. Noise has a gradient, too, which is no evidence: it is subtracted. An edge
//! belongs to the nearer surface: gradients do not extend across to what occludes the pixel.

use crate::matching::sweep::ShiftedView;
use crate::planes::Planes;
use crate::refinement::occlusion::OcclusionTest;
use progress::{Cancelled, Progress};
use rayon::prelude::*;

/// The evidence for one pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Evidence {
    /// The correction of the disparity.
    pub step: f32,
    /// The inverse variance of the disparity, 1 / px².
    pub certainty: f32,
    /// The share of the views in which the point is visible that show its colour, in [0, 1].
    pub agreement: f32,
    /// The share of the views that cover its place from which nothing nearer occludes it, in [0, 1].
    pub visibility: f32,
}

/// Where a squared residual counts as an outlier: so many variances of noise,
const CUT: f32 = 9.0;

/// and this part of the squared gradient, for interpolation errs more where the picture is steep.
const STEEP: f32 = 0.02;

/// How many times the contribution of noise to the normal equation is subtracted: about three of its standard
/// deviations.
const NOISE_TAKEN_OFF: f32 = 3.0;

/// The evidence for the requested pixels of the reference at these disparities; for others the default.
pub fn collect_evidence(
    reference: &Planes,
    others: &[ShiftedView<'_>],
    disparity: &[f32],
    noise: f32,
    is_requested: &(impl Fn(usize) -> bool + Sync),
    progress: &dyn Progress,
) -> Result<Vec<Evidence>, Cancelled> {
    let width = reference.width();
    let offsets: Vec<_> = others.iter().map(|view| view.offset).collect();
    let occlusion = OcclusionTest::new(disparity, width, &offsets);
    let mut evidence = vec![Evidence::default(); disparity.len()];
    evidence.par_chunks_mut(width).enumerate().try_for_each(|(y, row)| {
        progress.check()?;
        for (x, pixel) in row.iter_mut().enumerate().filter(|(x, _)| is_requested(y * width + x)) {
            *pixel = pixel_evidence(reference, others, (x, y), disparity[y * width + x], noise, &occlusion);
        }
        Ok(())
    })?;
    Ok(evidence)
}

fn pixel_evidence(
    reference: &Planes,
    others: &[ShiftedView<'_>],
    (x, y): (usize, usize),
    disparity: f32,
    noise: f32,
    occlusion: &OcclusionTest<'_>,
) -> Evidence {
    let own = reference.pixel(x, y);
    let gradient = gradient(reference, occlusion.unoccluded_neighbours((x, y), disparity));
    let steepness: f32 = gradient.iter().map(|g| g[0] * g[0] + g[1] * g[1]).sum();
    let cut = CUT * (6.0 * noise * noise + STEEP * steepness);
    let nearest = occlusion.nearest_occluder(x, y);
    let (mut normal, mut right_side, mut lengths) = (0.0, 0.0, 0.0);
    let (mut agreeing, mut visible_weight, mut all) = (0.0, 0.0, 0.0);
    for view in others {
        let [u, v] = view.offset;
        let place = (x as f32 - disparity * u, y as f32 - disparity * v);
        let Some(there) = view.planes.sample_bilinear(place.0, place.1) else { continue };
        all += view.weight;
        if occlusion.is_occluded((x, y), disparity, nearest, view.offset) {
            continue;
        }
        let residual: [f32; 3] = std::array::from_fn(|c| there[c] - own[c]);
        let robust = 1.0 / (1.0 + residual.iter().map(|r| r * r).sum::<f32>() / cut);
        let weight = robust * robust * view.weight;
        visible_weight += view.weight;
        agreeing += weight;
        lengths += weight * (u * u + v * v);
        for (gradient, residual) in gradient.iter().zip(residual) {
            let along = gradient[0] * u + gradient[1] * v;
            normal += weight * along * along;
            right_side += weight * along * residual;
        }
    }
    if visible_weight <= 0.0 {
        return Evidence::default();
    }
    let (agreement, visibility) = (agreeing / visible_weight, visible_weight / all);
    // A central difference of noise has the variance σ²/2; three channels, half of the squared length along each
    // axis.
    let by_noise = 0.75 * noise * noise * lengths;
    let signal = normal - NOISE_TAKEN_OFF * by_noise;
    if signal <= 0.0 {
        return Evidence { step: 0.0, certainty: 0.0, agreement, visibility };
    }
    Evidence { step: right_side / normal, certainty: signal / (3.0 * noise * noise), agreement, visibility }
}

/// Differences of the three channels per pixel, from the first to the last pixel, along a row and along a column.
fn gradient(
    picture: &Planes,
    [(left, right, y), (above, below, x)]: [(usize, usize, usize); 2],
) -> [[f32; 2]; 3] {
    let across = [picture.pixel(left, y), picture.pixel(right, y)];
    let down = [picture.pixel(x, above), picture.pixel(x, below)];
    std::array::from_fn(|c| {
        [
            (across[1][c] - across[0][c]) / (right - left).max(1) as f32,
            (down[1][c] - down[0][c]) / (below - above).max(1) as f32,
        ]
    })
}
