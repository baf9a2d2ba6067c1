//! Promises about the session itself, without a window: tried by programs in `app/examples`.

pub mod lost_card;
pub mod undo;

use super::harness::program::{Program, Run};
use super::harness::promise::{Context, Verdict};
use crate::chore::{cargo, execute};

/// The example of this name, which lies beside the program.
fn example(name: &str, context: &Context) -> Program {
    context.program.beside("examples", name)
}

/// Builds an example, unless `$FOCUS_BRUSH` names a program that has it beside it.
fn build(name: &str, context: &Context) -> Result<(), String> {
    if std::env::var_os("FOCUS_BRUSH").is_none() {
        let mut build = cargo("build");
        build.args(["--quiet", "--package", "focus-brush", "--example", name]);
        execute(&mut build).map_err(|failure| failure.to_string())?;
    }
    match example(name, context).is_there() {
        true => Ok(()),
        false => Err(format!(
            "there is no example {name} beside the program (cargo build --package focus-brush --example {name})"
        )),
    }
}

/// What an example found: exit code 0 and nothing, or a line that says what.
fn verdict(run: &Run) -> Verdict {
    match (run.code, &run.stopped) {
        (Some(0), None) => Ok(()),
        (_, Some(why)) => Err(format!("{}: {why}", run.shown)),
        (code, None) => {
            let found = run.stdout.lines().find_map(|line| line.strip_prefix("violation: "));
            let panicked = run.stderr.split_once("panicked at ").map(|(_, rest)| rest.lines().take(2));
            let panicked =
                panicked.map(|lines| format!("panicked at {}", lines.collect::<Vec<_>>().join(" ")));
            let ended = || panicked.unwrap_or_else(|| format!("exit code {code:?}: {}", run.last_line()));
            let what = found.map_or_else(ended, str::to_owned);
            Err(format!("{}: {what}", run.shown))
        }
    }
}
