//! A display of its own, without a screen, and what a hand does on it.

use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Longest time that a display takes to start.
const START_LIMIT: Duration = Duration::from_secs(20);

/// A running display. It ends with this value.
pub struct Display {
    server: Child,
    name: String,
}

impl Display {
    /// Starts a display of this size.
    pub fn start([width, height]: [u32; 2]) -> Result<Self, String> {
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", &format!("{width}x{height}x24"), "-nolisten", "tcp"])
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .map_err(|e| format!("Xvfb: does not start: {e}"))?;
        let mut number = String::new();
        let read = server.stdout.take().map(|stdout| BufReader::new(stdout).read_line(&mut number));
        let display = Self { server, name: format!(":{}", number.trim()) };
        if !matches!(read, Some(Ok(read)) if read > 1) {
            return Err("Xvfb: does not start".into());
        }
        let start = Instant::now();
        while display.xdotool("getdisplaygeometry").is_err() {
            if start.elapsed() > START_LIMIT {
                return Err("Xvfb: does not answer".into());
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        Ok(display)
    }

    /// Its name, for `$DISPLAY`.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Runs xdotool with the words of a line. Returns what it printed.
    pub fn xdotool(&self, line: &str) -> Result<String, String> {
        self.xdotool_with(line.split_whitespace())
    }

    /// Types a text.
    pub fn types(&self, text: &str) -> Result<(), String> {
        self.xdotool_with(["type", "--delay", "12", text]).map(|_| ())
    }

    fn xdotool_with<'a>(&self, words: impl IntoIterator<Item = &'a str>) -> Result<String, String> {
        let mut command = Command::new("xdotool");
        command.args(words).env("DISPLAY", &self.name).stdin(Stdio::null());
        let output = command.output().map_err(|e| format!("xdotool: does not start: {e}"))?;
        match output.status.success() {
            true => Ok(String::from_utf8_lossy(&output.stdout).into_owned()),
            false => Err(format!("xdotool: failed: {}", String::from_utf8_lossy(&output.stderr).trim())),
        }
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}
