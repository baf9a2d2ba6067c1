//! Writes how long frames take and how many jobs are at work, to watch a window over hours.
//!
//! A line for every second in which a frame was drawn, and for every change of the jobs at work: seconds since the
//! start, frames since the last line, the longest of them in ms, jobs at its end (other than the light's refinement).
//! Nothing is written while nothing is drawn.

use std::fs::File;
use std::io::Write;
use std::path::Path;
use std::time::{Duration, Instant};

/// Time between two lines.
const INTERVAL: Duration = Duration::from_secs(1);

/// An open log.
pub struct FrameLog {
    file: File,
    opened: Instant,
    line_since: Instant,
    frames: u32,
    longest_ms: f32,
    /// At the last line.
    jobs: usize,
}

impl FrameLog {
    /// Creates the file.
    ///
    /// # Errors
    /// It cannot be created.
    pub fn create(file: &Path) -> std::io::Result<Self> {
        let now = Instant::now();
        Ok(Self {
            file: File::create(file)?,
            opened: now,
            line_since: now,
            frames: 0,
            longest_ms: 0.0,
            jobs: 0,
        })
    }

    /// Counts a frame that took this long, if known, with this many jobs at work after it.
    ///
    /// # Errors
    /// A line cannot be written.
    pub fn count(&mut self, seconds: Option<f32>, jobs: usize) -> std::io::Result<()> {
        self.frames += 1;
        self.longest_ms = self.longest_ms.max(seconds.unwrap_or(0.0) * 1e3);
        let now = Instant::now();
        if now - self.line_since < INTERVAL && jobs == self.jobs {
            return Ok(());
        }
        let Self { opened, frames, longest_ms, .. } = *self;
        writeln!(self.file, "{:.1} {frames} {longest_ms:.1} {jobs}", (now - opened).as_secs_f64())?;
        (self.line_since, self.frames, self.longest_ms, self.jobs) = (now, 0, 0.0, jobs);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_has_the_longest_frame_of_its_second_or_until_a_job_ends() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("frames");
        let mut log = FrameLog::create(&file).unwrap();
        log.count(Some(0.25), 0).unwrap();
        assert_eq!(std::fs::read_to_string(&file).unwrap(), "");
        log.line_since -= INTERVAL;
        log.count(Some(0.125), 0).unwrap();
        let text = std::fs::read_to_string(&file).unwrap();
        assert_eq!(text.split_whitespace().skip(1).collect::<Vec<_>>(), ["2", "250.0", "0"]);
        log.count(Some(0.5), 3).unwrap();
        log.count(Some(0.5), 3).unwrap();
        let text = std::fs::read_to_string(&file).unwrap();
        assert_eq!(
            text.lines().nth(1).unwrap().split_whitespace().skip(1).collect::<Vec<_>>(),
            ["1", "500.0", "3"]
        );
        assert_eq!(text.lines().count(), 2);
    }
}
