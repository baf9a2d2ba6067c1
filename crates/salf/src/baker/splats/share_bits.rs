//! Shares of the aperture's cells as bits with one weight.
//!
//! The weight is that of what sees most: the mean of the shares that are about the largest. Each cell of a field is visible or not, so that the mean over any
//! part of the aperture is about that of the shares: by error diffusion along a Hilbert curve, from a random start with a random error, without bias (as Velho
//! and Gomes 1991 dither pictures). Patterns of neighbours differ, so that their errors do not add up.
//!
//! A bit of a field stands for at most about as much light as one of the finest field of an opaque sample: what weighs less has a coarser field
//! ([`Fineness`]), which takes fewer bytes for the same error.

use crate::jitter::jitter;
use crate::sample::Visibility;
use std::sync::LazyLock;

/// Cells a side for which shares are told.
const CELLS: usize = 8;

/// The same where they are computed for a rough picture: each is told four times.
const ROUGH_CELLS: usize = CELLS / 2;

/// Shares that vary no more than from this part of the largest to it are one share.
const EVEN: f32 = 0.8;

/// Shares below it are either this or nothing, at random, without bias: fewer samples for the same light.
const LEAST: f32 = 0.03;

/// What weighs less, px², has a field of 4 × 4.
pub const COARSE_BELOW_PX2: f32 = 1.0 / 16.0;

/// How fine the field of a sample is.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Fineness {
    /// 4 × 4 cells, as a field of 8 × 8.
    Coarse,
    /// 8 × 8 cells.
    Medium,
    /// 16 × 16 cells.
    Fine,
}

impl Fineness {
    /// For a weight, px², and what else hides parts of the aperture.
    fn of(weight: f32, visibility: &Visibility) -> Self {
        let of_weight = match weight {
            weight if weight < COARSE_BELOW_PX2 => Self::Coarse,
            weight if weight < 1.0 / 4.0 => Self::Medium,
            _ => Self::Fine,
        };
        let of_cells = match visibility {
            Visibility::Open => Self::Coarse,
            Visibility::Cells { words } if Visibility::side_of(words) == CELLS => Self::Medium,
            Visibility::Cells { .. } => Self::Fine,
        };
        of_weight.max(of_cells)
    }

    /// Cells a side whose bits are chosen.
    fn side(self) -> usize {
        4 << self as usize
    }

    /// The cells, row · side + column, along a Hilbert curve.
    fn curve(self) -> &'static [u8] {
        static CURVES: LazyLock<[Vec<u8>; 3]> = LazyLock::new(|| [4, 8, 16].map(hilbert_curve));
        &CURVES[self as usize]
    }
}

/// The cells of a square of `side` × `side`, a power of two up to 16, row · side + column, along a Hilbert curve.
fn hilbert_curve(side: usize) -> Vec<u8> {
    let cell = |place: usize| {
        let (mut x, mut y, mut rest, mut part) = (0, 0, place, 1);
        while part < side {
            let (right, up) = (rest >> 1 & 1, (rest ^ rest >> 1) & 1);
            if up == 0 {
                if right == 1 {
                    (x, y) = (part - 1 - x, part - 1 - y);
                }
                (x, y) = (y, x);
            }
            (x, y, rest, part) = (x + part * right, y + part * up, rest >> 2, 2 * part);
        }
        (y * side + x) as u8
    };
    (0..side * side).map(cell).collect()
}

/// Weight and visibility of something of which the cells of the aperture see these shares, row by row: 8 × 8, 4 × 4, or one for all. `visibility` is the part of the
/// aperture from which nothing else hides it, `seed` chooses the pattern. `None` if nothing is visible.
pub fn share_bits(
    shares: impl Iterator<Item = f32>,
    visibility: &Visibility,
    seed: [u32; 3],
) -> Option<(f32, Visibility)> {
    let mut list = [0.0; CELLS * CELLS];
    let count = list.iter_mut().zip(shares).map(|(place, share)| *place = share).count();
    if count == ROUGH_CELLS * ROUGH_CELLS {
        let rough = list;
        list = std::array::from_fn(|cell| rough[cell / CELLS / 2 * ROUGH_CELLS + cell % CELLS / 2]);
    }
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
    let most = list.iter().copied().filter(|share| *share >= EVEN * largest);
    let (sum, count) = most.fold((0.0, 0), |(sum, count), share| (sum + share, count + 1));
    let weight = sum / count as f32;
    if count == list.len() {
        return Some((weight * scale, visibility.clone()));
    }
    let fineness = Fineness::of(weight * scale, visibility);
    let relative = list.map(|share| if share >= EVEN * largest { 1.0 } else { share / weight });
    let bits = choose_bits(&relative, fineness, visibility, start, error as f32 - 0.5)?;
    Some((weight * scale, bits))
}

/// A field whose bits are as often set as `shares`, in [0, 1], say, where `visibility` lets them. `start` chooses where the curve begins, in [0, 1), with the error
/// `error`, in [−½, ½). `None` if no bit is set.
fn choose_bits(
    shares: &[f32; CELLS * CELLS],
    fineness: Fineness,
    visibility: &Visibility,
    start: f64,
    mut error: f32,
) -> Option<Visibility> {
    let (side, curve) = (fineness.side(), fineness.curve());
    let share = |row: usize, column: usize| {
        if side >= CELLS {
            let part = side / CELLS;
            return shares[row / part * CELLS + column / part];
        }
        let part = CELLS / side;
        let rows = part * row..part * (row + 1);
        let cells =
            rows.flat_map(|row| (part * column..part * (column + 1)).map(move |column| row * CELLS + column));
        cells.map(|cell| shares[cell]).sum::<f32>() / (part * part) as f32
    };
    let sees = |row: usize, column: usize| match visibility {
        Visibility::Open => true,
        Visibility::Cells { words } => {
            let part = side / Visibility::side_of(words);
            Visibility::row(words, row / part) >> (column / part) & 1 == 1
        }
    };
    let mut words = [0u64; 4];
    let field = side.max(CELLS);
    let start = (start * curve.len() as f64) as usize;
    for step in 0..curve.len() {
        let cell = usize::from(curve[(start + step) % curve.len()]);
        let (row, column) = (cell / side, cell % side);
        if !sees(row, column) {
            continue;
        }
        error += share(row, column);
        if error >= 0.5 {
            error -= 1.0;
            let part = field / side;
            for bit in (0..part * part).map(|k| (part * row + k / part) * field + part * column + k % part) {
                words[bit / 64] |= 1 << (bit % 64);
            }
        }
    }
    let words = &words[..field * field / 64];
    words.iter().any(|word| *word != 0).then(|| Visibility::from_words(words))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_visits_every_cell_once_and_steps_to_neighbours() {
        for fineness in [Fineness::Coarse, Fineness::Medium, Fineness::Fine] {
            let (side, curve) = (fineness.side(), fineness.curve());
            let mut visited = vec![false; side * side];
            curve.iter().for_each(|cell| visited[usize::from(*cell)] = true);
            assert!(curve.len() == side * side && visited.iter().all(|is_visited| *is_visited));
            for pair in curve.windows(2) {
                let [[x, y], [u, v]] =
                    [pair[0], pair[1]].map(|cell| [usize::from(cell) % side, usize::from(cell) / side]);
                assert_eq!(x.abs_diff(u) + y.abs_diff(v), 1);
            }
        }
    }

    #[test]
    fn rough_shares_are_those_of_four_cells_each() {
        let rough: [f32; 16] = std::array::from_fn(|cell| (cell % 5) as f32 / 5.0);
        let fine = (0..64).map(|cell| rough[cell / 16 * 4 + cell % 8 / 2]);
        for seed in 0..50 {
            let of =
                |shares: &mut dyn Iterator<Item = f32>| share_bits(shares, &Visibility::Open, [seed, 1, 2]);
            assert_eq!(of(&mut rough.into_iter()), of(&mut fine.clone()));
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
            let side = Visibility::side_of(&words);
            let part = side / CELLS;
            for cell in 0..side * side {
                let is_visible = Visibility::row(&words, cell / side) >> (cell % side) & 1 == 1;
                let light = if is_visible { f64::from(weight) / (part * part) as f64 } else { 0.0 };
                sums[cell / side / part * CELLS + cell % side / part] += light / f64::from(COUNT);
            }
        }
        sums
    }

    #[test]
    fn what_weighs_little_has_a_coarse_field() {
        for (share, sides) in [(0.9, 16), (0.2, 8), (0.05, 8)] {
            let half = |k: usize| if k % 8 < 4 { share } else { 0.4 * share };
            let (weight, bits) = share_bits((0..64).map(half), &Visibility::Open, [3; 3]).expect("visible");
            let Visibility::Cells { words } = bits else { panic!("part of it is hidden") };
            assert!(
                (weight - share).abs() < 1e-6 && Visibility::side_of(&words) == sides,
                "{weight} {words:?}"
            );
            let row = |row| Visibility::row(&words, row);
            // Of 4 × 4 cells, rows and columns are pairs.
            let is_coarse =
                (0..4).all(|k| row(2 * k) == row(2 * k + 1) && row(2 * k) & 0x55 == row(2 * k) >> 1 & 0x55);
            assert_eq!(is_coarse, share < 0.0625);
        }
        let hidden = Visibility::from_words(&[0, u64::MAX, u64::MAX, u64::MAX]);
        let (_, bits) = share_bits((0..64).map(|k| 0.0005 * k as f32), &hidden, [9; 3]).expect("visible");
        assert!(matches!(bits, Visibility::Cells { words } if words.len() == 4 && words[0] == 0));
    }

    #[test]
    fn shares_are_met_on_average() {
        let ramp: [f32; 64] = std::array::from_fn(|k| 0.01 * k as f32);
        let faint: [f32; 64] = std::array::from_fn(|k| if k < 32 { 0.01 } else { 0.002 });
        for shares in [ramp, faint] {
            let largest = f64::from(shares.iter().copied().fold(0.0, f32::max)).max(f64::from(LEAST));
            let means = mean_of(shares, &Visibility::Open);
            for (mean, share) in means.iter().zip(shares) {
                // Four bits of either value, 4000 times; those from 0.8 on are one.
                let even = if f64::from(share) < 0.8 * largest { 0.03 } else { 0.2 };
                assert!((mean - f64::from(share)).abs() < even * largest, "{mean} {share}");
            }
            let [mean, share] = [means.iter().sum::<f64>(), shares.iter().copied().map(f64::from).sum()];
            assert!((mean / share - 1.0).abs() < 0.01, "{mean} {share}");
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
