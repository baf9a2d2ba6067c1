//! A lattice of cubic cells in space that lists the items in each cell.

use glam::{DVec3, IVec3};
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// Cubic cells, each with the numbers of the items that lie in it.
#[derive(Debug, Default)]
pub(super) struct Lattice {
    /// Side of a cell, world units.
    pub spacing: f64,
    /// By cell: where its items start in `numbers`, and how many there are.
    cells: HashMap<u64, (u32, u32), BuildHasherDefault<WordHasher>>,
    numbers: Vec<u32>,
}

/// A cheap hash of one word.
#[derive(Default)]
pub(super) struct WordHasher(u64);

impl Hasher for WordHasher {
    fn finish(&self) -> u64 {
        self.0
    }
    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|&byte| self.write_u64(u64::from(byte)));
    }
    fn write_u64(&mut self, word: u64) {
        self.0 = (self.0 ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29);
    }
}

/// Cell coordinates as one word. Cells beyond ±2²⁰ share words with others, which costs time but does no harm.
fn key(cell: IVec3) -> u64 {
    const BITS: u32 = 21;
    let part = |x: i32| u64::from(x as u32) & ((1 << BITS) - 1);
    part(cell.x) | part(cell.y) << BITS | part(cell.z) << (2 * BITS)
}

impl Lattice {
    /// The memory that it takes, in bytes.
    pub fn bytes(&self) -> usize {
        self.cells.capacity() * size_of::<(u64, (u32, u32))>() + size_of_val(&*self.numbers)
    }

    /// Sorts items into cells of side `spacing` (scene units): the numbers of the items, and the cell of each.
    pub fn new(spacing: f64, items: impl IntoIterator<Item = (u32, IVec3)>) -> Self {
        let mut items: Vec<(u64, u32)> =
            items.into_iter().map(|(number, cell)| (key(cell), number)).collect();
        items.sort_unstable();
        let mut cells = HashMap::default();
        let mut begin = 0;
        for run in items.chunk_by(|a, b| a.0 == b.0) {
            cells.insert(run[0].0, (begin, run.len() as u32));
            begin += run.len() as u32;
        }
        Self { spacing, cells, numbers: items.into_iter().map(|(_, number)| number).collect() }
    }

    /// The cell, of side `spacing`, that contains a position; both in scene units.
    pub fn cell(spacing: f64, position: DVec3) -> IVec3 {
        (position / spacing).floor().as_ivec3()
    }

    /// The numbers of the items in a cell, ascending; empty if there are none.
    pub fn numbers(&self, cell: IVec3) -> &[u32] {
        let (begin, count) = self.cells.get(&key(cell)).copied().unwrap_or_default();
        &self.numbers[begin as usize..(begin + count) as usize]
    }

    /// Visits the items of the eight cells around a position, each with its trilinear weight.
    #[inline]
    pub fn visit_around(&self, position: DVec3, mut visit: impl FnMut(u32, f64)) {
        let at = position / self.spacing - 0.5;
        let low = at.floor();
        let share = at - low;
        for corner in 0..8 {
            let up = IVec3::new(corner & 1, corner >> 1 & 1, corner >> 2);
            let along = |up: i32, share: f64| if up == 1 { share } else { 1.0 - share };
            let weight = along(up.x, share.x) * along(up.y, share.y) * along(up.z, share.z);
            for &number in self.numbers(low.as_ivec3() + up) {
                visit(number, weight);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_lie_in_their_cells_and_shares_sum_to_one() {
        let cells: Vec<IVec3> = (0..27).map(|k| IVec3::new(k % 3, k / 3 % 3, k / 9) - 1).collect();
        let lattice = Lattice::new(0.5, (0..).zip(cells.iter().copied()));
        for (number, &cell) in (0..).zip(&cells) {
            assert_eq!(lattice.numbers(cell), [number]);
            assert_eq!(Lattice::cell(0.5, (cell.as_dvec3() + 0.3) * 0.5), cell);
        }
        assert!(lattice.numbers(IVec3::splat(7)).is_empty());
        let mut sum = 0.0;
        lattice.visit_around(DVec3::new(0.2, 0.13, 0.31), |_, share| sum += share);
        assert!((sum - 1.0).abs() < 1e-12);
        lattice.visit_around(DVec3::splat(0.25), |number, share| {
            assert_eq!(share, f64::from(u8::from(cells[number as usize] == IVec3::ZERO)));
        });
    }
}
