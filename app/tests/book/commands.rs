//! The page of commands is the program's own help.

use crate::pages::repository;
use crate::program::done;
use std::fmt::Write;

/// The commands, as the program lists them.
fn names(help: &str) -> Vec<String> {
    let listed = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    let listed = listed.take_while(|line| !line.trim().is_empty());
    let names = listed.filter_map(|line| line.split_whitespace().next()).filter(|name| *name != "help");
    names.map(str::to_owned).collect()
}

fn page() -> String {
    let folder = tempfile::tempdir().unwrap();
    let help = done(folder.path(), "--help");
    let mut page = String::from(
        "# Commands\n\nThe output of `focus-brush --help` and `focus-brush COMMAND --help`; file formats are \
         in [Files](files.md).\n",
    );
    let mut section = |title: &str, help: &str| {
        let help: Vec<&str> = help.trim().lines().map(str::trim_end).collect();
        write!(page, "\n## {title}\n\n```text\n{}\n```\n", help.join("\n")).unwrap();
    };
    section("focus-brush", &help);
    for name in names(&help) {
        section(&name, &done(folder.path(), &format!("{name} --help")));
    }
    page
}

/// `UPDATE_BOOK=1 cargo test -p focus-brush --test book` updates it.
#[test]
fn the_page_of_commands_is_the_programs_own_help() {
    let file = repository().join("docs/reference/commands.md");
    let page = page();
    if std::env::var_os("UPDATE_BOOK").is_some() {
        std::fs::write(&file, &page).unwrap();
    }
    let written = std::fs::read_to_string(&file).unwrap_or_default();
    let differs = written.lines().zip(page.lines()).find(|(written, told)| written != told);
    assert!(
        written == page,
        "docs/reference/commands.md is not the program's help: {differs:?} (update it: UPDATE_BOOK=1 cargo \
         test -p focus-brush --test book)"
    );
}
