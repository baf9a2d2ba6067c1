//! What a reader may do: return, with an error of one line if it refuses.

use std::fmt::Display;
use std::path::Path;

/// Ends the process at a panic in code of this repository, even if it is caught further up: readers catch panics of decoders that
/// others wrote, which are no fault then. Panics that nobody catches end the process anyway.
pub fn report_own_panics() {
    let report = std::panic::take_hook();
    drop(report);
    std::panic::set_hook(Box::new(|panic| {
        let place = panic.location().map_or("", |location| location.file());
        let is_own = Path::new(place).components().any(|part| part.as_os_str() == "crates")
            && !place.contains("registry");
        eprintln!("{panic}");
        if is_own {
            std::process::abort();
        }
    }));
}

/// Passes on what was read.
///
/// # Panics
/// The error's message is empty or has several lines.
pub fn read_or_refused<T, E: Display>(result: Result<T, E>) -> Option<T> {
    match result {
        Ok(value) => Some(value),
        Err(error) => {
            let message = error.to_string();
            assert!(!message.trim().is_empty(), "an error without a message");
            assert!(!message.contains('\n'), "an error of several lines: {message:?}");
            None
        }
    }
}
