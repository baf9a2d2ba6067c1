//! Progress reporting and cancellation of long computations.
//!
//! Long work (unwrapping, baking, rendering) takes a `&dyn Progress`. It calls [`Progress::report`] from time to time
//! and stops with [`Cancelled`] once [`Progress::cancelled`] is true. The trait depends on no clock and no thread;
//! the observer decides what to show.
//!
//! # Example
//!
//! ```
//! use progress::{Cancelled, Progress, Stage, Unwatched};
//!
//! fn work(progress: &dyn Progress) -> Result<(), Cancelled> {
//!     for step in 0..10 {
//!         progress.check()?;
//!         progress.report(step as f32 / 10.0);
//!     }
//!     Ok(())
//! }
//! work(&Stage::new(&Unwatched, 0.0, 0.5)).unwrap();
//! ```

/// Receives the progress of long work and can cancel it.
pub trait Progress: Sync {
    /// Reports the fraction of the work that is done, in [0, 1]. May be called from any thread, and out of order.
    fn report(&self, fraction: f32);
    /// Whether the work has been cancelled. Cheap: called in inner loops.
    fn cancelled(&self) -> bool;

    /// Reports that a named part of the work begins. Observers that show no names ignore it.
    fn begin_part(&self, _part: &Part) {}

    /// Checks for cancellation.
    ///
    /// # Errors
    /// [`Cancelled`] once the work has been cancelled.
    fn check(&self) -> Result<(), Cancelled> {
        if self.cancelled() { Err(Cancelled) } else { Ok(()) }
    }
}

/// A named part of long work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// Its name, one word.
    pub name: &'static str,
    /// The fraction of the whole that is done when it begins, in [0, 1].
    pub from: f32,
    /// The fraction of the whole that is done when it ends.
    pub to: f32,
}

/// The work was cancelled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cancelled;

impl std::fmt::Display for Cancelled {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("cancelled")
    }
}

impl std::error::Error for Cancelled {}

/// An observer that ignores reports and never cancels.
pub struct Unwatched;

impl Progress for Unwatched {
    fn report(&self, _fraction: f32) {}
    fn cancelled(&self) -> bool {
        false
    }
}

/// A part of a longer computation: its [0, 1] is `start..end` of the whole.
pub struct Stage<'a> {
    whole: &'a dyn Progress,
    start: f32,
    end: f32,
}

impl<'a> Stage<'a> {
    /// The stage `start..end` of `whole`.
    pub fn new(whole: &'a dyn Progress, start: f32, end: f32) -> Self {
        Self { whole, start, end }
    }

    /// As [`Self::new`], reporting that the named part begins now.
    pub fn named(whole: &'a dyn Progress, name: &'static str, start: f32, end: f32) -> Self {
        whole.begin_part(&Part { name, from: start, to: end });
        Self { whole, start, end }
    }

    fn to_whole(&self, fraction: f32) -> f32 {
        self.start + (self.end - self.start) * fraction.clamp(0.0, 1.0)
    }
}

impl Progress for Stage<'_> {
    fn report(&self, fraction: f32) {
        self.whole.report(self.to_whole(fraction));
    }
    fn cancelled(&self) -> bool {
        self.whole.cancelled()
    }
    fn begin_part(&self, part: &Part) {
        self.whole.begin_part(&Part { from: self.to_whole(part.from), to: self.to_whole(part.to), ..*part });
    }
}
