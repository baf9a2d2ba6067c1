//! The Blender add-on, tested in a headless bpy if one is available.
//!
//! `FOCUS_BRUSH_BPY` names a Python that has bpy (`pip install bpy` in a virtual environment of Python 3.11);
//! the default is `python3` on the search path. If neither has bpy, the test is skipped with a message.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// A Python with bpy.
fn python() -> Option<PathBuf> {
    let named = std::env::var_os("FOCUS_BRUSH_BPY").map(PathBuf::from);
    let known = ["python3", "python3.11"].map(PathBuf::from);
    named.into_iter().chain(known).find(|python| {
        let asked = Command::new(python)
            .args(["-c", "import bpy"])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .status();
        asked.is_ok_and(|status| status.success())
    })
}

fn passes(script: &str) {
    let Some(python) = python() else {
        eprintln!();
        eprintln!("*** NOT TRIED: {script}. No Python here has bpy. To try the add-on for Blender:");
        eprintln!(
            "***     python3.11 -m venv bpy && bpy/bin/pip install bpy==4.5.15 && export \
             FOCUS_BRUSH_BPY=$PWD/bpy/bin/python"
        );
        eprintln!();
        return;
    };
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/blender");
    let place = tempfile::tempdir().unwrap();
    let done = Command::new(python)
        .arg(folder.join(script))
        .current_dir(&folder)
        .env("FOCUS_BRUSH", env!("CARGO_BIN_EXE_focus-brush"))
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .envs(
            ["XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_CACHE_HOME", "XDG_STATE_HOME"]
                .map(|name| (name, place.path())),
        )
        .output()
        .unwrap();
    let said = [done.stdout, done.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat();
    assert!(done.status.success(), "{script}:\n{said}");
    said.lines()
        .filter(|line| line.contains(" dB") || line.contains(" within ") || line.contains("% of"))
        .for_each(|line| println!("{line}"));
}

#[test]
fn a_scene_goes_over_and_comes_back() {
    passes("test_over_and_back.py");
}

#[test]
fn what_a_render_shows_goes_over() {
    passes("test_shown.py");
}

#[test]
fn the_light_of_cycles_comes_over() {
    passes("test_cycles_light.py");
}

#[test]
fn paint_follows_a_scene_that_changed() {
    passes("test_changed_scene.py");
}
