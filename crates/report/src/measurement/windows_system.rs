//! What Windows says about the machine and this process, where Linux has files in /proc.

use windows_sys::Win32::Foundation::{ERROR_SUCCESS, FALSE};
use windows_sys::Win32::System::ProcessStatus::{K32GetProcessMemoryInfo, PROCESS_MEMORY_COUNTERS};
use windows_sys::Win32::System::Registry::{HKEY_LOCAL_MACHINE, RRF_RT_REG_SZ, RegGetValueW};
use windows_sys::Win32::System::SystemInformation::{GlobalMemoryStatusEx, MEMORYSTATUSEX};
use windows_sys::Win32::System::Threading::GetCurrentProcess;
use windows_sys::core::w;

/// The working set of this process, in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WorkingSet {
    /// Now.
    pub current: u64,
    /// The largest since the process started.
    pub peak: u64,
}

/// The working set of this process; `None` if the system does not tell.
#[allow(unsafe_code, reason = "the standard library does not know about memory")]
pub fn working_set() -> Option<WorkingSet> {
    const SIZE: u32 = size_of::<PROCESS_MEMORY_COUNTERS>() as u32;
    let mut counters = PROCESS_MEMORY_COUNTERS { cb: SIZE, ..Default::default() };
    // SAFETY: the handle is always valid, and the structure has the size that is given.
    let succeeded = unsafe { K32GetProcessMemoryInfo(GetCurrentProcess(), &mut counters, SIZE) };
    (succeeded != FALSE).then_some(WorkingSet {
        current: counters.WorkingSetSize as u64,
        peak: counters.PeakWorkingSetSize as u64,
    })
}

/// The memory of the machine, in bytes; `None` if the system does not tell.
#[allow(unsafe_code, reason = "the standard library does not know about memory")]
pub fn total_memory_bytes() -> Option<u64> {
    let mut status = MEMORYSTATUSEX { dwLength: size_of::<MEMORYSTATUSEX>() as u32, ..Default::default() };
    // SAFETY: the structure's length is in its first field.
    let succeeded = unsafe { GlobalMemoryStatusEx(&mut status) };
    (succeeded != FALSE).then_some(status.ullTotalPhys)
}

/// The name of the processor; `None` if the registry does not have it.
#[allow(unsafe_code, reason = "the standard library does not know about the registry")]
pub fn processor_name() -> Option<String> {
    let mut text = [0u16; 256];
    let mut bytes = size_of_val(&text) as u32;
    // SAFETY: both names are literals that end in NUL; no more bytes are written than `bytes` says there is room for.
    let result = unsafe {
        RegGetValueW(
            HKEY_LOCAL_MACHINE,
            w!("HARDWARE\\DESCRIPTION\\System\\CentralProcessor\\0"),
            w!("ProcessorNameString"),
            RRF_RT_REG_SZ,
            std::ptr::null_mut(),
            text.as_mut_ptr().cast(),
            &mut bytes,
        )
    };
    if result != ERROR_SUCCESS {
        return None;
    }
    let text = text.split(|&unit| unit == 0).next().unwrap_or_default();
    let name = String::from_utf16_lossy(text).split_whitespace().collect::<Vec<_>>().join(" ");
    (!name.is_empty()).then_some(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_is_counted() {
        let held = vec![1u8; 32 << 20];
        assert_eq!(std::hint::black_box(&held)[1 << 20], 1);
        let WorkingSet { current, peak } = working_set().unwrap();
        assert!(current >= 32 << 20 && peak >= 32 << 20, "{current} {peak}");
        assert!(total_memory_bytes().unwrap() > current);
    }
}
