//! Parsing lists of frames: `1-100`, `1-100x2`, `1-3,5,7-10:2`.

use std::str::FromStr;

/// Frame numbers, ascending and unique.
///
/// ```
/// let frames: render::FrameList = "1-3,5,7-10:2".parse()?;
/// assert_eq!(frames.numbers(), [1, 2, 3, 5, 7, 9]);
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrameList(Vec<u32>);

impl FrameList {
    /// Maximum number of frames: more than four hours at 24 frames per second.
    pub const MAX_FRAMES: usize = 400_000;

    /// A list of one frame.
    pub fn single(frame: u32) -> Self {
        Self(vec![frame])
    }

    /// The frame numbers.
    pub fn numbers(&self) -> &[u32] {
        &self.0
    }
}

impl FromStr for FrameList {
    type Err = String;

    /// Parses comma-separated frames and ranges. A range may have a step after `x` (as renderers write it) or `:` (as in Open Job
    /// Description).
    fn from_str(text: &str) -> Result<Self, String> {
        let number = |text: &str| {
            let number = text.trim().parse::<u32>();
            number
                .map_err(|_| format!("{text:?} is not a frame number (write 1-100, 1-100x2 or 1-3,5,7-10:2)"))
        };
        let mut frames = Vec::new();
        for part in text.split(',') {
            let (range, step) = match part.split_once(['x', ':']) {
                Some((range, step)) => (range, number(step)?),
                None => (part, 1),
            };
            let (first, last) = match range.split_once('-') {
                Some((first, last)) => (number(first)?, number(last)?),
                None => (number(range)?, number(range)?),
            };
            if step == 0 {
                return Err(format!("{part:?}: the step must not be 0"));
            }
            if last < first {
                return Err(format!("{part:?} ends before it begins"));
            }
            let count = ((last - first) / step) as usize + 1;
            if frames.len() + count > Self::MAX_FRAMES {
                return Err(format!("more than {} frames (render them in several runs)", Self::MAX_FRAMES));
            }
            frames.extend((first..=last).step_by(step as usize));
        }
        frames.sort_unstable();
        frames.dedup();
        Ok(Self(frames))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_as_renderers_and_farms_write_them() {
        let frames = |text: &str| text.parse::<FrameList>().map(|list| list.0);
        assert_eq!(frames("1-4").unwrap(), [1, 2, 3, 4]);
        assert_eq!(frames("1-10x4").unwrap(), [1, 5, 9]);
        assert_eq!(frames("1-3,5,7-10:2").unwrap(), [1, 2, 3, 5, 7, 9]);
        assert_eq!(frames(" 9, 2-3 ,3 ").unwrap(), [2, 3, 9]);
        assert_eq!(frames("4294967295").unwrap(), [u32::MAX]);
        for wrong in ["", "a", "1-", "-1", "5-1", "1-4x0", "1--4", "1-2-3", "0-4294967295", "1,,2", "1.5"] {
            assert!(frames(wrong).is_err(), "{wrong}");
        }
    }
}
