//! Peak memory of a piece of work, as reported by the system.

#[cfg(windows)]
use super::windows_system::{WorkingSet, working_set};

/// The resident memory of the process at the start of the work.
pub struct PeakMemory {
    #[cfg(not(windows))]
    before: Option<u64>,
    #[cfg(windows)]
    before: Option<WorkingSet>,
}

#[cfg(not(windows))]
impl PeakMemory {
    /// Starts measuring. On systems other than Linux and Windows nothing is measured.
    pub fn watch() -> Self {
        // Writing 5 resets the peak resident memory to the current value (proc(5)).
        let is_set_back = std::fs::write("/proc/self/clear_refs", "5").is_ok();
        Self { before: if is_set_back { status_bytes("VmRSS:") } else { None } }
    }

    /// The largest increase of resident memory since the start, in bytes; `None` where it cannot be read.
    pub fn peak_increase_bytes(&self) -> Option<u64> {
        Some(status_bytes("VmHWM:")?.saturating_sub(self.before?))
    }
}

/// The resident memory of the process, in bytes; `None` where it cannot be read.
#[cfg(not(windows))]
pub fn resident_bytes() -> Option<u64> {
    status_bytes("VmRSS:")
}

/// Windows cannot reset the peak.
#[cfg(windows)]
impl PeakMemory {
    /// Starts measuring.
    pub fn watch() -> Self {
        Self { before: working_set() }
    }

    /// The largest increase of resident memory since the start, in bytes; `None` where earlier work of the process had a higher peak, so
    /// that this one's is not known.
    pub fn peak_increase_bytes(&self) -> Option<u64> {
        let (before, after) = (self.before?, working_set()?);
        (after.peak > before.peak).then(|| after.peak - before.current)
    }
}

/// The resident memory of the process (its working set), in bytes; `None` where it cannot be read.
#[cfg(windows)]
pub fn resident_bytes() -> Option<u64> {
    Some(working_set()?.current)
}

/// A value of /proc/self/status, bytes.
#[cfg(not(windows))]
fn status_bytes(name: &str) -> Option<u64> {
    parse_kilobytes(&std::fs::read_to_string("/proc/self/status").ok()?, name)
}

/// The value of a line `NAME   12345 kB` of `text`, in bytes; `None` if there is no such line.
#[cfg(any(test, not(windows)))]
pub fn parse_kilobytes(text: &str, name: &str) -> Option<u64> {
    let value = text.lines().find_map(|line| line.strip_prefix(name))?;
    Some(value.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? * 1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_read() {
        let text = "Name:\tx\nVmHWM:\t   12 kB\nVmRSS:\t 7 kB\n";
        assert_eq!(parse_kilobytes(text, "VmHWM:"), Some(12 * 1024));
        assert_eq!(parse_kilobytes(text, "VmSwap:"), None);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn temporary_allocations_count() {
        let watch = PeakMemory::watch();
        let held = vec![1u8; 64 << 20];
        assert_eq!(std::hint::black_box(&held)[1 << 20], 1);
        drop(held);
        if let Some(taken) = watch.peak_increase_bytes() {
            // Other tests of this process may hold and free memory meanwhile.
            assert!(taken > 32 << 20, "{taken}");
        }
    }
}
