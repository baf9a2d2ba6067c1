//! What all promises share: their description, their cases, and where these are played.

use super::program::{Program, Run};
use crate::chore::{Failure, repository};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A promise of the program.
#[derive(Clone, Copy)]
pub struct Promise {
    /// By which it is chosen: one word.
    pub name: &'static str,
    /// What is promised.
    pub sentence: &'static str,
    /// What a case does.
    pub what_is_done: &'static str,
    /// Cases of a full run.
    pub full: usize,
    /// Cases of a short run; 0 where it would take too long.
    pub short: usize,
    /// Cases after which a full run is written down.
    pub batch: usize,
    /// Cases that may be played at the same time.
    pub at_once: usize,
    /// Prepares what all cases need, in a folder of its own; `Err` is why the promise cannot be tried here.
    pub prepare: fn(&Path, &Context) -> Result<(), String>,
    /// Plays the case of this number in an empty folder, with what was prepared in the other.
    pub case: fn(usize, &Workplace, &Context) -> Verdict,
}

/// Whether a case kept the promise: else what happened.
pub type Verdict = Result<(), String>;

/// The folders of a case.
pub struct Workplace {
    /// What was prepared; only read.
    pub prepared: PathBuf,
    /// The case's own.
    pub own: PathBuf,
}

/// A case that broke its promise.
pub struct Violation {
    /// Its number, from which the case is made again.
    pub case: usize,
    /// What was done, and what happened.
    pub what: String,
}

/// What came of a range of cases.
#[derive(Default)]
pub struct Outcome {
    /// Cases that were played.
    pub done: usize,
    /// Those that broke the promise.
    pub violations: Vec<Violation>,
    /// Why nothing was played.
    pub skipped: Option<String>,
}

/// The program, and a folder for files.
pub struct Context {
    /// The program to test.
    pub program: Program,
    folder: PathBuf,
}

impl Context {
    /// A context with an empty folder in `target/endure`.
    pub fn new(program: PathBuf) -> Result<Self, Failure> {
        let target = std::env::var_os("CARGO_TARGET_DIR").map(PathBuf::from);
        let target = target.unwrap_or_else(|| repository().join("target"));
        let folder = target.join("endure").join(std::process::id().to_string());
        let failed = |e| Failure::new(format!("{}: {e}", folder.display()));
        std::fs::create_dir_all(&folder).map_err(failed)?;
        let folder = folder.canonicalize().map_err(failed)?;
        Ok(Self { program: Program::new(program, &folder)?, folder })
    }
}

impl Drop for Context {
    fn drop(&mut self) {
        // What is left over is in `target`.
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

impl Promise {
    /// Plays `count` cases from `first` on.
    pub fn play(&self, first: usize, count: usize, context: &Context) -> Result<Outcome, Failure> {
        let folder = context.folder.join(self.name);
        let prepared = folder.join("prepared");
        let failed = |e| Failure::new(format!("{}: {e}", folder.display()));
        std::fs::create_dir_all(&prepared).map_err(failed)?;
        if let Err(why) = (self.prepare)(&prepared, context) {
            return Ok(Outcome { skipped: Some(why), ..Outcome::default() });
        }
        let kept = context.folder.with_file_name("kept");
        let next = AtomicUsize::new(first);
        let violations = Mutex::new(Vec::new());
        let worker = || {
            loop {
                let case = next.fetch_add(1, Ordering::Relaxed);
                if case >= first + count {
                    return;
                }
                let own = folder.join(format!("case-{case}"));
                let place = Workplace { prepared: prepared.clone(), own };
                let verdict = std::fs::create_dir_all(&place.own).map_err(|e| format!("no folder: {e}"));
                if let Err(what) = verdict.and_then(|()| (self.case)(case, &place, context)) {
                    let mut all = violations.lock().unwrap_or_else(|broken| broken.into_inner());
                    all.push(Violation { case, what });
                    keep(&place.own, &kept.join(format!("{}-{case}", self.name)));
                }
                let _ = std::fs::remove_dir_all(&place.own);
            }
        };
        let cores = std::thread::available_parallelism().map_or(1, |n| n.get());
        std::thread::scope(|scope| {
            for _ in 0..self.at_once.min(cores).min(count) {
                scope.spawn(worker);
            }
        });
        let mut violations = violations.into_inner().unwrap_or_else(|broken| broken.into_inner());
        violations.sort_by_key(|violation| violation.case);
        Ok(Outcome { done: count, violations, skipped: None })
    }
}

/// Moves the files of a case that broke its promise to where they stay.
fn keep(own: &Path, kept: &Path) {
    let _ = std::fs::remove_dir_all(kept);
    let moved =
        kept.parent().map_or(Ok(()), std::fs::create_dir_all).and_then(|()| std::fs::rename(own, kept));
    if let Err(error) = moved {
        eprintln!("note: {}: is not kept: {error}", kept.display());
    }
}

/// Holds of every run: it ended by itself in a documented way, and an error is one line.
pub fn ended_as_documented(run: &Run) -> Verdict {
    if let Some(why) = &run.stopped {
        return Err(format!("{}: {why}", run.shown));
    }
    let Some(code) = run.code else {
        return Err(format!("{}: ended by signal {}: {}", run.shown, run.signal, run.last_line()));
    };
    if run.stderr.contains("fault of the program") || run.stderr.contains("panicked at") || code == 101 {
        return Err(format!("{}: panicked: {}", run.shown, run.last_line()));
    }
    match code {
        0 => Ok(()),
        2 | 3 | 4 | 5 | 75 => {
            let errors: Vec<_> = run.stderr.lines().filter(|line| line.starts_with("error:")).collect();
            if errors.len() == 1 && errors[0].len() > "error: ".len() {
                return Ok(());
            }
            Err(format!(
                "{}: exit code {code} with {} lines of error: {}",
                run.shown,
                errors.len(),
                run.last_line()
            ))
        }
        _ => Err(format!("{}: exit code {code}: {}", run.shown, run.last_line())),
    }
}

/// Nothing to prepare.
pub fn nothing(_: &Path, _: &Context) -> Result<(), String> {
    Ok(())
}
