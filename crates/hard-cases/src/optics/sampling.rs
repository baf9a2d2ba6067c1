//! Sampled aperture points have the density of the transmission.

use crate::case::{Case, Effort, Verdict};
use crate::support::measure::worst;
use glam::DVec2;
use lens::{Aperture, ApertureMask, ApertureSampler, ApertureShape};
use progress::{Cancelled, Progress};
use std::sync::Arc;
use test_scenes::Random;

pub const CASES: &[Case] = &[Case {
    name: "sampler χ² for every aperture shape",
    reason: "The counts of samples in a grid of cells are χ² distributed about the integrals of the \
             transmission.",
    control: "points scaled by their own distance from the centre: a uniformly distributed radius",
    check: sampler,
}];

/// An aperture mask from a function of u in [−1, 1]².
pub fn mask(side: u32, transmission: impl Fn(DVec2) -> f32) -> ApertureShape {
    let texel = |k: u32| {
        let place = DVec2::new(f64::from(k % side) + 0.5, f64::from(k / side) + 0.5);
        let u = place * 2.0 / f64::from(side) - 1.0;
        transmission(DVec2::new(u.x, -u.y))
    };
    let transmission = (0..side * side).map(texel).collect();
    ApertureShape::Mask(Arc::new(ApertureMask {
        width: side,
        height: side,
        transmission,
        file: "made".into(),
    }))
}

/// Apertures of every shape, with extreme and intermediate parameters.
pub fn every_shape() -> Vec<(&'static str, Aperture)> {
    let polygon = |blades, rotation, roundness| ApertureShape::Polygon { blades, rotation, roundness }.into();
    let ring = mask(96, |u| f32::from((0.5..0.9).contains(&u.length())));
    let grey = mask(7, |u| (0.5 + 0.5 * u.x * u.y) as f32);
    vec![
        ("disc", ApertureShape::Disc.into()),
        ("square", ApertureShape::Square.into()),
        ("triangle", polygon(3, 0.4, 0.0)),
        ("pentagon, half round", polygon(5, 1.0, 0.5)),
        ("hexagon, round", polygon(6, 0.0, 1.0)),
        ("64 blades", polygon(64, -7.0, 0.0)),
        ("ring", ring.into()),
        ("grey mask", grey.into()),
        ("wide disc", Aperture { shape: ApertureShape::Disc, ratio: 0.4 }),
        ("high ring", Aperture { shape: mask(96, |u| f32::from(u.length() > 0.7)), ratio: 2.5 }),
    ]
}

fn sampler(effort: Effort, progress: &dyn Progress) -> Result<Verdict, Cancelled> {
    let count = effort.choose(1_000_000, 60_000);
    let (mut right, mut wrong) = (Vec::new(), f64::INFINITY);
    for (_, aperture) in every_shape() {
        progress.check()?;
        let expected = cell_shares(&aperture);
        let sampler = ApertureSampler::new(&aperture);
        let mut random = Random(3);
        right.push(deviations(&expected, count, || sampler.sample(random.unit(), random.unit())));
        let mut random = Random(3);
        let clumped = || {
            let u = sampler.sample(random.unit(), random.unit());
            u * u.length()
        };
        wrong = wrong.min(deviations(&expected, count, clumped));
    }
    let expected =
        format!("of {} shapes, {count} points each, the worst below 4 standard deviations", right.len());
    Ok(Verdict::new(expected, [("deviations", 4.0)], [worst(right)], [wrong]))
}

/// Cells per side.
const CELLS: usize = 8;

fn cell_of(u: DVec2) -> usize {
    let last = DVec2::splat((CELLS - 1) as f64);
    let place = ((u + 1.0) / 2.0 * CELLS as f64).floor().clamp(DVec2::ZERO, last);
    place.y as usize * CELLS + place.x as usize
}

/// The share of the transmission in each cell, from 1024² points.
fn cell_shares(aperture: &Aperture) -> [f64; CELLS * CELLS] {
    const SIDE: usize = 1024;
    let mut shares = [0.0; CELLS * CELLS];
    for k in 0..SIDE * SIDE {
        let u = DVec2::new((k % SIDE) as f64 + 0.5, (k / SIDE) as f64 + 0.5) * 2.0 / SIDE as f64 - 1.0;
        shares[cell_of(u)] += aperture.transmission(u);
    }
    let total: f64 = shares.iter().sum();
    shares.map(|share| share / total)
}

/// Deviation of the χ² of `count` points from its mean in standard deviations, with the cube-root
/// transformation to normality (Wilson and Hilferty 1931). Cells with few expected points are merged.
fn deviations(shares: &[f64], count: u32, mut draw: impl FnMut() -> DVec2) -> f64 {
    const FEW: f64 = 20.0;
    let mut observed = [0.0; CELLS * CELLS];
    (0..count).for_each(|_| observed[cell_of(draw())] += 1.0);
    let expected = shares.iter().map(|share| share * f64::from(count));
    let (many, few): (Vec<_>, Vec<_>) = expected.zip(observed).partition(|(expected, _)| *expected > FEW);
    let rest = few.iter().fold((0.0, 0.0), |(e, f), (expected, observed)| (e + expected, f + observed));
    let chi_squared: f64 = many.iter().map(|(e, f)| (f - e) * (f - e) / e).sum();
    let beside = (rest.1 - rest.0).powi(2) / rest.0.max(1.0);
    let freedom = many.len() as f64 - 1.0 + f64::from(rest.0 > 0.0);
    let spread = 2.0 / (9.0 * freedom);
    (((chi_squared + beside) / freedom).cbrt() - (1.0 - spread)) / spread.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_deviation_is_that_of_chi_squared() {
        // The 0.1 % quantile of χ² with 63 degrees of freedom is 103.44; its normal deviate is 3.09.
        let shares = [1.0 / 64.0; 64];
        // Equal counts except for two cells that differ by ±d: χ² = 2d²/e.
        let (count, e) = (64_000u32, 1000.0f64);
        let d = (103.44 * e / 2.0).sqrt().round() as usize;
        let cells = (0..64usize).flat_map(|cell| {
            let n = [1000 + d, 1000 - d].get(cell).copied().unwrap_or(1000);
            std::iter::repeat_n(cell, n)
        });
        let mut points =
            cells.map(|cell| DVec2::new((cell % 8) as f64 + 0.5, (cell / 8) as f64 + 0.5) / 4.0 - 1.0);
        let deviation = deviations(&shares, count, || points.next().unwrap());
        assert!((deviation - 3.09).abs() < 0.05, "{deviation}");
    }
}
