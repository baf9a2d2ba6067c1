#![doc = include_str!("../README.md")]
#![cfg_attr(windows, windows_subsystem = "windows")]

mod message;

use std::io::{Error, Read};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};

/// The name of the program that is started, without the ending that programs have here.
const PROGRAM: &str = "focus-brush";

/// How much of the end of what is printed is shown at most, bytes: the last line is far shorter.
const TAIL_BYTES: usize = 1 << 16;

fn main() -> ExitCode {
    match run() {
        Ok((0, _)) => ExitCode::SUCCESS,
        Ok((code, printed)) => {
            message::show(&last_line(&printed).unwrap_or(format!("{PROGRAM} ended with code {code}")));
            ExitCode::from(u8::try_from(code).unwrap_or(1))
        }
        Err(error) => {
            message::show(&format!("{PROGRAM} does not start: {error}"));
            ExitCode::FAILURE
        }
    }
}

/// Starts the program and waits for it. Returns its exit code and the end of what it printed to stderr.
fn run() -> Result<(i32, Vec<u8>), Error> {
    let mut command = Command::new(program(&std::env::current_exe()?));
    command.args(std::env::args_os().skip(1));
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
    #[cfg(windows)]
    {
        /// No console (winbase.h).
        const CREATE_NO_WINDOW: u32 = 0x0800_0000;
        std::os::windows::process::CommandExt::creation_flags(&mut command, CREATE_NO_WINDOW);
    }
    let mut child = command.spawn()?;
    let printed = child.stderr.take().map(|from| end_of(from, TAIL_BYTES)).unwrap_or_default();
    Ok((child.wait()?.code().unwrap_or(1), printed))
}

/// The program to start: in the folder of this one, or in the folder `bin` there.
fn program(own: &Path) -> PathBuf {
    let name = format!("{PROGRAM}{}", std::env::consts::EXE_SUFFIX);
    let folder = own.parent().unwrap_or(Path::new("."));
    let below = folder.join("bin").join(&name);
    if below.is_file() { below } else { folder.join(name) }
}

/// The last `most` bytes that `from` has, and up to as many before them.
fn end_of(mut from: impl Read, most: usize) -> Vec<u8> {
    let (mut tail, mut chunk) = (Vec::new(), [0; 4096]);
    while let Ok(length @ 1..) = from.read(&mut chunk) {
        tail.extend_from_slice(&chunk[..length]);
        if tail.len() > 2 * most {
            tail.drain(..tail.len() - most);
        }
    }
    tail
}

/// The last line with something on it.
fn last_line(printed: &[u8]) -> Option<String> {
    let text = String::from_utf8_lossy(printed);
    text.lines().map(str::trim).rfind(|line| !line.is_empty()).map(str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_line_remains() {
        let long = "x\n".repeat(100_000) + "error: no window (try doctor)\r\n\n";
        let tail = end_of(long.as_bytes(), 1000);
        assert!((1000..6100).contains(&tail.len()), "{}", tail.len());
        assert_eq!(last_line(&tail).as_deref(), Some("error: no window (try doctor)"));
        assert_eq!(last_line(b" \n"), None);
    }

    #[test]
    fn the_program_is_beside_or_below() {
        let folder = std::env::temp_dir().join(format!("window-launcher-{}", std::process::id()));
        let name = format!("focus-brush{}", std::env::consts::EXE_SUFFIX);
        std::fs::create_dir_all(folder.join("bin")).unwrap();
        assert_eq!(program(&folder.join("own.exe")), folder.join(&name));
        std::fs::write(folder.join("bin").join(&name), "").unwrap();
        assert_eq!(program(&folder.join("own.exe")), folder.join("bin").join(&name));
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
