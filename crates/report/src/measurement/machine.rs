//! The machine of the measurements.

#[cfg(not(windows))]
use super::memory::parse_kilobytes;
use serde::Serialize;
use std::time::SystemTime;

/// Description of the machine, the program and the date.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Machine {
    /// Name of the processor, if available; otherwise the architecture.
    pub processor: String,
    /// Number of hardware threads.
    pub cores: usize,
    /// Number of threads used by the program.
    pub threads: usize,
    /// Memory in bytes, if available.
    pub memory_bytes: Option<u64>,
    /// Operating system and architecture.
    pub system: String,
    /// Version of the program.
    pub version: String,
    /// When the report was written, UTC.
    pub date: String,
}

impl Machine {
    /// The current machine and time.
    pub fn current() -> Self {
        let (processor, memory_bytes) = processor_and_memory();
        Self {
            processor: processor.unwrap_or_else(|| std::env::consts::ARCH.into()),
            cores: std::thread::available_parallelism().map_or(1, |cores| cores.get()),
            threads: rayon::current_num_threads(),
            memory_bytes,
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            version: format!(
                "{}{}",
                env!("CARGO_PKG_VERSION"),
                if cfg!(debug_assertions) { ", with debug assertions" } else { "" }
            ),
            date: humantime::format_rfc3339_seconds(SystemTime::now()).to_string(),
        }
    }
}

/// The name of the processor, and the memory in bytes.
#[cfg(not(windows))]
fn processor_and_memory() -> (Option<String>, Option<u64>) {
    let cpuinfo = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let meminfo = std::fs::read_to_string("/proc/meminfo").unwrap_or_default();
    (processor_name(&cpuinfo), parse_kilobytes(&meminfo, "MemTotal:"))
}

/// The same on Windows.
#[cfg(windows)]
fn processor_and_memory() -> (Option<String>, Option<u64>) {
    use super::windows_system::{processor_name, total_memory_bytes};
    (processor_name(), total_memory_bytes())
}

/// The model name in the text of /proc/cpuinfo.
#[cfg(any(test, not(windows)))]
fn processor_name(cpuinfo: &str) -> Option<String> {
    let line = cpuinfo.lines().find(|line| line.starts_with("model name"))?;
    let name = line.split_once(':')?.1.split_whitespace().collect::<Vec<_>>().join(" ");
    (!name.is_empty()).then_some(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_processor_is_named() {
        assert_eq!(
            processor_name("processor: 0\nmodel name\t: A  CPU @ 2 GHz\n").as_deref(),
            Some("A CPU @ 2 GHz")
        );
        assert_eq!(processor_name("BogoMIPS: 48\n"), None);
        let here = Machine::current();
        assert!(here.cores >= 1 && here.threads >= 1 && here.date.ends_with('Z'), "{here:?}");
    }
}
