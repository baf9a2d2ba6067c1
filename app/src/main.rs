//! `focus-brush`: the window and the command line.

mod bare_session;

use std::process::ExitCode;

fn main() -> ExitCode {
    // Unwrapping runs its engines in children of this very program.
    atlas::child::run_if_child();
    bare_session::restart_if_headless();
    focus_brush::cli::run()
}
