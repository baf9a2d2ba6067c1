//! How the C library's heap keeps what was freed.
//!
//! By default glibc raises the size from which blocks are mapped on their own to that of the largest block that was freed, up to 32 MiB, and
//! gives each thread a heap of its own. Light fields and sums come and go by the hundred megabytes: smaller pieces of what lives between them
//! would keep freed memory from the system.

/// Blocks of at least this many bytes are returned to the system as soon as they are freed.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const MAPPED_BYTES: libc::c_int = 1 << 20;

/// Heaps that threads share.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const HEAPS: libc::c_int = 4;

/// Sets the heap up; to be called before there are threads.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
#[allow(unsafe_code, reason = "the standard library does not reach the heap's parameters")]
pub fn configure() {
    // SAFETY: it takes two numbers; an unknown one is refused, which leaves the heap as it was.
    unsafe {
        libc::mallopt(libc::M_MMAP_THRESHOLD, MAPPED_BYTES);
        libc::mallopt(libc::M_ARENA_MAX, HEAPS);
    }
}

/// Other heaps need nothing.
#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
pub fn configure() {}
