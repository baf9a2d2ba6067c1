//! Handling of SIGTERM, as sent by render farms: the work stops at the next opportunity, and finished files
//! are kept.

use super::failure::{Failure, TRY_AGAIN};
use super::stderr::write_line;
use signal_hook::consts::SIGTERM;
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
    let flag = REQUESTED.get_or_init(Arc::default).clone();
    signal_hook::flag::register(SIGTERM, flag).map_err(|error| {
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

/// Whether the signal was received.
pub fn is_requested() -> bool {
    REQUESTED.get().is_some_and(|flag| flag.load(Ordering::Relaxed))
}
