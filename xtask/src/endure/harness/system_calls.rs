//! Runs of the program under `strace`: what it opens and writes, and calls that are made to fail.

use super::program::{Invocation, Run};
use std::ffi::OsString;
use std::path::Path;
use std::process::{Command, Stdio};

/// A call, as strace wrote it.
pub struct Call {
    /// `openat`, `write` and so on.
    pub name: String,
    /// The arguments, descriptors with their paths.
    pub arguments: String,
    /// The result.
    pub result: String,
    /// The number of the call among those of its name in its thread, from 1.
    pub nth: usize,
    /// Whether it was made to fail from here.
    pub injected: bool,
}

/// Whether strace may trace here.
///
/// # Errors
/// It is missing, or the system forbids it.
pub fn check_strace() -> Result<(), String> {
    let mut command = Command::new("strace");
    command
        .args(["-qq", "-e", "trace=none", "true"])
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped());
    match command.output() {
        Ok(output) if output.status.success() => Ok(()),
        Ok(output) => {
            Err(format!("strace cannot trace here: {}", String::from_utf8_lossy(&output.stderr).trim()))
        }
        Err(error) => Err(format!("strace does not start: {error} (install the package strace)")),
    }
}

/// Runs a command under strace, which traces `calls` (separated by commas), with an injection if there is one
/// (`write:error=EIO:when=3`). The log is written to files in `folder`.
pub fn traced(
    command: Invocation,
    calls: &str,
    injection: Option<&str>,
    folder: &Path,
) -> Result<(Run, Vec<Call>), String> {
    let logs = folder.join("strace");
    std::fs::create_dir_all(&logs).map_err(|e| format!("{}: {e}", logs.display()))?;
    let mut words: Vec<OsString> =
        ["strace", "-ff", "--seccomp-bpf", "-y", "-qq", "-s", "8", "-e"].map(OsString::from).to_vec();
    words.extend([format!("trace={calls}").into(), "-o".into(), logs.join("log").into()]);
    if let Some(injection) = injection {
        words.extend(["-e".into(), format!("inject={injection}").into()]);
    }
    words.push("--".into());
    let run = command.through(words).run();
    let mut all = Vec::new();
    let entries = std::fs::read_dir(&logs).map_err(|e| format!("{}: {e}", logs.display()))?;
    let mut files: Vec<_> = entries.filter_map(|entry| entry.ok().map(|entry| entry.path())).collect();
    files.sort();
    for file in files {
        let log = std::fs::read(&file).map_err(|e| format!("{}: {e}", file.display()))?;
        all.extend(calls_of(&String::from_utf8_lossy(&log)));
    }
    let _ = std::fs::remove_dir_all(&logs);
    Ok((run, all))
}

fn calls_of(log: &str) -> Vec<Call> {
    let mut calls: Vec<Call> = Vec::new();
    for line in log.lines() {
        let Some((name, rest)) = line.split_once('(') else { continue };
        let Some((arguments, result)) = rest.rsplit_once(" = ") else { continue };
        let nth = 1 + calls.iter().filter(|call| call.name == name).count();
        calls.push(Call {
            name: name.to_owned(),
            arguments: arguments.trim_end().trim_end_matches(')').to_owned(),
            result: result.to_owned(),
            nth,
            injected: result.ends_with("(INJECTED)"),
        });
    }
    calls
}

#[cfg(test)]
mod tests {
    use super::calls_of;

    #[test]
    fn calls_are_numbered_by_name() {
        let log = "openat(AT_FDCWD</>, \"a (b) = c\", O_RDONLY) = 3</a>\nwrite(3</a>, \"x\", 1) = 1\n\
                   openat(3</a>, \"q\", O_RDWR) = -1 EIO (Input/output error) (INJECTED)\n+++ exited with 0 +++\n";
        let calls = calls_of(log);
        let short: Vec<_> = calls.iter().map(|call| (call.name.as_str(), call.nth, call.injected)).collect();
        assert_eq!(short, [("openat", 1, false), ("write", 1, false), ("openat", 2, true)]);
        assert_eq!(calls[0].arguments, "AT_FDCWD</>, \"a (b) = c\", O_RDONLY");
        assert_eq!(calls[0].result, "3</a>");
    }
}
