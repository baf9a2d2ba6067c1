//! How far a long computation is, and whether it should stop.
//!
//! Long work (unwrapping, baking, rendering) takes a `&dyn Progress`. It calls [`Progress::report`] now and
//! then and stops with [`Cancelled`] when [`Progress::cancelled`] says so. The trait knows no clock and no
//! thread; who watches decides what to show.

/// What long work tells its watcher.
pub trait Progress: Sync {
    /// The share of the work that is done, in [0, 1]. May be called from any thread, and out of order.
    fn report(&self, fraction: f32);
    /// Whether the work is no longer wanted. Cheap: called in inner loops.
    fn cancelled(&self) -> bool;

    /// A part of the work begins: what it is called, in a word, and the share of the whole that it goes from and to. Who shows no names
    /// does nothing.
    fn begin_part(&self, _part: &Part) {}

    /// `Err(Cancelled)` once the work is no longer wanted.
    fn check(&self) -> Result<(), Cancelled> {
        if self.cancelled() { Err(Cancelled) } else { Ok(()) }
    }
}

/// A part of long work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// A word.
    pub name: &'static str,
    /// The share of the whole that is done when it begins, in [0, 1].
    pub from: f32,
    /// And when it ends.
    pub to: f32,
}

/// The work was stopped because nobody wants its result any more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cancelled;

impl std::fmt::Display for Cancelled {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("cancelled")
    }
}

impl std::error::Error for Cancelled {}

/// A watcher that neither looks nor stops.
pub struct Unwatched;

impl Progress for Unwatched {
    fn report(&self, _fraction: f32) {}
    fn cancelled(&self) -> bool {
        false
    }
}

/// Part of a longer computation: its [0, 1] is `start..end` of the whole.
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

    /// The same, which begins now and is called by a word.
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
