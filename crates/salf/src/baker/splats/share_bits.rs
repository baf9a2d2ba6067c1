//! Shares of the aperture's cells as bits with one weight.
//!
//! The weight is the largest share. Each of 16 × 16 cells is visible or not, so that the mean over any part of the aperture is about that of the shares: by
//! error diffusion along a Hilbert curve, from a random start with a random error, without bias (as Velho and Gomes 1991 dither pictures). Patterns of
//! neighbours differ, so that their errors do not add up.

use crate::jitter::jitter;
use crate::sample::Visibility;
use std::sync::LazyLock;

/// Cells a side for which shares are computed.
pub const CELLS: usize = 8;
/// Cells a side of the bits.
const BITS: usize = 16;

/// Shares that vary no more than from this part of the largest to it are one share of the whole aperture.
const EVEN: f32 = 0.8;

/// Shares below it are either this or nothing, at random, without bias: fewer samples for the same light.
const LEAST: f32 = 0.03;

/// The cells of the bits, row · 16 + column, along a Hilbert curve.
static HILBERT: LazyLock<[u8; BITS * BITS]> = LazyLock::new(|| {
    let mut curve = [0; BITS * BITS];
    for (place, cell) in curve.iter_mut().enumerate() {
        let (mut x, mut y, mut rest, mut side) = (0, 0, place, 1);
        while side < BITS {
            let (right, up) = (rest >> 1 & 1, (rest ^ rest >> 1) & 1);
            if up == 0 {
                if right == 1 {
                    (x, y) = (side - 1 - x, side - 1 - y);
                }
                (x, y) = (y, x);
            }
            (x, y, rest, side) = (x + side * right, y + side * up, rest >> 2, 2 * side);
        }
        *cell = (y * BITS + x) as u8;
    }
    curve
});

/// Weight and visibility of something of which the cells of the aperture see these shares, row by row: 8 × 8, or one for all. `visibility` is the part of the
/// aperture from which nothing else hides it, `seed` chooses the pattern. `None` if nothing is visible.
pub fn share_bits(
    shares: impl Iterator<Item = f32>,
    visibility: &Visibility,
    seed: [u32; 3],
) -> Option<(f32, Visibility)> {
    let mut list = [0.0; CELLS * CELLS];
    let count = list.iter_mut().zip(shares).map(|(place, share)| *place = share).count();
    if count == 1 {
        return (list[0] > 0.0).then(|| (list[0], visibility.clone()));
    }
    let [chance, start, error] = jitter(seed[0], seed[1], seed[2]);
    let largest = list.iter().copied().fold(0.0, f32::max);
    if largest <= 0.0 {
        return None;
    }
    let scale = if largest < LEAST { LEAST / largest } else { 1.0 };
    if chance >= f64::from(1.0 / scale) {
        return None;
    }
    if list.iter().all(|share| *share >= EVEN * largest) {
        let mean = list.iter().sum::<f32>() / list.len() as f32;
        return Some((mean * scale, visibility.clone()));
    }
    let sees = |cell: usize| match visibility {
        Visibility::Open => true,
        Visibility::Cells { words } => {
            let part = BITS / Visibility::side_of(words);
            Visibility::row(words, cell / BITS / part) >> (cell % BITS / part) & 1 == 1
        }
    };
    let (mut error, start) = (error as f32 - 0.5, (start * (BITS * BITS) as f64) as usize);
    let mut words = [0u64; 4];
    for step in 0..BITS * BITS {
        let cell = usize::from(HILBERT[(start + step) % (BITS * BITS)]);
        if !sees(cell) {
            continue;
        }
        let (row, column) = (cell / BITS, cell % BITS);
        let part = BITS / CELLS;
        error += list[row / part * CELLS + column / part] / largest;
        if error >= 0.5 {
            error -= 1.0;
            words[row / 4] |= 1 << (row % 4 * BITS + column);
        }
    }
    let is_visible = words.iter().any(|word| *word != 0);
    is_visible.then(|| (largest * scale, Visibility::from_words(&words)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_visits_every_cell_once_and_steps_to_neighbours() {
        let mut visited = [false; BITS * BITS];
        HILBERT.iter().for_each(|cell| visited[usize::from(*cell)] = true);
        assert!(visited.iter().all(|is_visited| *is_visited));
        for pair in HILBERT.windows(2) {
            let [[x, y], [u, v]] = [pair[0], pair[1]].map(|cell| [cell % 16, cell / 16]);
            assert_eq!(x.abs_diff(u) + y.abs_diff(v), 1);
        }
    }

    /// The mean light of many patterns, in each of 8 × 8 cells.
    fn mean_of(shares: [f32; 64], visibility: &Visibility) -> [f64; 64] {
        const COUNT: u32 = 4000;
        let mut sums = [0.0; 64];
        for seed in 0..COUNT {
            let Some((weight, bits)) = share_bits(shares.into_iter(), visibility, [seed, 7, 3]) else {
                continue;
            };
            let words = match bits {
                Visibility::Open => vec![u64::MAX; 4],
                Visibility::Cells { words } => words.to_vec(),
            };
            for cell in 0..BITS * BITS {
                let is_visible = Visibility::row(&words, cell / BITS) >> (cell % BITS) & 1 == 1;
                let light = if is_visible { f64::from(weight) / 4.0 } else { 0.0 };
                sums[cell / BITS / 2 * 8 + cell % BITS / 2] += light / f64::from(COUNT);
            }
        }
        sums
    }

    #[test]
    fn shares_are_met_on_average() {
        let ramp: [f32; 64] = std::array::from_fn(|k| 0.01 * k as f32);
        let faint: [f32; 64] = std::array::from_fn(|k| if k < 32 { 0.01 } else { 0.002 });
        for shares in [ramp, faint] {
            let largest = f64::from(shares.iter().copied().fold(0.0, f32::max)).max(f64::from(LEAST));
            for (mean, share) in mean_of(shares, &Visibility::Open).iter().zip(shares) {
                // Four bits of either value, 4000 times.
                assert!((mean - f64::from(share)).abs() < 0.03 * largest, "{mean} {share}");
            }
        }
        let hidden = Visibility::from_words(&[0x0000_0000_FFFF_FFFF]);
        for (cell, mean) in mean_of(ramp, &hidden).iter().enumerate() {
            let expected = if cell < 32 { f64::from(ramp[cell]) } else { 0.0 };
            assert!((mean - expected).abs() < 0.02, "{cell}: {mean} {expected}");
        }
    }

    #[test]
    fn even_shares_are_a_weight_alone() {
        assert_eq!(
            share_bits([0.5; 64].into_iter(), &Visibility::Open, [1; 3]),
            Some((0.5, Visibility::Open))
        );
        assert_eq!(share_bits([0.25].into_iter(), &Visibility::Open, [1; 3]), Some((0.25, Visibility::Open)));
        assert_eq!(share_bits([0.0; 64].into_iter(), &Visibility::Open, [1; 3]), None);
        let [bright, dark] = [0.9, 0.1].map(|share| {
            let shares = (0..64).map(|k| if k == 0 { 0.9 } else { share });
            share_bits(shares, &Visibility::Open, [1; 3])
        });
        assert!(
            matches!(bright, Some((_, Visibility::Open)))
                && matches!(dark, Some((_, Visibility::Cells { .. })))
        );
    }
}
