//! Runs the program in surroundings of our own, under limits, and measures it.

use crate::chore::Failure;
use std::ffi::{OsStr, OsString};
use std::io::Read;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// How often a running program is measured.
const POLL: Duration = Duration::from_millis(2);
/// A program that neither works nor ends is stopped after this time, or [`WALL_PER_CPU`] times its limit of processor time.
const WALL_LIMIT: Duration = Duration::from_secs(240);
/// By how much other programs may slow one down that works.
const WALL_PER_CPU: u64 = 8;
/// The most that counts of the time between two measurements: longer ones are those of a run that was itself halted.
const LONGEST_POLL: Duration = Duration::from_secs(1);
/// `sysconf(_SC_CLK_TCK)`, which is this on every Linux.
const TICKS_PER_SECOND: f64 = 100.0;

/// The program under test.
pub struct Program {
    path: PathBuf,
    home: PathBuf,
}

/// A run that has ended.
pub struct Run {
    /// The command, as typed.
    pub shown: String,
    /// Exit code, if it ended by itself.
    pub code: Option<i32>,
    /// The signal that ended it, else 0.
    pub signal: i32,
    /// What it printed.
    pub stdout: String,
    /// What it reported.
    pub stderr: String,
    /// Processor time of all threads and children, s.
    pub cpu_s: f64,
    /// The largest resident memory seen, bytes.
    pub peak_bytes: u64,
    /// Why it was stopped from here.
    pub stopped: Option<String>,
}

/// Limits of a run; `None` is none.
#[derive(Clone, Copy, Default)]
pub struct Limits {
    /// Address space, bytes (RLIMIT_AS).
    pub address_space: Option<u64>,
    /// Processor time, s (RLIMIT_CPU).
    pub cpu_s: Option<u64>,
    /// Size of a file that is written, bytes (RLIMIT_FSIZE).
    pub file_bytes: Option<u64>,
}

/// A command to be run.
pub struct Invocation {
    prefix: Vec<OsString>,
    program: PathBuf,
    arguments: Vec<OsString>,
    folder: PathBuf,
    environment: Vec<(OsString, Option<OsString>)>,
    limits: Limits,
}

impl Program {
    /// The program at `path`; its home, cache and settings are below `folder`.
    pub fn new(path: PathBuf, folder: &Path) -> Result<Self, Failure> {
        let path = path.canonicalize().map_err(|e| Failure::new(format!("{}: {e}", path.display())))?;
        Ok(Self { path, home: folder.join("home") })
    }

    /// Another program in the same surroundings: `name`, in a folder beside this one.
    pub fn beside(&self, folder: &str, name: &str) -> Self {
        let parent = self.path.parent().unwrap_or(Path::new("."));
        Self { path: parent.join(folder).join(name), home: self.home.clone() }
    }

    /// Whether it can be started.
    pub fn is_there(&self) -> bool {
        self.path.is_file()
    }

    /// The program with these arguments, in this folder.
    pub fn with<A: AsRef<OsStr>>(&self, folder: &Path, arguments: impl IntoIterator<Item = A>) -> Invocation {
        let variable = |name: &str, value: Option<OsString>| (OsString::from(name), value);
        Invocation {
            prefix: Vec::new(),
            program: self.path.clone(),
            arguments: arguments.into_iter().map(|a| a.as_ref().to_owned()).collect(),
            folder: folder.to_owned(),
            environment: vec![
                variable("HOME", Some(self.home.clone().into())),
                variable("XDG_CACHE_HOME", Some(self.home.join("cache").into())),
                variable("XDG_CONFIG_HOME", Some(self.home.join("config").into())),
                // Set, so that the program does not start itself again to set it.
                variable("NODEVICE_SELECT", Some("1".into())),
                variable("RUST_BACKTRACE", None),
                variable("OCIO", None),
                variable("DISPLAY", None),
                variable("WAYLAND_DISPLAY", None),
            ],
            limits: Limits::default(),
        }
    }

    /// The program with the words of a line.
    pub fn line(&self, folder: &Path, line: &str) -> Invocation {
        self.with(folder, line.split_whitespace())
    }
}

impl Invocation {
    /// Under these limits.
    pub fn limited(mut self, limits: Limits) -> Self {
        self.limits = limits;
        self
    }

    /// With a variable set, or unset.
    pub fn env(mut self, name: &str, value: Option<&OsStr>) -> Self {
        self.environment.push((name.into(), value.map(OsStr::to_owned)));
        self
    }

    /// Run by another program, which gets these arguments first.
    pub fn through(mut self, prefix: impl IntoIterator<Item = OsString>) -> Self {
        self.prefix = prefix.into_iter().collect();
        self
    }

    /// As typed in a shell.
    pub fn shown(&self) -> String {
        let program = self.program.file_name().unwrap_or_default();
        let words = std::iter::once(program).chain(self.arguments.iter().map(|word| word.as_os_str()));
        words.map(|word| word.to_string_lossy()).collect::<Vec<_>>().join(" ")
    }

    /// Starts it.
    pub fn start(&self) -> std::io::Result<Child> {
        let mut words: Vec<OsString> = self.prefix.clone();
        let Limits { address_space, cpu_s, file_bytes } = self.limits;
        let limits = [("--as", address_space), ("--cpu", cpu_s), ("--fsize", file_bytes)];
        if limits.iter().any(|(_, limit)| limit.is_some()) {
            words.push("prlimit".into());
            words.extend(
                limits.iter().filter_map(|(name, limit)| Some(format!("{name}={}", (*limit)?).into())),
            );
            words.push("--".into());
        }
        words.push(self.program.clone().into());
        let mut command = Command::new(&words[0]);
        command.args(&words[1..]).args(&self.arguments).current_dir(&self.folder);
        for (name, value) in &self.environment {
            match value {
                Some(value) => command.env(name, value),
                None => command.env_remove(name),
            };
        }
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn()
    }

    fn wall_limit(&self) -> Duration {
        let of_cpu = Duration::from_secs(self.limits.cpu_s.unwrap_or(0).saturating_mul(WALL_PER_CPU));
        WALL_LIMIT.max(of_cpu)
    }

    /// Runs it to its end.
    pub fn run(&self) -> Run {
        let mut run = Run {
            shown: self.shown(),
            code: None,
            signal: 0,
            stdout: String::new(),
            stderr: String::new(),
            cpu_s: 0.0,
            peak_bytes: 0,
            stopped: None,
        };
        match self.start() {
            Ok(child) => run.wait_for(child, self.wall_limit()),
            Err(error) => run.stopped = Some(format!("does not start: {error}")),
        }
        run
    }

    /// Runs it to its end; anything but exit code 0 is an error.
    pub fn succeed(&self) -> Result<Run, String> {
        let run = self.run();
        match run.code {
            Some(0) => Ok(run),
            code => Err(format!("{}: exit code {code:?}: {}", run.shown, run.last_line())),
        }
    }
}

impl Run {
    /// Waits for a program that was started, and measures it; stops it after `limit`.
    fn wait_for(&mut self, mut child: Child, limit: Duration) {
        let (stdout, stderr) = (read_aside(child.stdout.take()), read_aside(child.stderr.take()));
        let (mut waited, mut last) = (Duration::ZERO, Instant::now());
        let id = child.id();
        loop {
            let (state, cpu_s) = state_and_time(id);
            self.cpu_s = self.cpu_s.max(cpu_s);
            self.peak_bytes = self.peak_bytes.max(peak_memory(id));
            if state == b'Z' || state == 0 {
                break;
            }
            waited += last.elapsed().min(LONGEST_POLL);
            last = Instant::now();
            if waited > limit {
                self.stopped = Some(format!("did not end in {} s", limit.as_secs()));
                let _ = child.kill();
                break;
            }
            std::thread::sleep(POLL);
        }
        match child.wait() {
            Ok(status) => (self.code, self.signal) = (status.code(), status.signal().unwrap_or(0)),
            Err(error) => self.stopped = Some(format!("cannot be waited for: {error}")),
        }
        self.stdout = stdout.join().unwrap_or_default();
        self.stderr = stderr.join().unwrap_or_default();
    }

    /// The error, or what was allocated in vain, or the last line that was reported.
    pub fn last_line(&self) -> &str {
        let tells = |line: &&str| line.starts_with("error:") || line.contains("memory allocation of");
        let error = self.stderr.lines().find(tells);
        error.or_else(|| self.stderr.lines().last()).unwrap_or("(nothing was reported)")
    }
}

/// Reads what a program prints, so that it never waits to be read.
pub fn read_aside(pipe: Option<impl Read + Send + 'static>) -> std::thread::JoinHandle<String> {
    std::thread::spawn(move || {
        let mut bytes = Vec::new();
        if let Some(mut pipe) = pipe {
            let _ = pipe.read_to_end(&mut bytes);
        }
        String::from_utf8_lossy(&bytes).into_owned()
    })
}

/// State letter (0 if there is no such process) and processor time of a process with the children it waited for.
fn state_and_time(id: u32) -> (u8, f64) {
    let stat = std::fs::read_to_string(format!("/proc/{id}/stat")).unwrap_or_default();
    // The name, in brackets, may contain anything.
    let Some((_, fields)) = stat.rsplit_once(')') else { return (0, 0.0) };
    let fields: Vec<&str> = fields.split_whitespace().collect();
    let ticks: f64 = fields.iter().skip(11).take(4).filter_map(|field| field.parse::<f64>().ok()).sum();
    (fields.first().map_or(0, |state| state.as_bytes()[0]), ticks / TICKS_PER_SECOND)
}

/// The largest resident memory of a process so far, bytes; 0 once it has ended.
fn peak_memory(id: u32) -> u64 {
    memory(id, "VmHWM:")
}

/// The resident memory of a process, bytes; 0 once it has ended.
pub fn resident_memory(id: u32) -> u64 {
    memory(id, "VmRSS:")
}

fn memory(id: u32, field: &str) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{id}/status")).unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix(field));
    let kilobytes = line.and_then(|line| line.trim().trim_end_matches(" kB").parse::<u64>().ok());
    kilobytes.unwrap_or(0) * 1024
}

/// Whether a program of this name can be started.
pub fn is_installed(name: &str) -> bool {
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&path).any(|folder| folder.join(name).is_file())
}
