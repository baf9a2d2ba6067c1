//! The program accepts every command named in the figures and on their pages.
//!
//! A command is parsed by the program itself: once with `--help` appended, which is answered only after all
//! preceding options were parsed, and once unchanged if it names a placeholder file: a missing file is bad
//! input, not wrong usage.

use crate::pages::{lines, repository};
use crate::program::run;

/// The pages of figures; the pages of the book whose commands are run are in `running`.
const PAGES: [&str; 3] = ["docs/performance.md", "docs/performance-light.md", "docs/performance-captures.md"];
/// Names of files that a reader fills in.
const FILLED_IN: [&str; 6] = ["SCENE", "CAPTURE", "P.fbrush", "field.salf", "ours.exr", "OUT.exr"];
/// Exit code of wrong usage.
const WRONG_USAGE: i32 = 2;

/// The commands of a text in the form `A && B`; brackets and ellipses are taken off.
fn split(command: &str) -> Vec<String> {
    let plain = command.replace(['[', ']', '…'], "");
    plain.split(" && ").map(|part| part.trim().to_owned()).collect()
}

/// The commands in the records of `docs/figures`.
fn commands_of_records() -> Vec<String> {
    let entries = std::fs::read_dir(repository().join("docs/figures")).unwrap();
    let files = entries
        .map(|entry| entry.unwrap().path())
        .filter(|file| file.extension().is_some_and(|e| e == "json"));
    let mut commands = Vec::new();
    for file in files {
        let json: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(&file).unwrap()).unwrap();
        let records =
            json.as_object().unwrap().values().filter_map(|set| set["records"].as_array()).flatten();
        commands.extend(records.map(|record| record["command"].as_str().unwrap().to_owned()));
    }
    commands.sort();
    commands.dedup();
    commands
}

/// The commands on the pages: code blocks and inline code that begin with the program or a script.
fn commands_of_pages() -> Vec<String> {
    let mut commands = Vec::new();
    for page in PAGES {
        let text = std::fs::read_to_string(repository().join(page)).unwrap();
        for line in lines(&text) {
            let pieces: Vec<&str> = match line.block {
                Some(_) => vec![line.text.trim()],
                None => line.text.split('`').skip(1).step_by(2).collect(),
            };
            let is_command = |piece: &&str| {
                ["focus-brush ", "target/", "tests/", "./"].iter().any(|start| piece.starts_with(start))
            };
            commands.extend(pieces.into_iter().filter(is_command).map(str::to_owned));
        }
    }
    commands
}

/// Why a command is rejected.
fn problem(command: &str) -> Option<String> {
    let (program, arguments) = command.split_once(' ').unwrap_or((command, ""));
    let place = tempfile::tempdir().unwrap();
    if program.rsplit('/').next() != Some("focus-brush") {
        let is_there = repository().join(program).is_file();
        return (!is_there).then(|| format!("{command}: there is no {program}"));
    }
    let help = run(place.path(), &format!("{arguments} --help"));
    if !help.status.success() {
        return Some(format!("{command}: {}", String::from_utf8_lossy(&help.stderr)));
    }
    let has_subcommand = !FILLED_IN.contains(&arguments);
    if has_subcommand && arguments.split(' ').any(|word| FILLED_IN.contains(&word)) {
        let output = run(place.path(), arguments);
        let is_usage = output.status.code() == Some(WRONG_USAGE);
        return is_usage.then(|| format!("{command}: {}", String::from_utf8_lossy(&output.stderr)));
    }
    None
}

#[test]
fn the_program_understands_every_command_of_the_figures() {
    let commands: Vec<String> =
        commands_of_records().iter().chain(&commands_of_pages()).flat_map(|c| split(c)).collect();
    let mut commands = commands;
    commands.sort();
    commands.dedup();
    assert!(commands.len() > 10, "{} commands: are they looked for?", commands.len());
    let problems: Vec<String> = commands.iter().filter_map(|command| problem(command)).collect();
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

#[test]
fn commands_that_do_not_exist_are_found() {
    for wrong in [
        "focus-brush report --engin SCENE -o DIR",
        "focus-brush rendr SCENE -o OUT.exr",
        "focus-brush render SCENE --tolerance wide -o OUT.exr",
        "focus-brush compare ours.exr",
        "tests/window/no_such_script.sh",
    ] {
        assert!(problem(wrong).is_some(), "{wrong}");
    }
    assert_eq!(problem("target/release/focus-brush report --engine SCENE -o DIR"), None);
    assert_eq!(split("focus-brush info [SCENE…] && ./run"), ["focus-brush info SCENE", "./run"]);
}
