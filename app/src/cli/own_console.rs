//! The console that Windows opens for a program of the console that was started from elsewhere.

/// Closes the console if it was opened for this program alone, as by a double click on it. (`focus-brush-window` opens none.)
#[cfg(windows)]
#[allow(unsafe_code, reason = "the standard library does not know about consoles")]
pub fn close() {
    use windows_sys::Win32::System::Console::{FreeConsole, GetConsoleProcessList};
    let mut processes = [0; 2];
    // SAFETY: at most as many numbers are written as there is room for; without a console both do nothing.
    unsafe {
        if GetConsoleProcessList(processes.as_mut_ptr(), processes.len() as u32) == 1 {
            FreeConsole();
        }
    }
}

/// Other systems open none.
#[cfg(not(windows))]
pub fn close() {}
