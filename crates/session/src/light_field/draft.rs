//! Pictures of fewer pixels that are there while a whole sum is made: what is dragged follows the hand.

use crate::error::SessionError;
use lens::{Camera, Picture};
use progress::Progress;
use splat::Splatter;

/// A draft takes about so long at most, s, if it can.
const DRAFT_SECONDS: f64 = 0.05;

/// What share of a picture's time that of a picture with half the sides takes.
const SHARE_OF_HALVED: f64 = 0.45;

/// How often sides are halved at most, and if it is not known how long a whole sum takes: a third time makes discs squares.
const MOST_HALVINGS: u8 = 2;

/// What draws drafts of a light field.
pub(crate) struct Draft {
    splatter: Splatter,
    halvings: u8,
}

impl Draft {
    /// The memory of its sums, in bytes.
    pub fn bytes(&self) -> usize {
        let [_, sums] = self.splatter.bytes();
        sums
    }

    /// The picture of `of`, whose whole sum takes so many seconds, with fewer pixels and the paint that `of` has, for the lens of `camera`. What is
    /// in `draft` is used again, if it fits.
    ///
    /// # Errors
    /// The sum overflows, or the work was cancelled.
    pub fn sum<'a>(
        draft: &'a mut Option<Self>,
        (of, whole_seconds): (&Splatter, f64),
        camera: &Camera,
        progress: &dyn Progress,
    ) -> Result<&'a Picture, SessionError> {
        let halvings = halvings(whole_seconds);
        let mut splatter = match draft.take().filter(|draft| draft.halvings == halvings) {
            Some(draft) => draft.splatter,
            None => of.draft(halvings),
        };
        splatter.set_tolerance(of.tolerance());
        splatter.take_paint_of(of);
        splatter.refocus(camera, progress)?;
        Ok(draft.insert(Self { splatter, halvings }).splatter.picture())
    }
}

/// How often the sides of a draft are halved, if a whole sum takes so many seconds.
fn halvings(whole_seconds: f64) -> u8 {
    if whole_seconds.is_infinite() {
        return MOST_HALVINGS;
    }
    let needed = (DRAFT_SECONDS / whole_seconds).log(SHARE_OF_HALVED).ceil();
    needed.clamp(1.0, MOST_HALVINGS.into()) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longer_a_sum_takes_the_smaller_is_its_draft() {
        assert_eq!([0.0, 0.1, 0.2, 0.5, 9.0, f64::INFINITY].map(halvings), [1, 1, 2, 2, 2, 2]);
    }
}
