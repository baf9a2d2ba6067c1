//! How many queries a card is asked at once.

use std::time::Duration;

/// What takes less is followed by twice as many queries, what takes more by half as many: others wait for the card as long.
const SHORT: Duration = Duration::from_millis(6);
const LONG: Duration = Duration::from_millis(24);

/// The least and the most queries of a batch.
const LEAST: usize = 1 << 8;
const MOST: usize = 1 << 18;

/// The size of batches, learnt from those before.
pub struct Pace {
    size: usize,
}

impl Pace {
    /// The pace of a card that has not been measured.
    pub fn new() -> Self {
        Self { size: LEAST }
    }

    /// How many queries to submit next.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Takes note of how long a batch took.
    pub fn learn(&mut self, count: usize, took: Duration) {
        if took > LONG {
            self.size = (self.size / 2).max(LEAST);
        } else if took < SHORT && count >= self.size {
            self.size = (2 * self.size).min(MOST);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn batches_grow_while_they_are_short_and_shrink_when_they_are_long() {
        let mut pace = Pace::new();
        pace.learn(LEAST, SHORT / 2);
        assert_eq!(pace.size(), 2 * LEAST);
        // What remains at the end tells nothing of whole ones.
        pace.learn(1, SHORT / 2);
        pace.learn(2 * LEAST, (SHORT + LONG) / 2);
        assert_eq!(pace.size(), 2 * LEAST);
        (0..100).for_each(|_| pace.learn(usize::MAX, SHORT / 2));
        assert_eq!(pace.size(), MOST);
        (0..100).for_each(|_| pace.learn(1, 2 * LONG));
        assert_eq!(pace.size(), LEAST);
    }
}
