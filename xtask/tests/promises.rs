//! The short forms of the promises, on the program that was built beside this chore.

use std::path::PathBuf;
use std::process::Command;
use std::sync::Mutex;

/// One promise at a time: each uses all cores, and some measure.
static TURN: Mutex<()> = Mutex::new(());

fn keeps(promise: &str) {
    let chore = PathBuf::from(env!("CARGO_BIN_EXE_xtask"));
    let program = chore.with_file_name("focus-brush");
    if !program.exists() {
        eprintln!("SKIPPED {promise}: there is no {} (cargo test --workspace builds it)", program.display());
        return;
    }
    let _turn = TURN.lock().unwrap_or_else(|broken| broken.into_inner());
    let mut command = Command::new(chore);
    command
        .args(["endure", promise])
        .env("FOCUS_BRUSH", program)
        .env("CARGO_MANIFEST_DIR", env!("CARGO_MANIFEST_DIR"));
    let output = command.output().unwrap();
    let (stdout, stderr) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    eprint!("{stdout}{stderr}");
    assert!(output.status.success(), "{promise}:\n{stdout}{stderr}");
}

#[test]
fn bombs_are_refused() {
    keeps("bombs");
}

#[test]
fn malformed_input_is_refused() {
    keeps("malformed");
}

#[test]
fn saving_destroys_nothing() {
    keeps("faults");
}

#[test]
fn no_file_outside_the_folder_is_opened() {
    keeps("outside");
}

#[test]
fn the_split_does_not_show() {
    keeps("same-bytes");
}

#[test]
fn a_file_has_one_writer() {
    keeps("one-writer");
}

#[test]
fn poor_surroundings_are_told() {
    keeps("surroundings");
}

#[test]
fn memory_has_a_limit() {
    keeps("memory");
}

#[test]
fn old_files_open() {
    keeps("old-files");
}

#[test]
fn a_crash_loses_little() {
    keeps("crash");
}

#[test]
fn unwrapping_ends() {
    keeps("unwrapping");
}

#[test]
fn processor_and_card_give_the_same_bits() {
    keeps("same-bits");
}

#[test]
fn a_lost_card_loses_nothing() {
    keeps("lost-card");
}

#[test]
fn undo_is_exact() {
    keeps("undo");
}

#[test]
fn the_window_stays() {
    keeps("window");
}
