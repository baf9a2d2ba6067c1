//! What a signal to end does (SIGTERM, as farms send it): the work stops where it next can, and what is finished stays.

use super::failure::{Failure, TRY_AGAIN};
use signal_hook::consts::SIGTERM;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::Duration;

static REQUESTED: OnceLock<Arc<AtomicBool>> = OnceLock::new();

/// How often it is looked whether the signal came.
const POLL_INTERVAL: Duration = Duration::from_millis(100);

/// Work that has not stopped by itself after this is ended: farms kill what has not gone within some seconds. Files are replaced whole,
/// so that nothing is cut.
const GRACE_PERIOD: Duration = Duration::from_secs(3);

/// Heeds the signal from now on.
pub fn install_handler() -> Result<(), Failure> {
    let flag = REQUESTED.get_or_init(Arc::default).clone();
    signal_hook::flag::register(SIGTERM, flag)
        .map_err(|error| Failure::try_again(format!("no signal can be heeded: {error} (try again)")))?;
    let watch = || {
        while !self::is_requested() {
            std::thread::sleep(POLL_INTERVAL);
        }
        std::thread::sleep(GRACE_PERIOD);
        eprintln!("error: {}", Failure::terminated().message);
        std::process::exit(TRY_AGAIN.into());
    };
    let thread = std::thread::Builder::new().name("signals".into()).spawn(watch);
    thread
        .map(|_| ())
        .map_err(|error| Failure::try_again(format!("no thread could be started: {error} (try again)")))
}

/// Whether the signal came.
pub fn is_requested() -> bool {
    REQUESTED.get().is_some_and(|flag| flag.load(Ordering::Relaxed))
}
