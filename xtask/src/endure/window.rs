//! Promises about the real window: it runs on a display of its own, and is acted on by mouse and keys.

pub mod artist;
pub mod crash;
mod display;
mod frames;
mod open_window;

/// Whether the programs are there that a display of our own needs; `Err` says which is not.
fn check_programs() -> Result<(), String> {
    let missing =
        ["Xvfb", "xdotool"].into_iter().find(|program| !super::harness::program::is_installed(program));
    missing.map_or(Ok(()), |program| Err(format!("{program} is not installed (packages xvfb, xdotool)")))
}
