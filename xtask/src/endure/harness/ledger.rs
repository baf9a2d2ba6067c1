//! Counts of full runs, added up over days: `docs/promises.json`, and `docs/promises.md` made from it.

use super::promise::Promise;
use crate::chore::{Failure, output_of, repository};
use serde_json::{Map, Value, json};
use std::path::Path;
use std::process::Command;

/// What was counted, by promise.
pub struct Ledger {
    rows: Map<String, Value>,
}

impl Ledger {
    /// Reads the ledger of a folder; an absent one is empty.
    pub fn read(folder: &Path) -> Result<Self, Failure> {
        let file = folder.join("promises.json");
        if !file.exists() {
            return Ok(Self { rows: Map::new() });
        }
        let failed = |e: &dyn std::fmt::Display| Failure::new(format!("{}: {e}", file.display()));
        let text = std::fs::read(&file).map_err(|e| failed(&e))?;
        let rows = serde_json::from_slice(&text).map_err(|e| failed(&e))?;
        Ok(Self { rows })
    }

    /// Cases of a promise that were played.
    pub fn count(&self, promise: &str) -> usize {
        self.number(promise, "count")
    }

    fn number(&self, promise: &str, field: &str) -> usize {
        let number = self.rows.get(promise).and_then(|row| row[field].as_u64());
        number.and_then(|number| usize::try_from(number).ok()).unwrap_or(0)
    }

    /// Adds what was played today with the present commit.
    pub fn add(&mut self, promise: &str, count: usize, violations: usize) {
        let row = json!({
            "count": self.count(promise) + count,
            "violations": self.number(promise, "violations") + violations,
            "date": printed(Command::new("date").args(["-u", "+%Y-%m-%d"])),
            "commit": commit(),
        });
        self.rows.insert(promise.into(), row);
    }

    /// Writes ledger and table.
    pub fn write(&self, folder: &Path, promises: &[Promise]) -> Result<(), Failure> {
        let json = serde_json::to_string_pretty(&self.rows).map_err(|e| Failure::new(e.to_string()))? + "\n";
        replace(&folder.join("promises.json"), &json)?;
        replace(&folder.join("promises.md"), &self.table(promises))
    }

    fn table(&self, promises: &[Promise]) -> String {
        let mut text = String::from(
            "# Promises\n\nEach is a test with a number. `cargo xtask endure --full` plays the cases and writes this \
             table; a short form is part of `./test`. A case that broke its promise counts as a violation until the \
             promise is counted anew.\n\n\
             | promise | what is done | count | violations | date | commit |\n| --- | --- | ---: | ---: | --- | --- |\n",
        );
        for promise in promises {
            let text_of =
                |field: &str| self.rows.get(promise.name).and_then(|row| row[field].as_str()).unwrap_or("–");
            text += &format!(
                "| {} | {} | {} of {} | {} | {} | {} |\n",
                promise.sentence,
                promise.what_is_done,
                self.count(promise.name),
                promise.full,
                self.number(promise.name, "violations"),
                text_of("date"),
                text_of("commit"),
            );
        }
        text
    }
}

/// The commit of the sources, marked if they differ from it; the ledger itself, which every run changes, is none of them.
fn commit() -> String {
    let git = |arguments: &[&str]| printed(Command::new("git").arg("-C").arg(repository()).args(arguments));
    let commit = git(&["describe", "--always", "--exclude=*", "--abbrev=9"]);
    let sources = [":/", ":(top,exclude)docs/promises.json", ":(top,exclude)docs/promises.md"];
    let changed = git(&[&["status", "--porcelain", "--untracked-files=no", "--"][..], &sources].concat());
    if changed.is_empty() { commit } else { format!("{commit}-dirty") }
}

fn printed(command: &mut Command) -> String {
    let output = output_of(command).unwrap_or_default();
    String::from_utf8_lossy(&output).trim().to_owned()
}

/// Replaces a file by a complete new one: a run may be stopped at any moment.
fn replace(file: &Path, text: &str) -> Result<(), Failure> {
    let new = file.with_extension("new");
    let written = std::fs::write(&new, text).and_then(|()| std::fs::rename(&new, file));
    written.map_err(|e| Failure::new(format!("{}: {e}", file.display())))
}
