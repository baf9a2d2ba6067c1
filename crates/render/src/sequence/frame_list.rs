//! Which frames: `1-100`, `1-100x2`, `1-3,5,7-10:2`.

use std::str::FromStr;

/// Frame numbers, ascending, no two alike.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrameList(Vec<u32>);

impl FrameList {
    /// So many are rendered at once at most: at 24 a second more than four hours.
    pub const MAX_FRAMES: usize = 400_000;

    /// One frame.
    pub fn single(frame: u32) -> Self {
        Self(vec![frame])
    }

    /// The numbers.
    pub fn numbers(&self) -> &[u32] {
        &self.0
    }
}

impl FromStr for FrameList {
    type Err = String;

    /// Frames and ranges, comma between them; `x` or `:` and a number behind a range takes every so manieth of it (`x` as renderers write
    /// it, `:` as Open Job Description does).
    fn from_str(text: &str) -> Result<Self, String> {
        let number = |text: &str| {
            let number = text.trim().parse::<u32>();
            number.map_err(|_| format!("{text:?} is no frame (as in 1-100, 1-100x2, 1-3,5,7-10:2)"))
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
                return Err(format!("{part:?}: a step of 0 goes nowhere"));
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
