//! Being asked to end, as render farms do: by SIGTERM on Unix, by Ctrl+Break, closing of the console or the end of the session on Windows.
//! The work stops at the next opportunity, and finished files are kept. (Ctrl+C ends the program at once, on all systems.)

#[cfg(windows)]
mod console_control;

use super::failure::{Failure, TRY_AGAIN};
use super::stderr::write_line;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::Duration;

static REQUESTED: OnceLock<Arc<AtomicBool>> = OnceLock::new();

/// How often the flag is polled.
const POLL_INTERVAL: Duration = Duration::from_millis(100);

/// The process exits if the work has not stopped by then: farms kill processes that take longer. Output files
/// are replaced atomically, so none is left incomplete.
const GRACE_PERIOD: Duration = Duration::from_secs(3);

/// Installs the signal handler.
///
/// # Errors
/// The system refuses the handler.
pub fn install_handler() -> Result<(), Failure> {
    listen(REQUESTED.get_or_init(Arc::default)).map_err(|error| {
        Failure::try_again(format!("the signal handler cannot be installed: {error} (try again)"))
    })?;
    let watch = || {
        while !self::is_requested() {
            std::thread::sleep(POLL_INTERVAL);
        }
        std::thread::sleep(GRACE_PERIOD);
        write_line(&format!("error: {}", Failure::terminated().message));
        std::process::exit(TRY_AGAIN.into());
    };
    let thread = std::thread::Builder::new().name("signals".into()).spawn(watch);
    thread
        .map(|_| ())
        .map_err(|error| Failure::try_again(format!("no thread could be started: {error} (try again)")))
}

/// Sets the flag when SIGTERM is received.
#[cfg(unix)]
fn listen(flag: &Arc<AtomicBool>) -> std::io::Result<()> {
    signal_hook::flag::register(signal_hook::consts::SIGTERM, flag.clone()).map(|_| ())
}

/// Sets the flag when the console asks the program to end.
#[cfg(windows)]
fn listen(_: &Arc<AtomicBool>) -> std::io::Result<()> {
    console_control::install(request)
}

/// What the handler of the console's events does.
#[cfg(windows)]
fn request() {
    if let Some(flag) = REQUESTED.get() {
        flag.store(true, Ordering::Relaxed);
    }
}

/// Whether the program was asked to end.
pub fn is_requested() -> bool {
    REQUESTED.get().is_some_and(|flag| flag.load(Ordering::Relaxed))
}
