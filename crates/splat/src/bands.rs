//! How the picture's rows are divided among threads.
//!
//! What a node sends is drawn by every band that it reaches, and of a partly occluded one all rows must be known to draw any.
//! So there are as few bands as keep all threads busy, each with about the same work to do.

use salf::tree::BLOCK_PX;

/// Rows of a slot, which is never divided: a pixel of the coarsest level.
const SLOT_ROWS: u32 = BLOCK_PX as u32;

/// What there is to do, slot by slot from the picture's top.
pub struct Work(Vec<u64>);

impl Work {
    /// None, in a picture of this height.
    pub fn none(height: u32) -> Self {
        Self(vec![0; height.div_ceil(SLOT_ROWS).max(1) as usize])
    }

    /// More of it at a row, which may lie outside of the picture.
    pub fn add(&mut self, row: i32, cost: u64) {
        let slot = (row.max(0) as usize / SLOT_ROWS as usize).min(self.0.len() - 1);
        self.0[slot] += cost;
    }

    /// Where the first rows of `count` bands are, or of fewer: the first is 0.
    pub fn divided(&self, count: usize) -> Vec<u32> {
        let total: u64 = self.0.iter().sum();
        let (mut before, mut starts) = (0, vec![0]);
        for (slot, cost) in self.0.iter().enumerate() {
            // A band begins where the half of a slot's work is on its side.
            let wanted = total * starts.len() as u64 / count as u64;
            if starts.len() < count && slot > 0 && before + cost / 2 >= wanted {
                starts.push(slot as u32 * SLOT_ROWS);
            }
            before += cost;
        }
        starts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_have_alike_much_to_do() {
        let mut work = Work::none(320);
        (0..320).for_each(|row| work.add(row, if row < 160 { 1 } else { 3 }));
        assert_eq!(work.divided(1), [0]);
        assert_eq!(work.divided(2), [0, 208], "160 and 48·3 of 640; 16 rows more or less are 48");
        assert_eq!(work.divided(4).len(), 4);
        work.add(-500, 7000);
        assert_eq!(work.divided(2), [0, 16]);
    }

    #[test]
    fn nothing_to_do_is_divided_too() {
        assert_eq!(Work::none(0).divided(3), [0]);
        let starts = Work::none(100).divided(3);
        assert!(starts[0] == 0 && starts.windows(2).all(|pair| pair[0] < pair[1]), "{starts:?}");
    }
}
