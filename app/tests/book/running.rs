//! Every command of the book runs, in the order of its page.
//!
//! Commands are lines of code blocks; blocks fenced as `text` contain placeholders and are skipped. A trailing
//! backslash continues a line; text after two spaces is a remark. Large picture sizes are replaced by small
//! ones.

use crate::pages::{lines, pages, repository};
use crate::workplace::workplace;
#[cfg(unix)]
use std::os::unix::fs::symlink as link_folder;
#[cfg(windows)]
use std::os::windows::fs::symlink_dir as link_folder;
use std::process::Command;

/// Large sizes of pictures, and their replacements.
const LARGE: [&str; 2] = ["8192x4608", "256x144"];

/// A page's commands, each with the number of its line.
fn commands(text: &str) -> Vec<(usize, String)> {
    let mut found: Vec<(usize, String)> = Vec::new();
    let mut goes_on = false;
    for line in lines(text) {
        let is_run = line.block.is_some_and(|block| block != "text");
        let written = line.text.trim();
        if !is_run || !(goes_on || written.starts_with("focus-brush ")) {
            goes_on = false;
            continue;
        }
        let command = written.split("  ").next().unwrap_or(written);
        let (command, more) = match command.strip_suffix('\\') {
            Some(command) => (command, true),
            None => (command, false),
        };
        match found.last_mut().filter(|_| goes_on) {
            Some((_, before)) => *before += command,
            None => found.push((line.number, command.to_owned())),
        }
        goes_on = more;
    }
    found
}

#[test]
fn every_command_of_the_book_runs() {
    let program = std::path::Path::new(env!("CARGO_BIN_EXE_focus-brush"));
    let path = std::env::var("PATH").unwrap_or_default();
    let path = format!("{}:{path}", program.parent().unwrap().display());
    let mut failed = Vec::new();
    let mut count = 0;
    for page in pages() {
        let text = std::fs::read_to_string(&page).unwrap();
        let commands = commands(&text);
        if commands.is_empty() {
            continue;
        }
        let place = workplace();
        // Files of the repository that pages name.
        for shipped in ["assets", "docs"] {
            link_folder(repository().join(shipped), place.path().join(shipped)).unwrap();
        }
        let page = page.strip_prefix(repository()).unwrap().display();
        for (number, command) in commands {
            count += 1;
            let output = Command::new("sh")
                .args(["-ec", &command.replace(LARGE[0], LARGE[1])])
                .current_dir(place.path())
                .env("PATH", &path)
                .env("XDG_CACHE_HOME", place.path().join("cache"))
                .env_remove("XDG_RUNTIME_DIR")
                .output()
                .unwrap();
            // 5: the graphics card that a command requests is not available.
            if !output.status.success() && output.status.code() != Some(5) {
                let said = String::from_utf8_lossy(&output.stderr);
                let said = said.lines().filter(|line| line.starts_with("error: ")).collect::<Vec<_>>();
                failed.push(format!("{page}:{number}: {command}\n    {}", said.join("; ")));
            }
        }
    }
    assert!(count > 20, "{count} commands: are they looked for?");
    assert!(failed.is_empty(), "commands that fail:\n{}", failed.join("\n"));
}

#[test]
fn commands_are_read_as_they_are_meant() {
    let text = "# A\n\n    focus-brush info a.glb   what is in it\n\n```text\nfocus-brush render \
                FILE\n```\n\n```sh\nfocus-brush new a.glb \\\n    -o a.fbrush\n```\nfocus-brush is a \
                program\n";
    let found: Vec<_> = commands(text).into_iter().map(|(_, command)| command).collect();
    assert_eq!(found, ["focus-brush info a.glb", "focus-brush new a.glb -o a.fbrush"]);
}
