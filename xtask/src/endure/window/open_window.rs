//! The program's window on a display: opened, acted on, waited for, closed or killed.

use super::display::Display;
use super::frames;
use crate::endure::harness::program::{Invocation, read_aside, resident_memory};
use std::path::{Path, PathBuf};
use std::process::{Child, ExitStatus};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Longest time until a window is there, or until it has done what was asked.
const PATIENCE: Duration = Duration::from_secs(120);
/// Time between two looks.
const POLL: Duration = Duration::from_millis(100);

/// An open window. The program is killed with this value.
pub struct OpenWindow<'a> {
    display: &'a Display,
    program: Child,
    window: String,
    size: [u32; 2],
    frame_log: PathBuf,
    stderr: Option<JoinHandle<String>>,
}

impl<'a> OpenWindow<'a> {
    /// Starts the program and waits for its window, which then covers the display.
    pub fn open(
        command: Invocation,
        display: &'a Display,
        size: [u32; 2],
        folder: &Path,
    ) -> Result<Self, String> {
        let frame_log = folder.join("frames");
        let _ = std::fs::remove_file(&frame_log);
        let command = command
            .env("DISPLAY", Some(display.name().as_ref()))
            .env("DBUS_SESSION_BUS_ADDRESS", None)
            .env("FOCUS_BRUSH_FILE_DIALOG", Some("typed".as_ref()))
            .env("FOCUS_BRUSH_FRAME_LOG", Some(frame_log.as_os_str()))
            .env("WINIT_X11_SCALE_FACTOR", Some("1".as_ref()));
        let mut program = command.start().map_err(|e| format!("{}: does not start: {e}", command.shown()))?;
        drop(read_aside(program.stdout.take()));
        let stderr = Some(read_aside(program.stderr.take()));
        let mut window = Self { display, program, window: String::new(), size, frame_log, stderr };
        window.wait_until("there is a window", |window| {
            let found = window.display.xdotool("search --onlyvisible --name Focus.Brush").unwrap_or_default();
            window.window = found.lines().last().unwrap_or_default().to_owned();
            !window.window.is_empty()
        })?;
        std::thread::sleep(Duration::from_millis(500));
        let id = window.window.clone();
        let [width, height] = size;
        window.display.xdotool(&format!("windowmove {id} 0 0 windowsize {id} {width} {height}"))?;
        std::thread::sleep(Duration::from_millis(300));
        window.display.xdotool(&format!("windowfocus {id}"))?;
        Ok(window)
    }

    /// Waits until this holds.
    pub fn wait_until(&mut self, what: &str, mut holds: impl FnMut(&mut Self) -> bool) -> Result<(), String> {
        let start = Instant::now();
        while !holds(self) {
            if let Ok(Some(status)) = self.program.try_wait() {
                return Err(format!("the window ended ({status}) before {what}: {}", self.last_words()));
            }
            if start.elapsed() > PATIENCE {
                return Err(format!("waited in vain until {what}; its title is {:?}", self.title()));
            }
            std::thread::sleep(POLL);
        }
        Ok(())
    }

    /// Whether the program still runs.
    pub fn is_alive(&mut self) -> bool {
        matches!(self.program.try_wait(), Ok(None))
    }

    /// The number of its process.
    pub fn process_id(&self) -> u32 {
        self.program.id()
    }

    /// Its title.
    pub fn title(&self) -> String {
        let title = self.display.xdotool(&format!("getwindowname {}", self.window)).unwrap_or_default();
        title.trim().to_owned()
    }

    /// Waits until no job is at work for two seconds, with the pointer moving beside the views so that frames are drawn.
    pub fn settle(&mut self) -> Result<(), String> {
        let [width, height] = self.size;
        let mut step = 0;
        let since = frames::read(&self.frame_log).last().map_or(0.0, |second| second.at);
        self.wait_until("it is at rest", |window| {
            step += 1;
            let _ = window.display.xdotool(&format!("mousemove {} {}", width - 3 - step % 2, height - 3));
            let seconds = frames::read(&window.frame_log);
            let mut last = seconds.iter().rev().take_while(|second| second.at > since && second.jobs == 0);
            last.next().is_some() && last.next().is_some()
        })
    }

    /// What the window recorded of its frames.
    pub fn frames(&self) -> Vec<frames::Second> {
        frames::read(&self.frame_log)
    }

    /// Resident memory, bytes.
    pub fn memory(&self) -> u64 {
        resident_memory(self.process_id())
    }

    /// Presses keys, one after the other, as xdotool names them.
    pub fn press(&self, keys: &str) -> Result<(), String> {
        self.display.xdotool(&format!("key --delay 30 {keys}")).map(|_| ())
    }

    /// Types a text.
    pub fn types(&self, text: &str) -> Result<(), String> {
        self.display.types(text)
    }

    /// Drags with a button through points of the window, 0 to 1 in both directions.
    pub fn drag(&self, button: u8, points: &[[f64; 2]]) -> Result<(), String> {
        let mut line = String::new();
        for (k, [x, y]) in points.iter().enumerate() {
            let [x, y] = [x * f64::from(self.size[0]), y * f64::from(self.size[1])];
            line += &format!("mousemove {x:.0} {y:.0} sleep 0.02 ");
            if k == 0 {
                line += &format!("mousedown {button} sleep 0.02 ");
            }
        }
        self.display.xdotool(&format!("{line} mouseup {button}")).map(|_| ())
    }

    /// Moves the pointer to a point of the window.
    pub fn hover(&self, [x, y]: [f64; 2]) -> Result<(), String> {
        let [x, y] = [x * f64::from(self.size[0]), y * f64::from(self.size[1])];
        self.display.xdotool(&format!("mousemove {x:.0} {y:.0}")).map(|_| ())
    }

    /// Kills the program, as a crash would.
    pub fn kill(&mut self) {
        let _ = self.program.kill();
        let _ = self.program.wait();
    }

    /// Waits for its end, after it was asked to close.
    pub fn wait_for_end(&mut self) -> Result<ExitStatus, String> {
        let start = Instant::now();
        loop {
            match self.program.try_wait() {
                Ok(Some(status)) => return Ok(status),
                Ok(None) if start.elapsed() < PATIENCE => std::thread::sleep(POLL),
                Ok(None) => {
                    return Err(format!("the window does not close; its title is {:?}", self.title()));
                }
                Err(error) => return Err(format!("the window cannot be waited for: {error}")),
            }
        }
    }

    /// The last line that it reported. Only once it has ended.
    fn last_words(&mut self) -> String {
        let text = self.stderr.take().and_then(|reader| reader.join().ok()).unwrap_or_default();
        text.lines().last().unwrap_or("(nothing was reported)").to_owned()
    }
}

impl Drop for OpenWindow<'_> {
    fn drop(&mut self) {
        self.kill();
    }
}
