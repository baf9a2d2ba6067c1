//! Shared by all chores: the repository's location, running commands, failures.

use std::path::{Path, PathBuf};
use std::process::Command;

/// A chore's failure: a message for the user and the exit code.
#[derive(Debug)]
pub struct Failure {
    message: String,
    exit_code: u8,
}

impl Failure {
    /// A failure with exit code 1.
    pub fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), exit_code: 1 }
    }

    /// The exit code of the process.
    pub fn exit_code(&self) -> u8 {
        self.exit_code
    }
}

impl std::fmt::Display for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.message)
    }
}

/// The root of the repository.
pub fn repository() -> PathBuf {
    let own = std::env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from);
    let own = own.unwrap_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")));
    own.parent().map(Path::to_path_buf).unwrap_or(own)
}

/// The cargo that runs this chore, set up for this repository.
pub fn cargo(subcommand: &str) -> Command {
    cargo_in(&repository(), subcommand)
}

/// The same for the package or workspace in a folder.
pub fn cargo_in(folder: &Path, subcommand: &str) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.arg(subcommand).arg("--manifest-path").arg(folder.join("Cargo.toml"));
    command
}

/// Runs a command to completion with inherited output.
///
/// # Errors
/// The command does not start, or ends with a code other than 0, which becomes the chore's exit code.
pub fn execute(command: &mut Command) -> Result<(), Failure> {
    let shown = shown(command);
    let status = command.status().map_err(|e| Failure::new(format!("{shown}: does not start: {e}")))?;
    if status.success() {
        return Ok(());
    }
    let exit_code = status.code().and_then(|code| u8::try_from(code).ok()).unwrap_or(1);
    Err(Failure { message: format!("{shown}: failed ({status})"), exit_code })
}

/// Runs a command and returns what it printed.
///
/// # Errors
/// The command does not start or ends with a code other than 0; the message contains its output.
pub fn output_of(command: &mut Command) -> Result<Vec<u8>, Failure> {
    let shown = shown(command);
    let output = command.output().map_err(|e| Failure::new(format!("{shown}: does not start: {e}")))?;
    if output.status.success() {
        return Ok(output.stdout);
    }
    let stderr = String::from_utf8_lossy(&output.stderr);
    Err(Failure::new(format!("{shown}: failed ({})\n{}", output.status, stderr.trim_end())))
}

/// A command as typed in a shell.
pub fn shown(command: &Command) -> String {
    let program = Path::new(command.get_program()).file_name().unwrap_or(command.get_program());
    let words = std::iter::once(program).chain(command.get_args());
    words.map(|word| word.to_string_lossy().into_owned()).collect::<Vec<_>>().join(" ")
}

/// Copies a file, or a folder with its contents.
///
/// # Errors
/// A file cannot be read or written.
pub fn copy(from: &Path, to: &Path) -> Result<(), Failure> {
    if from.is_dir() {
        let entries = std::fs::read_dir(from).map_err(|error| file_failure(from, &error))?;
        for entry in entries {
            let entry = entry.map_err(|error| file_failure(from, &error))?;
            copy(&entry.path(), &to.join(entry.file_name()))?;
        }
        return Ok(());
    }
    let folder = to.parent().unwrap_or(to);
    std::fs::create_dir_all(folder).map_err(|error| file_failure(folder, &error))?;
    std::fs::copy(from, to).map_err(|error| file_failure(from, &error))?;
    Ok(())
}

/// What went wrong with a file.
pub fn file_failure(file: &Path, error: &std::io::Error) -> Failure {
    Failure::new(format!("{}: {error}", file.display()))
}
