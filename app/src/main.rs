//! `focus-brush`: the window and the command line.

mod headless;

use std::process::ExitCode;

fn main() -> ExitCode {
    // Unwrapping runs its engines in child processes of this program.
    atlas::child::run_if_child();
    headless::restart_if_headless();
    focus_brush::cli::run()
}
