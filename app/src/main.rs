//! `focus-brush`: the window and the command line.

use std::process::ExitCode;

fn main() -> ExitCode {
    // Unwrapping runs its engines in children of this very program.
    atlas::child::run_if_asked();
    focus_brush::cli::run()
}
