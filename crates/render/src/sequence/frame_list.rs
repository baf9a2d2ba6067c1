//! Parsing lists of frames: `1-100`, `1-100x2`, `1-3,5,7-10:2`, `-5--1`.

use std::str::FromStr;

/// Frame numbers, ascending and unique.
///
/// ```
/// let frames: render::FrameList = "1-3,5,7-10:2".parse()?;
/// assert_eq!(frames.numbers(), [1, 2, 3, 5, 7, 9]);
/// let before: render::FrameList = "-2-1".parse()?;
/// assert_eq!(before.numbers(), [-2, -1, 0, 1]);
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrameList(Vec<i32>);

impl FrameList {
    /// Maximum number of frames: more than four hours at 24 frames per second.
    pub const MAX_FRAMES: usize = 400_000;

    /// A list of one frame.
    pub fn single(frame: i32) -> Self {
        Self(vec![frame])
    }

    /// The frame numbers, in the order in which they are rendered.
    pub fn numbers(&self) -> &[i32] {
        &self.0
    }
}

impl FromStr for FrameList {
    type Err = String;

    /// Parses comma-separated frames and ranges. A range may have a step after `x` (as renderers write it) or `:` (as in Open Job
    /// Description). Frames below 0 have a minus sign: `-10--5` are those from −10 to −5.
    fn from_str(text: &str) -> Result<Self, String> {
        let no_number = |text: &str| {
            format!("{text:?} is not a frame number (write 1-100, 1-100x2, 1-3,5,7-10:2 or -5--1)")
        };
        let number = |text: &str| text.trim().parse::<i32>().map_err(|_| no_number(text));
        let mut frames = Vec::new();
        for part in text.split(',') {
            let (range, step) = match part.split_once(['x', ':']) {
                Some((range, step)) => (range, step.trim().parse::<u32>().map_err(|_| no_number(step))?),
                None => (part, 1),
            };
            let (first, last) = match split_range(range) {
                Some((first, last)) => (number(first)?, number(last)?),
                None => (number(range)?, number(range)?),
            };
            if step == 0 {
                return Err(format!("{part:?}: the step must not be 0"));
            }
            if last < first {
                return Err(format!("{part:?} ends before it begins"));
            }
            let count = (last.abs_diff(first) / step) as usize + 1;
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

/// The two ends of a range, at the minus sign between them, which follows a digit.
fn split_range(range: &str) -> Option<(&str, &str)> {
    let after_digit = |at: &usize| range[..*at].trim_end().ends_with(|c: char| c.is_ascii_digit());
    let at = range.match_indices('-').map(|(at, _)| at).find(after_digit)?;
    Some((&range[..at], &range[at + 1..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_below_0() {
        let frames = |text: &str| text.parse::<FrameList>().map(|list| list.0);
        assert_eq!(frames("-2").unwrap(), [-2]);
        assert_eq!(frames("-3-4").unwrap(), [-3, -2, -1, 0, 1, 2, 3, 4]);
        assert_eq!(frames("-10--5:5").unwrap(), [-10, -5]);
        assert_eq!(frames("-10 - -5x2, 3,-1").unwrap(), [-10, -8, -6, -1, 3]);
        assert_eq!(frames("-2147483648").unwrap(), [i32::MIN]);
        for wrong in ["-1--4", "4--4", "-2147483648-2147483647"] {
            assert!(frames(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn ranges_as_renderers_and_farms_write_them() {
        let frames = |text: &str| text.parse::<FrameList>().map(|list| list.0);
        assert_eq!(frames("1-4").unwrap(), [1, 2, 3, 4]);
        assert_eq!(frames("1-10x4").unwrap(), [1, 5, 9]);
        assert_eq!(frames("1-3,5,7-10:2").unwrap(), [1, 2, 3, 5, 7, 9]);
        assert_eq!(frames(" 9, 2-3 ,3 ").unwrap(), [2, 3, 9]);
        assert_eq!(frames("2147483647").unwrap(), [i32::MAX]);
        for wrong in [
            "",
            "a",
            "1-",
            "5-1",
            "1-4x0",
            "1--4",
            "1-2-3",
            "0-2147483647",
            "2147483648",
            "1,,2",
            "1.5",
            "-",
            "--1",
            "1-4x-1",
            "- 1",
        ] {
            assert!(frames(wrong).is_err(), "{wrong}");
        }
    }
}
