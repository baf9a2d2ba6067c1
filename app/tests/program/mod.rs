//! Runs the program in a folder with a cache of its own.

use std::path::Path;
use std::process::{Command, Output};

/// Runs the program with space-separated arguments.
pub fn run(folder: &Path, arguments: &str) -> Output {
    let program = Command::new(env!("CARGO_BIN_EXE_focus-brush"))
        .args(arguments.split_whitespace())
        .current_dir(folder)
        .env("XDG_CACHE_HOME", folder.join("cache"))
        .env_remove("XDG_RUNTIME_DIR")
        .output();
    program.unwrap()
}

/// The same, which must succeed. Returns its stdout.
pub fn done(folder: &Path, arguments: &str) -> String {
    let output = run(folder, arguments);
    assert!(output.status.success(), "{arguments}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}
