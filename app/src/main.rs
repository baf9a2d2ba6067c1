//! `focus-brush`: the window and the command line.

mod headless;
mod out_of_memory;

use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: out_of_memory::EndingAllocator = out_of_memory::EndingAllocator;

fn main() -> ExitCode {
    focus_brush::heap::share_heaps();
    // Unwrapping runs its engines in child processes of this program.
    atlas::child::run_if_child();
    headless::restart_if_headless();
    focus_brush::cli::run()
}
