//! `endure [--full] [PROMISE…]`: promises of the program, each a test with a number, kept on its command line.
//!
//! * Without `--full` the short counts are run, and nothing is written.
//! * With `--full` each promise is continued where the last run stopped, case by case, until its full count is
//!   reached for the present commit's state; `docs/promises.json` is written every few seconds and
//!   `docs/promises.md` from it. A run may be stopped at any moment (Ctrl-C, SIGTERM) and started again.
//! * `--case N` repeats one case; a violation says which. Its files stay in `target/endure/kept`.
//!
//! A promise is a file of `endure/`: it plays a range of cases, and a case depends on its number alone.
//! `harness` has what all share.

mod bombs;
mod examples;
mod faults;
mod fuzz;
mod harness;
mod malformed;
mod memory;
mod old_files;
mod one_writer;
mod outside;
mod same_bits;
mod same_bytes;
mod surroundings;
mod unwrapping;
mod window;

use crate::chore::{Failure, repository};
use crate::packages::{TO_ACT, TO_ENDURE, TO_RUN, install_missing};
use crate::run;
use harness::ledger::Ledger;
use harness::promise::{Context, Outcome, Promise};
use std::ffi::OsString;
use std::path::PathBuf;

/// All promises, in the order in which they are run.
const PROMISES: [Promise; 16] = [
    bombs::PROMISE,
    malformed::PROMISE,
    fuzz::PROMISE,
    faults::PROMISE,
    outside::PROMISE,
    same_bytes::PROMISE,
    one_writer::PROMISE,
    surroundings::PROMISE,
    memory::PROMISE,
    old_files::PROMISE,
    window::crash::PROMISE,
    unwrapping::PROMISE,
    same_bits::PROMISE,
    examples::lost_card::PROMISE,
    examples::undo::PROMISE,
    window::artist::PROMISE,
];

/// Violations that are printed of a promise; all are counted.
const SHOWN_VIOLATIONS: usize = 40;

struct Options {
    full: bool,
    case: Option<usize>,
    promises: Vec<Promise>,
}

/// Runs promises; those named, or all.
///
/// # Errors
/// Wrong usage, the program does not build, or a promise was broken.
pub fn endure(arguments: &[OsString]) -> Result<(), Failure> {
    let options = parse(arguments)?;
    // A short run skips what it cannot try.
    let packages = if options.full { &[TO_ENDURE, TO_RUN, TO_ACT][..] } else { &[TO_ENDURE] };
    if let Err(failure) = install_missing(packages) {
        eprintln!("note: {failure}");
    }
    let context = Context::new(program()?)?;
    let mut broken = 0;
    for promise in &options.promises {
        broken +=
            if options.full { run_full(promise, &context)? } else { run_short(promise, &options, &context)? };
    }
    match broken {
        0 => Ok(()),
        1 => Err(Failure::new("1 case broke its promise")),
        _ => Err(Failure::new(format!("{broken} cases broke their promises"))),
    }
}

/// The program to test: `$FOCUS_BRUSH`, or as built now.
fn program() -> Result<PathBuf, Failure> {
    match std::env::var_os("FOCUS_BRUSH") {
        Some(path) => Ok(path.into()),
        None => run::build_focus_brush(),
    }
}

fn parse(arguments: &[OsString]) -> Result<Options, Failure> {
    let mut options = Options { full: false, case: None, promises: Vec::new() };
    let mut words = arguments.iter().map(|word| word.to_string_lossy());
    while let Some(word) = words.next() {
        match word.as_ref() {
            "--full" => options.full = true,
            "--case" => {
                let number = words.next().and_then(|number| number.parse().ok());
                options.case = Some(number.ok_or_else(|| Failure::new("--case needs a number"))?);
            }
            name => {
                let promise = PROMISES.iter().find(|promise| promise.name == name);
                let names = PROMISES.map(|promise| promise.name).join(", ");
                let unknown =
                    || Failure::new(format!("{name}: there is no such promise (there are {names})"));
                options.promises.push(*promise.ok_or_else(unknown)?);
            }
        }
    }
    if options.case.is_some() && (options.promises.len() != 1 || options.full) {
        return Err(Failure::new(
            "--case repeats a case of one promise, which must be named, without --full",
        ));
    }
    if options.promises.is_empty() {
        options.promises = PROMISES.to_vec();
    }
    Ok(options)
}

/// Runs the short count, or one case. Returns how many cases broke the promise.
fn run_short(promise: &Promise, options: &Options, context: &Context) -> Result<usize, Failure> {
    let (first, count) = options.case.map_or((0, promise.short), |case| (case, 1));
    if count == 0 {
        println!("{}: with --full only", promise.name);
        return Ok(0);
    }
    let start = std::time::Instant::now();
    let outcome = promise.play(first, count, context)?;
    report(promise, &outcome, count, start.elapsed().as_secs_f64());
    Ok(outcome.violations.len())
}

/// Continues the full count in batches, each of which is written down. Returns how many cases broke the promise.
fn run_full(promise: &Promise, context: &Context) -> Result<usize, Failure> {
    let folder = repository().join("docs");
    let mut ledger = Ledger::read(&folder)?;
    let mut broken = 0;
    let mut next = ledger.count(promise.name);
    while next < promise.full {
        let start = std::time::Instant::now();
        let count = promise.batch.min(promise.full - next);
        let outcome = promise.play(next, count, context)?;
        report(promise, &outcome, promise.full - next, start.elapsed().as_secs_f64());
        if outcome.skipped.is_some() {
            return Ok(broken);
        }
        broken += outcome.violations.len();
        next += outcome.done;
        ledger.add(promise.name, outcome.done, outcome.violations.len());
        ledger.write(&folder, &PROMISES)?;
    }
    println!("{}: {next} of {}", promise.name, promise.full);
    Ok(broken)
}

fn report(promise: &Promise, outcome: &Outcome, of: usize, seconds: f64) {
    if let Some(why) = &outcome.skipped {
        eprintln!("SKIPPED {}: {why}", promise.name);
        return;
    }
    let Outcome { done, violations, .. } = outcome;
    println!("{}: {done} of {of} in {seconds:.1} s, {} violations", promise.name, violations.len());
    for violation in violations.iter().take(SHOWN_VIOLATIONS) {
        println!("  case {}: {}", violation.case, violation.what);
        println!("    again: cargo xtask endure {} --case {}", promise.name, violation.case);
    }
}
