//! How the C library's heap keeps what was freed. Heaps other than glibc's need nothing.

/// Heaps that threads share: by default glibc gives each thread one of its own.
const HEAPS: i32 = 4;

/// Blocks of at least this many bytes are returned to the system as soon as they are freed.
const MAPPED_BYTES: i32 = 1 << 20;

/// Lets all threads share a few heaps; to be called before there are threads.
pub fn share_heaps() {
    set(Parameter::Heaps, HEAPS);
}

/// Returns large blocks to the system as soon as they are freed. By default glibc raises the size from which it does so to that of the largest block that
/// was freed, up to 32 MiB. In the window, light fields and sums come and go by the hundred megabytes, and smaller pieces of what lives
/// between them would keep freed memory from the system. For one picture that costs more than it gives: new blocks are cleared page by page.
pub fn return_freed_blocks() {
    set(Parameter::MappedBytes, MAPPED_BYTES);
}

/// Returns the pages of all freed blocks to the system. It visits whole heaps: for a thread of its own, after large work.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
#[allow(unsafe_code, reason = "the standard library does not reach the heap")]
pub fn return_unused_pages() {
    // SAFETY: it takes a number and leaves every allocated block where it is.
    unsafe {
        libc::malloc_trim(0);
    }
}

/// The same elsewhere.
#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
pub fn return_unused_pages() {}

enum Parameter {
    Heaps,
    MappedBytes,
}

#[cfg(all(target_os = "linux", target_env = "gnu"))]
#[allow(unsafe_code, reason = "the standard library does not reach the heap's parameters")]
fn set(parameter: Parameter, value: i32) {
    let number = match parameter {
        Parameter::Heaps => libc::M_ARENA_MAX,
        Parameter::MappedBytes => libc::M_MMAP_THRESHOLD,
    };
    // SAFETY: it takes two numbers; an unknown one is refused, which leaves the heap as it was.
    unsafe {
        libc::mallopt(number, value);
    }
}

#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
fn set(_parameter: Parameter, _value: i32) {}
