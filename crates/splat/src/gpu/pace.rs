//! How many records a card draws per submission.

use crate::gpu::formats::KINDS;
use graphics_card::{Gpu, Lost};
use std::collections::VecDeque;
use std::time::{Duration, Instant};
use wgpu::SubmissionIndex;

/// Initial records by kind: few enough that no card takes a second. In tests there are several batches, too.
const FIRST: [usize; KINDS] =
    if cfg!(test) { [1 << 7, 1 << 6, 1 << 5, 1 << 5] } else { [1 << 16, 1 << 15, 1 << 14, 1 << 9] };

/// What a batch that takes less is followed by is twice as large; half as large what follows one that takes more.
const SHORT: Duration = Duration::from_millis(4);
const LONG: Duration = Duration::from_millis(16);

/// At most this many batches are in flight: other users of the card wait for them, and cancelled work ends soon.
const MAX_IN_FLIGHT: usize = 4;

/// Records of one kind, for one kind of accumulators.
#[derive(Clone, Copy)]
pub struct Batch {
    /// Accumulators: ordinary (0) or wide (1).
    pub width: usize,
    /// As in pen.wgsl.
    pub kind: usize,
    /// Records.
    pub count: usize,
}

/// Batches as large as a card draws in a moment: a large card idles over small ones, a small one is blocked by large ones.
pub struct Pace {
    sizes: [[usize; KINDS]; 2],
    in_flight: VecDeque<(Batch, SubmissionIndex, Instant)>,
    last_done: Instant,
}

impl Pace {
    /// The pace for a card that has not been measured.
    pub fn new() -> Self {
        Self { sizes: [FIRST; 2], in_flight: VecDeque::new(), last_done: Instant::now() }
    }

    /// How many records to submit next, for sums of this width (0 ordinary, 1 wide) and kind (0 free, 1 sharing).
    pub fn size(&self, width: usize, kind: usize) -> usize {
        self.sizes[width][kind]
    }

    /// Registers a submission, and waits while too many are in flight.
    ///
    /// # Errors
    /// The card is lost.
    pub fn add(&mut self, gpu: &Gpu, batch: Batch, submission: SubmissionIndex) -> Result<(), Lost> {
        self.in_flight.push_back((batch, submission, Instant::now()));
        if self.in_flight.len() <= MAX_IN_FLIGHT {
            return Ok(());
        }
        let Some((batch, first, submitted_at)) = self.in_flight.pop_front() else { return Ok(()) };
        gpu.wait_for(first)?;
        let done = Instant::now();
        self.learn(batch, done - submitted_at.max(self.last_done));
        self.last_done = done;
        Ok(())
    }

    /// Forgets all submissions: others have waited for them, or nobody has to.
    pub fn clear(&mut self) {
        self.in_flight.clear();
    }

    fn learn(&mut self, batch: Batch, took: Duration) {
        let size = &mut self.sizes[batch.width][batch.kind];
        if took > LONG {
            *size = (*size / 2).max(FIRST[batch.kind]);
        } else if took < SHORT && batch.count >= *size {
            *size = (2 * *size).min(64 * FIRST[batch.kind]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn batches_grow_while_they_are_short_and_shrink_when_they_are_long() {
        let mut pace = Pace::new();
        let of = |count| Batch { width: 0, kind: 1, count };
        pace.learn(of(FIRST[1]), SHORT / 2);
        assert_eq!(pace.size(0, 1), 2 * FIRST[1]);
        assert_eq!(pace.size(1, 1), FIRST[1], "of its own accumulators alone");
        // What remains at the end tells nothing of whole ones.
        pace.learn(of(1), SHORT / 2);
        pace.learn(of(2 * FIRST[1]), (SHORT + LONG) / 2);
        assert_eq!(pace.size(0, 1), 2 * FIRST[1]);
        (0..100).for_each(|_| pace.learn(of(usize::MAX), SHORT / 2));
        assert_eq!(pace.size(0, 1), 64 * FIRST[1]);
        (0..100).for_each(|_| pace.learn(of(1), 2 * LONG));
        assert_eq!(pace.size(0, 1), FIRST[1]);
    }
}
