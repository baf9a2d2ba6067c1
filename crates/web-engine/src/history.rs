//! Undoing strokes.

use lens::FocusOffset;

/// The changes that may be kept, in all.
const MOST_CHANGES: usize = 2_000_000;

/// The focus of a sample, before and after a stroke.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change {
    pub sample: u32,
    pub before: FocusOffset,
    pub after: FocusOffset,
}

/// What was painted, stroke by stroke.
#[derive(Default)]
pub struct History {
    strokes: Vec<Vec<Change>>,
    /// How many of them are done; the others are undone.
    done: usize,
}

impl History {
    /// Adds a stroke that is done; what was undone is gone, and so are the oldest strokes beyond what may be kept.
    pub fn push(&mut self, stroke: Vec<Change>) {
        self.strokes.truncate(self.done);
        self.strokes.push(stroke);
        let mut count: usize = self.strokes.iter().map(Vec::len).sum();
        while count > MOST_CHANGES && self.strokes.len() > 1 {
            count -= self.strokes.remove(0).len();
        }
        self.done = self.strokes.len();
    }

    /// Undoes the last stroke that is done. Returns the samples whose focus changed; none if there is no such stroke.
    pub fn undo(&mut self, focus: &mut [FocusOffset]) -> Vec<u32> {
        let Some(last) = self.done.checked_sub(1) else { return Vec::new() };
        self.done = last;
        apply(&self.strokes[last], focus, |change| change.before)
    }

    /// Does the first stroke again that is undone. Returns the samples whose focus changed; none if there is no such stroke.
    pub fn redo(&mut self, focus: &mut [FocusOffset]) -> Vec<u32> {
        let Some(stroke) = self.strokes.get(self.done) else { return Vec::new() };
        self.done += 1;
        apply(stroke, focus, |change| change.after)
    }

    /// How many strokes can be undone, and how many done again.
    pub fn lengths(&self) -> [usize; 2] {
        [self.done, self.strokes.len() - self.done]
    }
}

fn apply(stroke: &[Change], focus: &mut [FocusOffset], value: fn(&Change) -> FocusOffset) -> Vec<u32> {
    let set = |change: &Change| {
        focus[change.sample as usize] = value(change);
        change.sample
    };
    stroke.iter().map(set).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stroke(sample: u32, from: f64, to: f64) -> Vec<Change> {
        vec![Change { sample, before: FocusOffset::new(from, 1.0), after: FocusOffset::new(to, 1.0) }]
    }

    #[test]
    fn strokes_are_undone_and_done_again() {
        let mut focus = [FocusOffset::new(1.2, 1.0), FocusOffset::new(1.3, 1.0)];
        let mut history = History::default();
        history.push(stroke(0, 1.0, 1.1));
        history.push(stroke(0, 1.1, 1.2));
        assert_eq!(history.undo(&mut focus), [0]);
        assert_eq!((focus[0].t, history.lengths()), (1.1, [1, 1]));
        history.undo(&mut focus);
        assert_eq!((focus[0].t, history.undo(&mut focus).len()), (1.0, 0));
        history.redo(&mut focus);
        assert_eq!(focus[0].t, 1.1);
        history.push(stroke(1, 1.3, 1.4));
        assert_eq!(history.lengths(), [2, 0], "what was undone is gone");
        assert!(history.redo(&mut focus).is_empty());
    }

    #[test]
    fn the_oldest_strokes_are_dropped() {
        let mut history = History::default();
        let large = vec![stroke(0, 1.0, 1.1)[0]; MOST_CHANGES / 2 + 1];
        (0..3).for_each(|_| history.push(large.clone()));
        assert_eq!(history.lengths(), [1, 0]);
    }
}
