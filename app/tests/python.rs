//! The Python module, tested from Python: `crates/python/tests`.
//!
//! `FOCUS_BRUSH_PYTHON` names a Python of 3.10 or newer that has NumPy; the default is `python3` of the system (Debian's package
//! `python3-numpy`) or of the search path. If none has NumPy, the tests are skipped with a message. What needs `mypy` is skipped
//! where it is missing.

#[path = "../../crates/session/tests/tiny_glb/mod.rs"]
#[allow(dead_code, reason = "shared by several tests")]
mod tiny_glb;

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// A Python with NumPy.
fn python() -> Option<PathBuf> {
    let named = std::env::var_os("FOCUS_BRUSH_PYTHON").map(PathBuf::from);
    let usual = ["/usr/bin/python3", "python3"].map(PathBuf::from);
    named.into_iter().chain(usual).find(|python| {
        let check = "import sys, numpy; sys.exit(sys.version_info < (3, 10))";
        let checked =
            Command::new(python).args(["-c", check]).stdout(Stdio::null()).stderr(Stdio::null()).status();
        checked.is_ok_and(|status| status.success())
    })
}

/// The package as a wheel installs it, in `folder`: built with the dependencies of the program, which are built already.
fn install_package(folder: &Path) {
    let program = Path::new(env!("CARGO_BIN_EXE_focus-brush"));
    let built = program.parent().unwrap();
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut build = Command::new(cargo);
    build.args([
        "build",
        "--quiet",
        "--package",
        "python",
        "--package",
        "focus-brush",
        "--lib",
        "--target-dir",
    ]);
    build.arg(built.parent().unwrap()).current_dir(env!("CARGO_MANIFEST_DIR"));
    if built.ends_with("release") {
        build.arg("--release");
    }
    assert!(build.status().unwrap().success(), "the module does not build");
    let package = folder.join("focus_brush");
    std::fs::create_dir(&package).unwrap();
    let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates/python/focus_brush");
    for entry in std::fs::read_dir(sources).unwrap().map(Result::unwrap) {
        if entry.file_type().unwrap().is_file() {
            std::fs::copy(entry.path(), package.join(entry.file_name())).unwrap();
        }
    }
    std::fs::copy(built.join("libfocus_brush_native.so"), package.join("_native.abi3.so")).unwrap();
}

#[test]
#[cfg_attr(not(target_os = "linux"), ignore = "the module is built on Linux")]
fn the_module_passes_its_tests() {
    let Some(python) = python() else {
        eprintln!("\n*** NOT TRIED: the Python module. No Python here has NumPy. To try it:");
        eprintln!("***     sudo apt install python3-numpy mypy   (or name one by FOCUS_BRUSH_PYTHON)\n");
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    install_package(folder.path());
    let scene = folder.path().join("scene.glb");
    tiny_glb::write(&scene);
    let tests = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates/python/tests");
    let done = Command::new(python)
        .args(["-m", "unittest", "discover", "--start-directory"])
        .arg(&tests)
        .current_dir(folder.path())
        .env("PYTHONPATH", folder.path())
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .env("FOCUS_BRUSH", env!("CARGO_BIN_EXE_focus-brush"))
        .env("FOCUS_BRUSH_SCENE", &scene)
        .env("XDG_CACHE_HOME", folder.path().join("cache"))
        .status()
        .unwrap();
    assert!(done.success(), "see the messages above");
}
