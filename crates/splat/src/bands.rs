//! How the picture's rows are divided among threads.
//!
//! What a node sends is drawn by every band that it reaches, and of a partly occluded one all rows must be known to draw any.
//! So there are as few bands as keep all threads busy, each with about the same work to do: by what drawing is estimated to cost,
//! and by how long the last picture took.

use salf::tree::BLOCK_PX;
use std::ops::Range;
use std::time::Duration;
#[cfg(not(target_family = "wasm"))]
use std::time::Instant;

/// Rows of a slot, which is never divided: a pixel of the coarsest level.
const SLOT_ROWS: u32 = BLOCK_PX as u32;

/// Measures how long work takes; where there is no clock, nothing.
pub struct Stopwatch {
    #[cfg(not(target_family = "wasm"))]
    start: Instant,
}

impl Stopwatch {
    pub fn start() -> Self {
        Self {
            #[cfg(not(target_family = "wasm"))]
            start: Instant::now(),
        }
    }

    pub fn elapsed(&self) -> Duration {
        #[cfg(not(target_family = "wasm"))]
        return self.start.elapsed();
        #[cfg(target_family = "wasm")]
        Duration::ZERO
    }
}

/// The work to be done, slot by slot from the picture's top.
pub struct Work(Vec<u64>);

impl Work {
    /// No work, in a picture of `height` rows.
    pub fn empty(height: u32) -> Self {
        Self(vec![0; height.div_ceil(SLOT_ROWS).max(1) as usize])
    }

    /// Adds work of this cost at a pixel row, which may lie outside of the picture.
    pub fn add(&mut self, row: i32, cost: u64) {
        let slot = (row.max(0) as usize / SLOT_ROWS as usize).min(self.0.len() - 1);
        self.0[slot] += cost;
    }

    /// Where the first rows of `count` bands are, or of fewer: the first is 0.
    pub fn band_starts(&self, count: usize, pace: &Pace) -> Vec<u32> {
        let costs = || self.0.iter().enumerate().map(|(slot, &cost)| cost as f64 * pace.slot_pace(slot));
        let total: f64 = costs().sum();
        let (mut before, mut starts) = (0.0, vec![0]);
        for (slot, cost) in costs().enumerate() {
            // A band begins where the half of a slot's work is on its side.
            let target = total * starts.len() as f64 / count as f64;
            if starts.len() < count && slot > 0 && before + cost / 2.0 >= target {
                starts.push(slot as u32 * SLOT_ROWS);
            }
            before += cost;
        }
        starts
    }

    /// The work of some rows.
    fn cost_of_rows(&self, rows: &Range<u32>) -> u64 {
        self.0[slots(rows, self.0.len())].iter().sum()
    }
}

/// The slots of some rows, of `count` in all.
fn slots(rows: &Range<u32>, count: usize) -> Range<usize> {
    let end = (rows.end.div_ceil(SLOT_ROWS) as usize).min(count);
    (rows.start / SLOT_ROWS) as usize..end
}

/// How much longer work takes than it was estimated to, slot by slot, beside that of all slots: what pictures before took.
#[derive(Clone, Debug, Default)]
pub struct Pace(Vec<f64>);

impl Pace {
    /// 1 for a slot that has had no work.
    fn slot_pace(&self, slot: usize) -> f64 {
        self.0.get(slot).copied().unwrap_or(1.0)
    }

    /// Learns from bands of a picture that were worked on for so long. Half of what was known stays: a band may have been
    /// disturbed.
    pub fn learn(&mut self, work: &Work, bands: &[(Range<u32>, Duration)]) {
        const MAX_RATIO: f64 = 4.0;
        self.0.resize(work.0.len(), 1.0);
        let took = |band: &(Range<u32>, Duration)| band.1.as_secs_f64();
        let (time, all) = (bands.iter().map(took).sum::<f64>(), work.0.iter().sum::<u64>() as f64);
        for band in bands {
            let pace = took(band) / time * all / work.cost_of_rows(&band.0) as f64;
            if pace.is_finite() {
                for slot_pace in &mut self.0[slots(&band.0, work.0.len())] {
                    *slot_pace = (*slot_pace + pace.clamp(1.0 / MAX_RATIO, MAX_RATIO)) / 2.0;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_have_alike_much_to_do() {
        let mut work = Work::empty(320);
        (0..320).for_each(|row| work.add(row, if row < 160 { 1 } else { 3 }));
        let pace = Pace::default();
        assert_eq!(work.band_starts(1, &pace), [0]);
        assert_eq!(work.band_starts(2, &pace), [0, 208], "160 and 48·3 of 640; 16 rows more or less are 48");
        assert_eq!(work.band_starts(4, &pace).len(), 4);
        work.add(-500, 7000);
        assert_eq!(work.band_starts(2, &pace), [0, 16]);
    }

    #[test]
    fn bands_come_to_take_alike_long() {
        let (mut work, mut pace) = (Work::empty(1600), Pace::default());
        (0..1600).for_each(|row| work.add(row, 1000));
        // What lies below takes three times as long as it is estimated to.
        let took = |rows: &Range<u32>| rows.clone().map(|row| if row < 800 { 1 } else { 3 }).sum::<u64>();
        let bands = |pace: &Pace| {
            let starts = work.band_starts(2, pace);
            [0..starts[1], starts[1]..1600].map(|rows| (rows.clone(), Duration::from_micros(took(&rows))))
        };
        let [above, below] = bands(&pace);
        assert_eq!((above.1.as_micros(), below.1.as_micros()), (800, 2400));
        for _ in 0..10 {
            pace.learn(&work, &bands(&pace));
        }
        let [above, below] = bands(&pace);
        let apart = above.1.as_secs_f64() / below.1.as_secs_f64();
        assert!((0.9..1.1).contains(&apart), "{above:?} {below:?}");
    }

    #[test]
    fn nothing_is_learned_from_no_work() {
        let mut pace = Pace::default();
        pace.learn(&Work::empty(100), &[(0..48, Duration::ZERO), (48..u32::MAX, Duration::ZERO)]);
        assert_eq!(pace.0, vec![1.0; 7]);
    }

    #[test]
    fn nothing_to_do_is_divided_too() {
        assert_eq!(Work::empty(0).band_starts(3, &Pace::default()), [0]);
        let starts = Work::empty(100).band_starts(3, &Pace::default());
        assert!(starts[0] == 0 && starts.windows(2).all(|pair| pair[0] < pair[1]), "{starts:?}");
    }
}
