//! What reading a file gives, and its limits.

use super::format::SplatFormat;
use crate::cloud::GaussianCloud;

/// Limits of reading.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReadOptions {
    /// Maximum bytes held at once: the cloud, and what is read and inflated on the way to it.
    pub max_memory: u64,
}

impl Default for ReadOptions {
    /// 2 GiB: 6 million splats of degree 3, with what reading them takes.
    fn default() -> Self {
        Self { max_memory: 2 << 30 }
    }
}

/// A file that was read.
#[derive(Clone, Debug)]
pub struct SplatFile {
    /// Its splats.
    pub cloud: GaussianCloud,
    /// Its format.
    pub format: SplatFormat,
    /// What was irregular, sentences of one line: `FILE: what (what to do)`.
    pub warnings: Vec<String>,
}
