//! The readers under libFuzzer: inputs that reach new code are changed further, from small valid files on.

mod seeds;
mod targets;

use super::harness::program::{Program, Run, is_installed};
use super::harness::promise::{Context, Promise, Verdict, Workplace};
use crate::chore::{Failure, cargo_in, copy, execute, repository};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use targets::TARGETS;

/// Malformed input is refused, whatever code it reaches.
pub const PROMISE: Promise = Promise {
    name: "fuzz",
    sentence: "Malformed input is refused, whatever code it reaches",
    what_is_done: "a fuzz target a reader under libFuzzer, ten minutes each, counted in minutes: no panic or overflow \
                   in our code, at most 10 s of processor time an input and 1 GiB, one line of error; what it found before is kept",
    full: TARGETS.len() * MINUTES,
    // Building the targets alone takes minutes.
    short: 0,
    batch: 4,
    at_once: 2,
    prepare,
    case: fuzz_for_a_minute,
};

/// Minutes for each target.
const MINUTES: usize = 10;

/// The longest that an input may take, s of processor time.
const SECONDS_OF_INPUT: f64 = 10.0;

/// Coverage for libFuzzer, as cargo-fuzz asks the compiler for it; stable Rust takes these.
const INSTRUMENTATION: &str = "--cfg fuzzing -Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
    -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table \
    -Cllvm-args=-sanitizer-coverage-trace-compares -Cllvm-args=-simplifycfg-branch-fold-threshold=0";

/// Where targets and their inputs stay between runs.
fn folder() -> PathBuf {
    let target = std::env::var_os("CARGO_TARGET_DIR").map(PathBuf::from);
    target.unwrap_or_else(|| repository().join("target")).join("fuzz")
}

/// For this machine: with a platform named, programs that run while building are not instrumented.
fn platform() -> String {
    format!("{}-unknown-linux-gnu", std::env::consts::ARCH)
}

fn target_path(name: &str) -> PathBuf {
    folder().join(platform()).join("debug").join(name)
}

/// Builds the targets, and writes the inputs to begin with.
fn prepare(prepared: &Path, context: &Context) -> Result<(), String> {
    if !is_installed("c++") {
        return Err("libFuzzer needs a C++ compiler (apt-get install g++)".into());
    }
    build().map_err(|failure| format!("the targets do not build: {failure}"))?;
    seeds::write(prepared, &folder().join("seeds"), context)
}

/// Builds all targets with the versions of crates that the program is built with.
fn build() -> Result<(), Failure> {
    let fuzz = repository().join("tests/fuzz");
    let time = |file: &Path| std::fs::metadata(file).and_then(|data| data.modified()).ok();
    let (ours, theirs) = (repository().join("Cargo.lock"), fuzz.join("Cargo.lock"));
    // Cargo leaves out what it does not need, and adds libFuzzer.
    if time(&theirs) < time(&ours) {
        copy(&ours, &theirs)?;
    }
    let mut build = cargo_in(&fuzz, "build");
    build.args(["--quiet", "--bins", "--target", &platform()]);
    build.env("CARGO_TARGET_DIR", folder()).env("RUSTFLAGS", INSTRUMENTATION);
    execute(&mut build)
}

/// Runs a target for a minute from what it has found so far.
fn fuzz_for_a_minute(case: usize, place: &Workplace, _: &Context) -> Verdict {
    let name = TARGETS[case % TARGETS.len()];
    let (corpus, seeds) = (folder().join("corpus").join(name), folder().join("seeds").join(name));
    std::fs::create_dir_all(&corpus).map_err(|e| format!("{}: {e}", corpus.display()))?;
    let files = tempfile_folder(case)?;
    let program = Program::new(target_path(name), &place.own).map_err(|failure| failure.to_string())?;
    let found = format!("-artifact_prefix={}/", place.own.display());
    let options = ["-max_total_time=60", "-timeout=10", "-rss_limit_mb=1024", "-print_final_stats=1", &found];
    let arguments = options.iter().map(AsRef::as_ref).chain([corpus.as_os_str(), seeds.as_os_str()]);
    let run = program.with(&place.own, arguments).env("TMPDIR", Some(files.as_os_str())).run();
    // The clock also runs on while this machine does something else: what takes too long must do so again, in processor time.
    let again = slow_input(&place.own)
        .map(|input| program.with(&place.own, [OsStr::new("-timeout=300"), input.as_os_str()]))
        .map(|invocation| invocation.env("TMPDIR", Some(files.as_os_str())).run());
    let _ = std::fs::remove_dir_all(&files);
    match (run.code, &run.stopped) {
        (Some(0), None) => Ok(()),
        _ if again.is_some_and(|again| again.code == Some(0) && again.cpu_s <= SECONDS_OF_INPUT) => Ok(()),
        (_, Some(why)) => Err(format!("{name}: {why}")),
        _ => Err(format!("{name}: {}", fault(&run))),
    }
}

/// The input that took longer than allowed, if there was one: libFuzzer stores it under this name.
fn slow_input(found: &Path) -> Option<PathBuf> {
    let mut paths = std::fs::read_dir(found).ok()?.flatten().map(|entry| entry.path());
    paths.find(|path| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("timeout-")))
}

/// A folder in memory for the files that readers open by their path: thousands a second.
fn tempfile_folder(case: usize) -> Result<PathBuf, String> {
    let memory = Path::new("/dev/shm");
    let memory = if memory.is_dir() { memory.to_owned() } else { std::env::temp_dir() };
    let files = memory.join(format!("focus-brush-fuzz-{}-{case}", std::process::id()));
    std::fs::create_dir_all(&files).map_err(|e| format!("{}: {e}", files.display()))?;
    Ok(files)
}

/// What libFuzzer reports, and the panic before it.
fn fault(run: &Run) -> String {
    // The first: a panic that nobody catches is followed by another.
    let mut lines = run.stderr.lines().skip_while(|line| !line.contains("panicked at "));
    let panic = lines.next().map(|line| format!("{line} {}", lines.next().unwrap_or_default()));
    let error = run.stderr.lines().find(|line| line.contains("ERROR: libFuzzer"));
    let error =
        error.map_or_else(|| run.last_line().to_owned(), |line| line.trim_start_matches('=').to_owned());
    panic.map_or(error.clone(), |panic| format!("{panic} ({error})"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_target_of_the_fuzz_crate_is_run() {
        let sources = repository().join("tests/fuzz/targets");
        let mut names = Vec::new();
        for folder in std::fs::read_dir(sources).unwrap() {
            for file in std::fs::read_dir(folder.unwrap().path()).unwrap() {
                names.push(file.unwrap().path().file_stem().unwrap().to_string_lossy().into_owned());
            }
        }
        names.sort();
        let mut run = TARGETS.map(str::to_owned);
        run.sort();
        assert_eq!(names, run);
    }
}
