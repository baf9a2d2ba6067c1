//! `wheel`: the Python package `focus_brush`, as a file that pip installs.
//!
//! ```text
//! cargo build -p python ─▶ libfocus_brush_native.so ─▶ strip ─┬▶ archive  focus_brush-VERSION-cp310-abi3-manylinux_…whl
//! crates/python/focus_brush ──────────────────────────────────┘            (with metadata, RECORD)
//! ```
//!
//! One wheel serves every CPython from 3.10 on: the module uses Python's stable interface only. Neither Python nor pip is needed to
//! build it. The same commit, compiler and system libraries give the same bytes.

mod archive;
mod platform_tag;

use crate::chore::{Failure, cargo, copy, execute, file_failure, repository};
use crate::package::target;
use crate::packages::{TO_BUILD, install_missing};
use crate::zip_archive::Entry;
use archive::write_archive;
use platform_tag::platform_tag;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The package's files of text, in `crates/python/focus_brush`.
const FILES: [&str; 4] = ["__init__.py", "__init__.pyi", "_unwrap.py", "py.typed"];

/// The module in the package.
const MODULE: &str = "_native.abi3.so";

/// The versions of Python that it is for, as in the wheel's name.
const PYTHON_TAG: &str = "cp310-abi3";

/// The largest wheel, bytes: package indices and extensions of Blender take no more without asking.
const LARGEST_WHEEL: u64 = 25 << 20;

const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Builds the wheel; with `--dev` from the profile of the tests, which builds quickly.
///
/// # Errors
/// Another argument, a system without wheels of ours, or a step fails.
pub fn wheel(arguments: &[OsString]) -> Result<(), Failure> {
    let is_dev = match arguments {
        [] => false,
        [only] if only == "--dev" => true,
        _ => return Err(Failure::new("usage: cargo xtask wheel [--dev]")),
    };
    if !cfg!(target_os = "linux") {
        return Err(Failure::new("wheels are built on Linux (use a Linux machine, or a container)"));
    }
    install_missing(&[TO_BUILD])?;
    let profile = if is_dev { "dev" } else { "release" };
    execute(cargo("build").args(["--package", "python", "--profile", profile]))?;
    let built = target().join(if is_dev { "debug" } else { "release" }).join("libfocus_brush_native.so");
    let folder = target().join("package");
    let module = folder.join(MODULE);
    copy(&built, &module)?;
    execute(Command::new("strip").arg("--strip-unneeded").arg(&module))?;
    let wheel = pack(&folder, &module)?;
    std::fs::remove_file(&module).map_err(|error| file_failure(&module, &error))?;
    let bytes = std::fs::metadata(&wheel).map_or(0, |data| data.len());
    if bytes > LARGEST_WHEEL {
        return Err(Failure::new(format!("{}: {bytes} bytes, more than {LARGEST_WHEEL}", wheel.display())));
    }
    println!("{} ({:.1} MiB)", wheel.display(), bytes as f64 / f64::from(1 << 20));
    Ok(())
}

/// Packs the wheel with this module into `folder`.
fn pack(folder: &Path, module: &Path) -> Result<PathBuf, Failure> {
    let read = |file: &Path| std::fs::read(file).map_err(|error| file_failure(file, &error));
    let module = read(module)?;
    let tag = format!("{PYTHON_TAG}-{}", platform_tag(&module)?);
    let sources = repository().join("crates/python/focus_brush");
    let info = format!("focus_brush-{VERSION}.dist-info");
    let mut entries = Vec::new();
    for name in FILES {
        entries.push(Entry { path: format!("focus_brush/{name}"), bytes: read(&sources.join(name))? });
    }
    entries.push(Entry { path: format!("focus_brush/{MODULE}"), bytes: module });
    for name in ["LICENSE-APACHE", "LICENSE-MIT"] {
        let bytes = read(&repository().join(name))?;
        entries.push(Entry { path: format!("{info}/licenses/{name}"), bytes });
    }
    let readme = read(&repository().join("crates/python/README.md"))?;
    let metadata = [metadata().into_bytes(), readme].concat();
    entries.push(Entry { path: format!("{info}/METADATA"), bytes: metadata });
    entries.push(Entry { path: format!("{info}/WHEEL"), bytes: wheel_file(&tag).into_bytes() });
    let wheel = folder.join(format!("focus_brush-{VERSION}-{tag}.whl"));
    write_archive(&wheel, entries, &format!("{info}/RECORD"))?;
    Ok(wheel)
}

/// The head of METADATA ("Core metadata specifications" of the Python Packaging User Guide); the description follows.
fn metadata() -> String {
    format!(
        "Metadata-Version: 2.1\n\
         Name: focus-brush\n\
         Version: {VERSION}\n\
         Summary: Decide for every point of a 3D scene how it is focused, and render it\n\
         License: MIT OR Apache-2.0\n\
         License-File: LICENSE-APACHE\n\
         License-File: LICENSE-MIT\n\
         Classifier: Operating System :: POSIX :: Linux\n\
         Classifier: Programming Language :: Python :: 3\n\
         Classifier: Programming Language :: Rust\n\
         Classifier: Topic :: Multimedia :: Graphics :: 3D Rendering\n\
         Classifier: Typing :: Typed\n\
         Requires-Python: >=3.10\n\
         Requires-Dist: numpy>=1.23\n\
         Description-Content-Type: text/markdown\n\n"
    )
}

/// WHEEL ("Binary distribution format").
fn wheel_file(tag: &str) -> String {
    format!("Wheel-Version: 1.0\nGenerator: xtask ({VERSION})\nRoot-Is-Purelib: false\nTag: {tag}\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_of_the_package_is_packed() {
        let folder = repository().join("crates/python/focus_brush");
        let names = std::fs::read_dir(&folder).expect("the package").flatten();
        for name in names.map(|entry| entry.file_name()).filter(|name| name != "__pycache__") {
            assert!(FILES.iter().any(|file| *file == name), "{name:?} is not in the wheel");
        }
    }

    #[test]
    fn metadata_ends_with_an_empty_line() {
        let metadata = metadata();
        assert!(metadata.ends_with("markdown\n\n"));
        let fields = metadata.lines().take_while(|line| !line.is_empty());
        fields.for_each(|field| assert!(field.contains(": ") && !field.starts_with(' '), "{field}"));
    }
}
