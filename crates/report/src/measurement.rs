//! One measurement: a contender renders a picture, timed and compared with the reference.

pub mod band;
pub mod contender;
pub mod machine;
pub mod measure;
pub mod memory;
pub mod record;
pub mod reference;
pub mod stopwatch;
#[cfg(windows)]
mod windows_system;
