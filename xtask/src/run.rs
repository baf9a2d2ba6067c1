//! `run` opens the program on the demo or on files; `test` runs all tests; `window` drives the real window.

use crate::book;
use crate::chore::{Failure, cargo, execute, repository};
use crate::packages::{TO_ACT, TO_BUILD, TO_ENDURE, TO_RUN, install_missing};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Builds and opens `focus-brush` with these arguments. Without a display, if the arguments are only files,
/// renders them (or the demo) to pictures instead.
///
/// # Errors
/// A package cannot be installed, or the build or the program fails.
pub fn run(arguments: &[OsString]) -> Result<(), Failure> {
    install_missing(&[TO_BUILD, TO_RUN])?;
    let is_file = |argument: &OsString| Path::new(argument).exists();
    if has_display() {
        book::write(&book::default_folder())?;
    }
    if has_display() || !arguments.iter().all(is_file) {
        return focus_brush(arguments);
    }
    if arguments.is_empty() {
        return render("demo", &repository().join("assets/demo/demo.fbrush"));
    }
    for file in arguments {
        let stem = Path::new(file).file_stem().unwrap_or(file).to_string_lossy();
        render(&stem, Path::new(file))?;
    }
    Ok(())
}

/// Runs the whole test suite; the arguments go to `cargo test`.
///
/// # Errors
/// A package cannot be installed, or a test fails.
pub fn test(arguments: &[OsString]) -> Result<(), Failure> {
    install_missing(&[TO_BUILD, TO_RUN, TO_ENDURE])?;
    execute(cargo("test").arg("--workspace").args(arguments))
}

/// Drives the real window with mouse and keyboard on a virtual display and saves a screenshot of every step;
/// the arguments go to the script.
///
/// # Errors
/// A package cannot be installed, or the build or the script fails.
pub fn window(arguments: &[OsString]) -> Result<(), Failure> {
    install_missing(&[TO_BUILD, TO_RUN, TO_ACT])?;
    let program = build_focus_brush()?;
    let script = repository().join("tests/window/real_window.sh");
    execute(Command::new("bash").arg(script).args(arguments).env("FOCUS_BRUSH", program))
}

fn render(stem: &str, file: &Path) -> Result<(), Failure> {
    let folder = repository().join("target/pictures");
    std::fs::create_dir_all(&folder).map_err(|e| Failure::new(format!("{}: {e}", folder.display())))?;
    let picture = folder.join(format!("{stem}.png"));
    eprintln!("There is no display here: rendering {stem} to a picture.");
    let picture_file = picture.clone().into_os_string();
    focus_brush(&["render".into(), file.into(), "-o".into(), picture_file])?;
    println!("The picture is {}", picture.display());
    Ok(())
}

/// Builds the program and runs it with these arguments.
///
/// # Errors
/// The build or the program fails.
pub fn focus_brush(arguments: &[OsString]) -> Result<(), Failure> {
    execute(Command::new(build_focus_brush()?).args(arguments))
}

/// Builds the program. Returns its path.
///
/// # Errors
/// The build fails.
pub fn build_focus_brush() -> Result<PathBuf, Failure> {
    execute(cargo("build").args(["--package", "focus-brush"]))?;
    let target =
        std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| repository().join("target"), PathBuf::from);
    Ok(target.join("debug/focus-brush"))
}

fn has_display() -> bool {
    let set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    !cfg!(target_os = "linux") || set("DISPLAY") || set("WAYLAND_DISPLAY")
}
