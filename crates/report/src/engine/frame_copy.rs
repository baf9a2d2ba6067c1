//! The unit of time: copying one frame. It is timed alongside each task, because the speed of a machine
//! varies over time.

use crate::measurement::stopwatch::median_seconds;
use rayon::prelude::*;
use session::SessionError;
use std::time::Instant;

/// The time of a task, and the time to copy one frame meanwhile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Median, s.
    pub seconds: f64,
    /// Median, s.
    pub frame_copy: f64,
}

impl Timing {
    /// The time of the task as a multiple of that of copying a frame.
    pub fn frame_copies(self) -> f64 {
        self.seconds / self.frame_copy
    }
}

/// Tasks are repeated until this much time per task has passed, s …
const MIN_SECONDS_PER_TASK: f64 = 3.0;
/// … or each was done this often.
const MAX_ROUNDS: usize = 11;
/// Frame copies after each task.
const COPIES_PER_ROUND: usize = 3;

/// Two RGB float frames; one is copied to the other with all threads.
pub struct FrameCopy {
    source: Vec<[f32; 3]>,
    target: Vec<[f32; 3]>,
    /// Times of the copies, s.
    times: Vec<f64>,
}

impl FrameCopy {
    /// Prepares to copy frames of this number of pixels.
    pub fn new(pixels: usize) -> Self {
        Self { source: vec![[0.5; 3]; pixels], target: vec![[0.0; 3]; pixels], times: Vec::new() }
    }

    /// Median time of all copies, s.
    pub fn seconds(&self) -> f64 {
        median_seconds(&mut self.times.clone())
    }

    /// The timing of a task that has just taken `seconds`.
    pub fn timing_of(&mut self, seconds: f64) -> Timing {
        let before = self.times.len();
        (0..MAX_ROUNDS).for_each(|_| self.copy());
        Timing { seconds, frame_copy: median_seconds(&mut self.times[before..].to_vec()) }
    }

    /// Times several tasks in turn, with frame copies between them; slow tasks are repeated less often.
    ///
    /// # Errors
    /// A task fails.
    pub fn time_interleaved(
        &mut self,
        tasks: &mut [impl FnMut() -> Result<(), SessionError>],
    ) -> Result<Vec<Timing>, SessionError> {
        let before = self.times.len();
        let mut times = vec![Vec::new(); tasks.len()];
        let begun = Instant::now();
        while times.iter().any(|times| times.len() < MAX_ROUNDS) {
            for (task, times) in tasks.iter_mut().zip(&mut times) {
                let start = Instant::now();
                task()?;
                times.push(start.elapsed().as_secs_f64());
                (0..COPIES_PER_ROUND).for_each(|_| self.copy());
            }
            if begun.elapsed().as_secs_f64() >= MIN_SECONDS_PER_TASK * tasks.len() as f64 {
                break;
            }
        }
        let frame_copy = median_seconds(&mut self.times[before..].to_vec());
        Ok(times.iter_mut().map(|times| Timing { seconds: median_seconds(times), frame_copy }).collect())
    }

    fn copy(&mut self) {
        let rows = self.source.len().div_ceil(rayon::current_num_threads()).max(1);
        let start = Instant::now();
        let chunks = self.target.par_chunks_mut(rows).zip(self.source.par_chunks(rows));
        chunks.for_each(|(to, from)| to.copy_from_slice(from));
        std::hint::black_box(&self.target);
        self.times.push(start.elapsed().as_secs_f64());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn works_take_turns_with_copies_between() {
        let mut frame = FrameCopy::new(64);
        let order = std::cell::RefCell::new(Vec::new());
        let mut tasks = ["a", "b"].map(|name| {
            let order = &order;
            move || {
                order.borrow_mut().push(name);
                Ok(())
            }
        });
        let timings = frame.time_interleaved(&mut tasks).unwrap();
        assert_eq!(order.borrow().len(), 2 * MAX_ROUNDS);
        assert!(order.borrow().chunks(2).all(|turn| turn == ["a", "b"]));
        assert_eq!(frame.times.len(), 2 * MAX_ROUNDS * COPIES_PER_ROUND);
        assert!(timings.len() == 2 && timings.iter().all(|timing| timing.frame_copy == frame.seconds()));
        let timing = Timing { seconds: 3.0, frame_copy: 0.5 };
        assert_eq!(timing.frame_copies(), 6.0);
        assert!(frame.time_interleaved(&mut [|| Err(SessionError::Cancelled)]).is_err());
    }
}
