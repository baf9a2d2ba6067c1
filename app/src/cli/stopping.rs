//! What a signal to end does (SIGTERM, as farms send it): the work stops where it next can, and what is finished stays.

use super::failure::{Failure, TRY_AGAIN};
use signal_hook::consts::SIGTERM;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::Duration;

static IS_ASKED_FOR: OnceLock<Arc<AtomicBool>> = OnceLock::new();

/// How often it is looked whether the signal came.
const EVERY: Duration = Duration::from_millis(100);

/// Work that has not stopped by itself after this is ended: farms kill what has not gone within some seconds. Files are replaced whole,
/// so that nothing is cut.
const PATIENCE: Duration = Duration::from_secs(3);

/// Heeds the signal from now on.
pub fn heed() -> Result<(), Failure> {
    let is_asked_for = IS_ASKED_FOR.get_or_init(Arc::default).clone();
    signal_hook::flag::register(SIGTERM, is_asked_for)
        .map_err(|error| Failure::try_again(format!("no signal can be heeded: {error} (try again)")))?;
    let watch = || {
        while !self::is_asked_for() {
            std::thread::sleep(EVERY);
        }
        std::thread::sleep(PATIENCE);
        eprintln!("error: {}", Failure::stopped().message);
        std::process::exit(TRY_AGAIN.into());
    };
    let thread = std::thread::Builder::new().name("signals".into()).spawn(watch);
    thread
        .map(|_| ())
        .map_err(|error| Failure::try_again(format!("no thread could be started: {error} (try again)")))
}

/// Whether the signal came.
pub fn is_asked_for() -> bool {
    IS_ASKED_FOR.get().is_some_and(|flag| flag.load(Ordering::Relaxed))
}
