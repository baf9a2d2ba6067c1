//! Whether light was cut off where it did not die away.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Maximum number of scattering events of a path, and of bounces between patches, where the world sets no limit. Light
/// that cannot get out of a closed room of albedo 0.99 has fallen to 0.003 % by then; with an albedo of 1 it has no
/// finite sum.
pub const MAX_BOUNCES: u32 = 1024;

/// Remembers whether light was cut off at [`MAX_BOUNCES`]; its clones share the memory.
#[derive(Clone, Debug, Default)]
pub struct BounceLimit(Arc<AtomicBool>);

impl BounceLimit {
    /// Records that light was cut off.
    pub fn reach(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether light was cut off.
    pub fn is_reached(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
