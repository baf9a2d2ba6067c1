//! What work on a scene may use: a disk cache and threads.

use crate::disk_cache::DiskCache;
use jobs::Background;

/// What work on a scene may use: a disk cache and threads.
#[derive(Clone, Debug, Default)]
pub struct Resources {
    /// Where results are stored between runs of the program.
    pub cache: DiskCache,
    /// Where background work runs.
    pub background: Background,
}

impl Resources {
    /// Uses `cache`, and threads for background work.
    pub fn with_cache(cache: DiskCache) -> Self {
        Self { cache, ..Self::default() }
    }
}
