//! What every reader needs: names for messages, limits, progress, warnings.

use super::format::SplatFormat;
use super::splat_file::{ReadOptions, SplatFile};
use crate::cloud::{CloudBuilder, CloudTraits, GaussianCloud};
use crate::error::GaussianError;
use progress::{Cancelled, Progress};
use std::path::Path;

/// One file that is being read.
pub(super) struct Reading<'a> {
    file: &'a Path,
    options: &'a ReadOptions,
    progress: &'a dyn Progress,
    warnings: Vec<String>,
}

impl<'a> Reading<'a> {
    pub fn new(file: &'a Path, options: &'a ReadOptions, progress: &'a dyn Progress) -> Self {
        Self { file, options, progress, warnings: Vec::new() }
    }

    pub fn file(&self) -> &'a Path {
        self.file
    }

    pub fn malformed(&self, place: impl ToString, what: impl ToString) -> GaussianError {
        GaussianError::malformed(self.file, place, what)
    }

    /// Adds a warning: `what` is wrong, and `cure` says what to do.
    pub fn warn(&mut self, what: &str, cure: &str) {
        self.warnings.push(format!("{}: {what} ({cure})", self.file.display()));
    }

    /// Checks `bytes` against the limit of memory; `what` is the beginning of a sentence about them.
    ///
    /// # Errors
    /// They are more.
    pub fn check_memory(&self, what: &str, bytes: u64) -> Result<(), GaussianError> {
        let limit = self.options.max_memory;
        if bytes <= limit {
            return Ok(());
        }
        let what = format!("{what} {} MiB, the limit is {} MiB", bytes >> 20, limit >> 20);
        Err(GaussianError::TooBig { file: self.file.into(), what })
    }

    /// A builder for `count` splats, which the bytes of the file justify; `beside` bytes are held while it is filled.
    ///
    /// # Errors
    /// There are none, too many for 32 bits, or too many for the limit of memory.
    pub fn builder(&self, degree: u32, count: u64, beside: u64) -> Result<CloudBuilder, GaussianError> {
        if count == 0 {
            return Err(GaussianError::no_splats(self.file, "has no splats"));
        }
        let bytes = GaussianCloud::bytes_of(degree, count).saturating_add(beside);
        self.check_memory(&format!("{count} splats take"), bytes)?;
        if count >= u64::from(u32::MAX) {
            return Err(self.malformed("count", format!("{count} splats are more than 32 bits can number")));
        }
        Ok(CloudBuilder::new(degree, count as usize))
    }

    /// Reports that row `row` of `count` is reached.
    ///
    /// # Errors
    /// The work is cancelled.
    #[inline]
    pub fn at_row(&self, row: u64, count: u64) -> Result<(), Cancelled> {
        const EVERY: u64 = 1 << 16;
        if row.is_multiple_of(EVERY) {
            self.progress.check()?;
            self.progress.report(row as f32 / count as f32);
        }
        Ok(())
    }

    /// The file, with the cloud of `builder`.
    ///
    /// # Errors
    /// All splats are left out.
    pub fn finish(
        mut self,
        builder: CloudBuilder,
        traits: CloudTraits,
        format: SplatFormat,
    ) -> Result<SplatFile, GaussianError> {
        let cloud = builder.finish(traits);
        if let Some(description) = cloud.left_out().description() {
            if cloud.is_empty() {
                return Err(GaussianError::no_splats(
                    self.file,
                    format!("no splat can be drawn: {description}"),
                ));
            }
            self.warn(&description, "they would not be visible or cannot be drawn; all others are");
        }
        Ok(SplatFile { cloud, format, warnings: self.warnings })
    }
}
