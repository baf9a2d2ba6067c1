//! Events of a Windows console that ask a program to end.

use std::io::{Error, Result};
use std::sync::OnceLock;
use std::time::Duration;
use windows_sys::Win32::Foundation::{FALSE, TRUE};
use windows_sys::Win32::System::Console::{CTRL_BREAK_EVENT, CTRL_C_EVENT, SetConsoleCtrlHandler};
use windows_sys::core::BOOL;

/// What is called when the console asks the program to end.
static ON_REQUEST: OnceLock<fn()> = OnceLock::new();

/// Calls `on_request`, on a thread of the system's, for Ctrl+Break, when the console is closed, and when the user logs off or shuts the
/// machine down. Ctrl+C keeps its meaning. Only the first `on_request` counts.
///
/// # Errors
/// The system refuses the handler.
#[allow(unsafe_code, reason = "the standard library does not know the console's events")]
pub fn install(on_request: fn()) -> Result<()> {
    ON_REQUEST.get_or_init(|| on_request);
    // SAFETY: `handle` may be called on any thread at any time: it reads a static that is set already.
    match unsafe { SetConsoleCtrlHandler(Some(handle), TRUE) } {
        FALSE => Err(Error::last_os_error()),
        _ => Ok(()),
    }
}

/// The handler: whether the event was dealt with.
extern "system" fn handle(event: u32) -> BOOL {
    if event == CTRL_C_EVENT {
        return FALSE;
    }
    if let Some(on_request) = ON_REQUEST.get() {
        on_request();
    }
    // Unless it was Ctrl+Break, the system ends the program when its handlers have returned, at the latest after five seconds; until
    // then the work may end by itself.
    if event != CTRL_BREAK_EVENT {
        std::thread::sleep(Duration::from_secs(5));
    }
    TRUE
}
