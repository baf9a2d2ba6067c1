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
    cells: Spans,
    numbers: Vec<u32>,
    /// By the lowest of eight cells that meet: where their items start in `meeting`, and how many there are.
    corners: Spans,
    meeting: Vec<Meeting>,
}

type Spans = HashMap<u64, (u32, u32), BuildHasherDefault<WordHasher>>;

/// An item in one of eight cells that meet: its number, and which of the cells it is, a bit for each axis along which that is
/// the upper one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Meeting {
    cell: u8,
    number: u32,
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
        (self.cells.capacity() + self.corners.capacity()) * size_of::<(u64, (u32, u32))>()
            + size_of_val(&*self.numbers)
            + size_of_val(&*self.meeting)
    }

    /// Sorts items into cells of side `spacing` (scene units): the numbers of the items, and the cell of each.
    pub fn new(spacing: f64, items: impl IntoIterator<Item = (u32, IVec3)>) -> Self {
        let items: Vec<(u32, IVec3)> = items.into_iter().collect();
        let (cells, numbers) = grouped(items.iter().map(|&(number, cell)| (key(cell), number)));
        let meeting = items.iter().flat_map(|&(number, cell)| {
            (0..8).map(move |of_eight| (key(cell - upper(of_eight)), Meeting { cell: of_eight, number }))
        });
        let (corners, meeting) = grouped(meeting);
        Self { spacing, cells, numbers, corners, meeting }
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

    /// The items of the eight cells around a position, each with its trilinear weight.
    #[inline]
    pub fn around(&self, position: DVec3) -> impl Iterator<Item = (u32, f64)> + Clone {
        let at = position / self.spacing - 0.5;
        let low = at.floor();
        let share = at - low;
        let weights = std::array::from_fn::<f64, 8, _>(|of_eight| {
            let up = upper(of_eight as u8);
            let along = |up: i32, share: f64| if up == 1 { share } else { 1.0 - share };
            along(up.x, share.x) * along(up.y, share.y) * along(up.z, share.z)
        });
        let (begin, count) = self.corners.get(&key(low.as_ivec3())).copied().unwrap_or_default();
        let meeting = &self.meeting[begin as usize..(begin + count) as usize];
        meeting.iter().map(move |&Meeting { cell, number }| (number, weights[usize::from(cell & 7)]))
    }
}

/// Along which axes one of eight cells that meet is the upper one: 1, elsewhere 0.
#[inline]
fn upper(of_eight: u8) -> IVec3 {
    let bit = |axis: u8| i32::from(of_eight >> axis & 1);
    IVec3::new(bit(0), bit(1), bit(2))
}

/// Items by key, in ascending order: where those of a key start, and how many there are.
fn grouped<T: Copy + Ord>(items: impl Iterator<Item = (u64, T)>) -> (Spans, Vec<T>) {
    let mut items: Vec<(u64, T)> = items.collect();
    items.sort_unstable();
    let mut spans = Spans::default();
    let mut begin = 0;
    for run in items.chunk_by(|a, b| a.0 == b.0) {
        spans.insert(run[0].0, (begin, run.len() as u32));
        begin += run.len() as u32;
    }
    (spans, items.into_iter().map(|(_, item)| item).collect())
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
        let sum: f64 = lattice.around(DVec3::new(0.2, 0.13, 0.31)).map(|(_, share)| share).sum();
        assert!((sum - 1.0).abs() < 1e-12);
        assert_eq!(lattice.around(DVec3::splat(0.25)).count(), 8);
        for (number, share) in lattice.around(DVec3::splat(0.25)) {
            assert_eq!(share, f64::from(u8::from(cells[number as usize] == IVec3::ZERO)));
        }
        let beside = lattice.around(DVec3::splat(0.99)).collect::<Vec<_>>();
        assert_eq!(beside.len(), 1, "seven of the eight cells are empty: {beside:?}");
        assert_eq!(cells[beside[0].0 as usize], IVec3::ONE);
    }
}
