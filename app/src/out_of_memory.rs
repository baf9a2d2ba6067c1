//! Running out of memory: one line and the exit code of temporary problems, where Rust's own handler aborts.
//!
//! The standard library's hook for failed allocations (`alloc::set_alloc_error_hook`) is unstable, so that the allocator itself ends the
//! program. It cannot unwind from there. What is being written has no name yet or is removed by the next program that writes it
//! (`atomic_file`), and the window's recovery file holds what was not saved.

use std::alloc::{GlobalAlloc, Layout, System};
use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// The system's allocator; where it has no memory left, the program ends.
pub struct EndingAllocator;

// SAFETY: everything is passed on to the system's allocator, whose pointers are returned unless they are null.
#[allow(unsafe_code, reason = "an allocator is an unsafe trait; it only calls the system's")]
unsafe impl GlobalAlloc for EndingAllocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's promises are the same.
        or_end(unsafe { System.alloc(layout) }, layout.size())
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's promises are the same.
        or_end(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, new_size: usize) -> *mut u8 {
        // SAFETY: the caller's promises are the same.
        or_end(unsafe { System.realloc(pointer, layout, new_size) }, new_size)
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's promises are the same.
        unsafe { System.dealloc(pointer, layout) }
    }
}

/// The pointer, unless it is null.
fn or_end(pointer: *mut u8, bytes: usize) -> *mut u8 {
    if pointer.is_null() {
        end_without_memory(bytes);
    }
    pointer
}

/// Ends the program with one line. Nothing in here allocates.
#[cold]
fn end_without_memory(bytes: usize) -> ! {
    // Several threads may run out at once; the first one speaks for all.
    static IS_ENDING: AtomicBool = AtomicBool::new(false);
    while IS_ENDING.swap(true, Ordering::Relaxed) {
        std::thread::sleep(Duration::from_secs(1));
    }
    let mut line = [0; 128];
    let mut rest = &mut line[..];
    let mebibytes = bytes.div_ceil(1 << 20);
    // The buffer holds any number.
    let _ = writeln!(
        rest,
        "error: out of memory: {mebibytes} MiB more were needed (close other programs, or ask for less)"
    );
    let unused = rest.len();
    end(&line[..line.len() - unused])
}

/// Ends the program at once with `line`, without the handlers that run at the end of a program: some allocate.
#[cfg(unix)]
#[allow(unsafe_code, reason = "the standard library has no `_exit`")]
fn end(line: &[u8]) -> ! {
    let stderr = std::io::stderr();
    let _ = stderr.lock().write_all(line);
    // SAFETY: it takes a number and does not return.
    unsafe { libc::_exit(focus_brush::cli::TRY_AGAIN.into()) }
}

/// The same on Windows.
#[cfg(windows)]
#[allow(unsafe_code, reason = "the standard library cannot end a program without its handlers")]
fn end(line: &[u8]) -> ! {
    use windows_sys::Win32::System::Threading::{GetCurrentProcess, TerminateProcess};
    let _ = std::io::stderr().lock().write_all(line);
    // SAFETY: they take a handle that is always valid, and a number.
    unsafe {
        TerminateProcess(GetCurrentProcess(), focus_brush::cli::TRY_AGAIN.into());
    }
    std::process::abort()
}

/// The same elsewhere.
#[cfg(not(any(unix, windows)))]
fn end(line: &[u8]) -> ! {
    let _ = std::io::stderr().lock().write_all(line);
    std::process::exit(focus_brush::cli::TRY_AGAIN.into())
}
