//! What work on a scene may use beside the processor.

use crate::disk_cache::DiskCache;
use jobs::Background;

/// What work on a scene may use: a place for results that outlive the program, and threads.
#[derive(Clone, Debug, Default)]
pub struct Resources {
    /// Where results are kept from one run of the program to the next.
    pub cache: DiskCache,
    /// Where work runs that goes on beside its caller.
    pub background: Background,
}

impl Resources {
    /// Results in `cache`, and threads.
    pub fn with_cache(cache: DiskCache) -> Self {
        Self { cache, ..Self::default() }
    }
}
