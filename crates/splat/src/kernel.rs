//! The aperture as the splat uses it: cut to rows and to cells at every size that a splat may have.

use glam::DVec2;
use lens::{Aperture, ApertureRow};
use salf::Visibility;

/// An aperture, ready to be splatted at any size. Coordinates are those of the baked square [−1, 1]²; a lens stopped
/// down from the baked one fills only the middle of it.
pub struct Kernel {
    /// The lens's aperture radius as a share of the baked one.
    stop: f64,
    /// Level ℓ has 2^ℓ rows.
    levels: Vec<Level>,
    /// Mean of the open area, and its standard deviation: for splats under a pixel.
    mean: DVec2,
    deviation: DVec2,
    /// Share of the open area in each cell of the baked square, row 0 at v = −1: for 8 and for 16 cells a side.
    cells: [Vec<f64>; 2],
}

/// The aperture in rows, in units of the lens's own radius.
///
/// Rows are boxes, and few of them lie beside, and spread more or less than, the shape they stand for; moved to its mean
/// and stretched about it they have its variance. So where neighbouring samples take different levels, no light is moved
/// to or from between them, and a small opening in a large mask stays in its place.
struct Level {
    rows: Vec<ApertureRow>,
    open_area: f64,
    /// Mean of the rows as they are cut, and where it is moved to.
    mean: DVec2,
    target: DVec2,
    stretch: DVec2,
}

/// A smaller change of weight over the aperture, as a share of it, is not followed.
const SMALLEST_CHANGE: f64 = 0.005;

/// A smaller change over the aperture of the weight of a partly occluded sample is not followed.
const EVEN_ENOUGH: f64 = 0.03;

/// Splats of a larger diameter, px, are cut less finely.
const LARGE_PX: f64 = 8.0;

/// A larger change of weight over the aperture is followed along the rows of large splats too.
const LARGEST_UNCUT_CHANGE: f64 = 0.1;

/// Splats of a smaller diameter, px, are a box.
const SMALLEST_CUT_PX: f64 = 0.75;

/// A piece of the aperture: a rectangle in [−1, 1]² and its share of the open area.
#[derive(Clone, Copy, Debug)]
pub struct Piece {
    /// Centre.
    pub center: DVec2,
    /// Half its sides.
    pub half_size: DVec2,
    /// Share of the open area.
    pub share: f64,
}

/// The weight of a sample over the aperture: max(0, `at_center` + `gradient`·u).
#[derive(Clone, Copy, Debug)]
pub struct LinearWeight {
    /// w toward the aperture's centre.
    pub at_center: f64,
    /// ∂w/∂u.
    pub gradient: DVec2,
}

impl LinearWeight {
    fn at(self, u: DVec2) -> f64 {
        (self.at_center + self.gradient.dot(u)).max(0.0)
    }

    /// A piece with the weight in its share, and its centre moved to where the weighted light of the piece is.
    fn applied_to(self, piece: Piece) -> Piece {
        let weight = self.at(piece.center);
        if weight <= 0.0 {
            return Piece { share: 0.0, ..piece };
        }
        let shift = piece.half_size.powf(2.0) / 3.0 * self.gradient / weight;
        let center = piece.center + shift.clamp(-piece.half_size, piece.half_size);
        Piece { center, share: piece.share * weight, ..piece }
    }
}

impl Kernel {
    /// Cells a side of the finest visibility.
    const CELLS: usize = 16;
    /// Rows are cut down to 2^FINEST; a larger splat has rows of several pixels.
    const FINEST: usize = 7;

    /// Cuts `aperture`, whose radius is `stop` ≤ 1 of the baked one.
    pub fn new(aperture: &Aperture, stop: f64) -> Self {
        // Every level looks at every texel: of a mask, only as many as the finest can tell apart.
        let aperture = &*aperture.coarsened(2 << Self::FINEST);
        let mut levels: Vec<_> = (0..=Self::FINEST).map(|level| Level::new(aperture, 1 << level)).collect();
        let (mean, deviation) = levels[Self::FINEST].moments();
        levels.iter_mut().for_each(|level| level.match_moments(mean, deviation));
        let cells = [8, 16].map(|side| levels[Self::FINEST].cell_shares(stop, side));
        Self { stop, levels, mean: mean * stop, deviation: deviation * stop, cells }
    }

    /// The pieces of the whole aperture, times the linear `weight` of the aperture point, for a splat of signed radius
    /// `radius_px` (of the baked aperture).
    ///
    /// Rows of which `in_band` of [v₀, v₁] is false are left out.
    pub fn pieces(
        &self,
        radius_px: f64,
        weight: LinearWeight,
        in_band: impl Fn([f64; 2]) -> bool,
        mut emit: impl FnMut(Piece),
    ) {
        let diameter = 2.0 * radius_px.abs() * self.stop;
        let change = weight.gradient.abs().element_sum() * self.stop;
        let is_slanted = change >= SMALLEST_CHANGE * weight.at_center;
        if diameter < SMALLEST_CUT_PX && !is_slanted {
            // A box of the same mean and variance.
            let piece = Piece { center: self.mean, half_size: self.deviation * 3f64.sqrt(), share: 1.0 };
            emit(weight.applied_to(piece));
            return;
        }
        // Small splats have rows of half a pixel to a pixel, others of one to two: a row's box is then lost in the
        // footprint. On a slanted surface there are at least four, cut into pieces while the splat is small or its
        // weight changes much.
        let (fewest, finer) = (if is_slanted { 2 } else { 1 }, i32::from(diameter < LARGE_PX));
        let level = (diameter.log2().floor() as i32 + finer).clamp(fewest, Self::FINEST as i32) as usize;
        let cut = is_slanted && (diameter < LARGE_PX || change > LARGEST_UNCUT_CHANGE * weight.at_center);
        let longest = if cut { 0.5 } else { f64::INFINITY };
        self.levels[level].pieces(self.stop, longest, in_band, |piece| emit(weight.applied_to(piece)));
    }

    /// The pieces that the cells of `words` let through, times `weight` of the aperture point, for a splat of signed
    /// radius `radius_px`: blocks of cells of a pixel or two, neighbours of equal share joined.
    pub fn visible_pieces(
        &self,
        words: &[u64],
        radius_px: f64,
        weight: LinearWeight,
        in_band: impl Fn([f64; 2]) -> bool,
        mut emit: impl FnMut(Piece),
    ) {
        // A weight that hardly changes is taken as even, so that neighbouring cells can be joined.
        let is_even = weight.gradient.abs().element_sum() < EVEN_ENOUGH * weight.at_center;
        let weight = if is_even { LinearWeight { gradient: DVec2::ZERO, ..weight } } else { weight };
        let side = Visibility::side_of(words);
        let wanted = (2.0 * radius_px.abs() / 1.5).max(1.0).log2().ceil() as u32;
        let blocks = (1usize << wanted.min(side.ilog2())).max(1);
        let mut shares = [0.0; Self::CELLS];
        for row in (0..blocks).filter(|&row| in_band(row_span(row, blocks))) {
            let shares = &mut shares[..blocks];
            self.block_row(words, side, row, shares, weight);
            let mut column = 0;
            while column < blocks {
                let share = shares[column];
                let alike = shares[column..].iter().take_while(|&&other| other == share).count();
                if share > 0.0 {
                    let size = DVec2::new(alike as f64, 1.0) / blocks as f64;
                    let corner = DVec2::new(column as f64, row as f64) * (2.0 / blocks as f64) - 1.0;
                    emit(Piece { center: corner + size, half_size: size, share: share * alike as f64 });
                }
                column += alike;
            }
        }
    }

    /// The shares of one row of blocks: of `shares.len()` blocks a side, each the sum of its open cells.
    fn block_row(&self, words: &[u64], side: usize, row: usize, shares: &mut [f64], weight: LinearWeight) {
        let cells_a_block = side / shares.len();
        let cells = &self.cells[side / 16];
        shares.fill(0.0);
        for cell_row in row * cells_a_block..(row + 1) * cells_a_block {
            let mut bits = Visibility::row(words, cell_row);
            while bits != 0 {
                let column = bits.trailing_zeros() as usize;
                bits &= bits - 1;
                let center =
                    DVec2::new(column as f64 + 0.5, cell_row as f64 + 0.5) * (2.0 / side as f64) - 1.0;
                shares[column / cells_a_block] += cells[cell_row * side + column] * weight.at(center);
            }
        }
    }
}

impl Level {
    fn new(aperture: &Aperture, rows: usize) -> Self {
        let rows = aperture.rows(rows);
        let open_area = rows.open_area();
        Self { rows: rows.rows, open_area, mean: DVec2::ZERO, target: DVec2::ZERO, stretch: DVec2::ONE }
    }

    /// Pieces at most `longest` wide along their row.
    fn pieces(
        &self,
        stop: f64,
        longest: f64,
        in_band: impl Fn([f64; 2]) -> bool,
        mut emit: impl FnMut(Piece),
    ) {
        let height = 2.0 / self.rows.len() as f64;
        for (i, row) in self.rows.iter().enumerate() {
            let v = -1.0 + height * (i as f64 + 0.5);
            let middle = (self.target.y + (v - self.mean.y) * self.stretch.y) * stop;
            let half_height = height / 2.0 * self.stretch.y * stop;
            if !in_band([middle - half_height, middle + half_height]) {
                continue;
            }
            for run in &row.runs {
                let parts = ((run.end - run.start) / longest).ceil().max(1.0);
                let width = (run.end - run.start) / parts;
                for part in 0..parts as usize {
                    let u = run.start + width * (part as f64 + 0.5);
                    let center = self.target + (DVec2::new(u, v) - self.mean) * self.stretch;
                    emit(Piece {
                        center: center * stop,
                        half_size: DVec2::new(width, height) / 2.0 * self.stretch * stop,
                        share: width * height * run.transmission / self.open_area,
                    });
                }
            }
        }
    }

    /// Moves and stretches the level to a given mean and standard deviation.
    fn match_moments(&mut self, target: DVec2, wanted: DVec2) {
        let (mean, deviation) = self.moments();
        self.mean = mean;
        self.target = target;
        self.stretch = wanted / deviation;
    }

    /// Mean and standard deviation of the open area.
    fn moments(&self) -> (DVec2, DVec2) {
        let (mut mean, mut square) = (DVec2::ZERO, DVec2::ZERO);
        self.pieces(
            1.0,
            f64::INFINITY,
            |_| true,
            |piece| {
                mean += piece.center * piece.share;
                square += (piece.center.powf(2.0) + piece.half_size.powf(2.0) / 3.0) * piece.share;
            },
        );
        (mean, (square - mean.powf(2.0)).max(DVec2::ZERO).map(f64::sqrt))
    }

    /// Share of the open area in each of `side` × `side` cells of the baked square.
    fn cell_shares(&self, stop: f64, side: usize) -> Vec<f64> {
        let mut cells = vec![0.0; side * side];
        let span = |center: f64, half: f64| [-half, half].map(|h| (center + h + 1.0) / 2.0 * side as f64);
        self.pieces(
            stop,
            f64::INFINITY,
            |_| true,
            |piece| {
                let columns = span(piece.center.x, piece.half_size.x);
                let rows = span(piece.center.y, piece.half_size.y);
                let area = (columns[1] - columns[0]) * (rows[1] - rows[0]);
                for (row, height) in overlaps(rows, side) {
                    for (column, width) in overlaps(columns, side) {
                        cells[row * side + column] += piece.share * height * width / area;
                    }
                }
            },
        );
        cells
    }
}

/// From where to where a row of `rows` lies in [−1, 1].
fn row_span(row: usize, rows: usize) -> [f64; 2] {
    [row, row + 1].map(|k| -1.0 + 2.0 * k as f64 / rows as f64)
}

/// The cells of 0..count that `span` overlaps, with the length of each overlap.
fn overlaps(span: [f64; 2], count: usize) -> impl Iterator<Item = (usize, f64)> {
    let cells = span[0].max(0.0) as usize..(span[1].ceil() as usize).min(count);
    cells.map(move |k| (k, (span[1].min(k as f64 + 1.0) - span[0].max(k as f64)).max(0.0)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use lens::ApertureShape;

    const ONE: LinearWeight = LinearWeight { at_center: 1.0, gradient: DVec2::ZERO };

    #[test]
    fn shares_sum_to_one_at_every_size() {
        let shapes = [
            ApertureShape::Disc,
            ApertureShape::Square,
            ApertureShape::Polygon { blades: 5, rotation: 0.2, roundness: 0.3 },
        ];
        for shape in shapes {
            for stop in [1.0, 0.4] {
                let kernel = Kernel::new(&shape.clone().into(), stop);
                assert!((kernel.cells[1].iter().sum::<f64>() - 1.0).abs() < 1e-9);
                for radius in [0.0, -0.3, 0.7, -5.0, 40.0, 900.0] {
                    let mut sum = 0.0;
                    kernel.pieces(radius, ONE, |_| true, |piece| sum += piece.share);
                    assert!((sum - 1.0).abs() < 1e-9);
                    for words in [&[u64::MAX; 1][..], &[u64::MAX; 4]] {
                        let mut sum = 0.0;
                        kernel.visible_pieces(words, radius, ONE, |_| true, |piece| sum += piece.share);
                        assert!((sum - 1.0).abs() < 1e-9, "{shape:?} {stop} {radius}");
                    }
                }
            }
        }
    }

    /// A tilted weight moves the splat's centre by ∂w/∂u·σ² and keeps its mass, at every size.
    #[test]
    fn moments_are_those_of_the_shape_at_every_size() {
        let kernel = Kernel::new(&ApertureShape::Disc.into(), 1.0);
        let weight = LinearWeight { at_center: 2.0, gradient: DVec2::new(0.4, -0.2) };
        for radius in [0.3, 0.6, 1.3, 3.0, 20.0, 100.0] {
            let (mut sum, mut mean, mut square) = (0.0, DVec2::ZERO, DVec2::ZERO);
            kernel.pieces(
                radius,
                weight,
                |_| true,
                |piece| {
                    sum += piece.share;
                    mean += piece.share * piece.center;
                    square += piece.share * (piece.center.powf(2.0) + piece.half_size.powf(2.0) / 3.0);
                },
            );
            assert!((sum - 2.0).abs() < 1e-6, "{radius}: {sum}");
            assert!(mean.distance(DVec2::new(0.1, -0.05)) < 2e-3, "{radius}: {mean}");
            assert!((square / 2.0).distance(DVec2::splat(0.25)) < 6e-3, "{radius}: {square}");
        }
    }

    /// One texel of a large mask keeps its place at every size, to half a cell of the finest level.
    #[test]
    fn a_small_opening_stays_in_its_place() {
        let mut transmission = vec![0.0; 64 * 64];
        transmission[5 * 64 + 50] = 1.0;
        let mask = lens::ApertureMask { width: 64, height: 64, transmission, file: String::new() };
        let kernel = Kernel::new(&ApertureShape::Mask(mask.into()).into(), 1.0);
        let texel = DVec2::new(50.5 / 32.0 - 1.0, 1.0 - 5.5 / 32.0);
        for radius in [0.1, 1.0, 3.0, 20.0, 100.0] {
            let mut mean = DVec2::ZERO;
            kernel.pieces(radius, ONE, |_| true, |piece| mean += piece.share * piece.center);
            assert!(mean.distance(texel) < 1.0 / 128.0, "{radius}: {mean}, expected {texel}");
        }
    }

    #[test]
    fn half_an_aperture_lets_half_pass() {
        let kernel = Kernel::new(&ApertureShape::Disc.into(), 1.0);
        let right = [0xFF00_FF00_FF00_FF00u64; 4];
        for radius in [0.1, 3.0, 30.0] {
            let (mut sum, mut mean) = (0.0, DVec2::ZERO);
            kernel.visible_pieces(
                &right,
                radius,
                ONE,
                |_| true,
                |piece| {
                    sum += piece.share;
                    mean += piece.share * piece.center;
                },
            );
            assert!((sum - 0.5).abs() < 1e-3 && (radius < 1.0 || mean.x > 0.2), "{radius}: {sum} {mean}");
        }
    }
}
