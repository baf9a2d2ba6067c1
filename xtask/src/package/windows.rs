//! The package for Windows: a zip that runs from wherever it is unpacked.
//!
//! ```text
//! cargo rustc --target x86_64-pc-windows-gnu ─▶ focus-brush.exe, focus-brush-window.exe ─▶ imports ─▶ …windows-x86_64.zip
//! resources (icon, manifest) ─────────────────┘
//! ```
//!
//! The programs are built by the GNU compilers for Windows (mingw-w64), on Linux or Windows. They contain what they need of those
//! compilers' libraries; of the system they load its own libraries alone, which `imports` checks.

mod imports;
mod resources;
mod toolchain;

use super::layout::{BOOK, Installed, SHARED};
use super::release::Release;
use super::staging::{empty_folder, write};
use crate::chore::{Failure, cargo, copy, execute, file_failure, repository};
use crate::zip_archive::{Entry, write_zip};
use std::path::{Path, PathBuf};
use toolchain::Toolchain;
pub use toolchain::WindowsOptions;

/// A program of the package.
struct Program {
    package: &'static str,
    name: &'static str,
    /// Its folder in the package.
    folder: &'static str,
}

const PROGRAMS: [Program; 2] = [
    Program { package: "focus-brush", name: "focus-brush.exe", folder: "bin" },
    Program { package: "window-launcher", name: "focus-brush-window.exe", folder: "" },
];

/// The texts of the package, in `assets/windows`.
const TEXTS: [&str; 3] = ["READ_ME_FIRST.txt", "register.cmd", "unregister.cmd"];

/// Builds the package.
///
/// # Errors
/// A compiler or the standard library for Windows is missing, a step fails, or a program needs libraries that are not Windows' own.
pub fn make(release: &Release, options: &WindowsOptions) -> Result<PathBuf, Failure> {
    let toolchain = Toolchain::find(options)?;
    let name = format!("focus-brush-{}-windows-x86_64", release.version);
    let folder = empty_folder(release, &name)?;
    let resources = resources::compile(&toolchain, release, &empty_folder(release, "windows-resources")?)?;
    for Program { package, name, folder: below } in PROGRAMS {
        let mut build = cargo("rustc");
        build.args(["--package", package, "--bin", name.trim_end_matches(".exe")]);
        build.args(["--profile", if options.is_dev { "dev" } else { "release" }]);
        toolchain.apply(&mut build);
        build.args(&options.cargo_arguments).arg("--").arg(format!("-Clink-arg={}", resources.display()));
        execute(&mut build)?;
        let built = toolchain.built(options).join(name);
        imports::check(&toolchain, &built)?;
        copy(&built, &folder.join(below).join(name))?;
    }
    for Installed { from, to } in SHARED.iter().filter(|installed| !installed.from.contains("desktop")) {
        copy(&repository().join(from), &folder.join(to))?;
    }
    crate::book::write(&folder.join(BOOK))?;
    for text in TEXTS {
        let file = repository().join("assets/windows").join(text);
        let lines = std::fs::read_to_string(&file).map_err(|error| file_failure(&file, &error))?;
        write(&folder.join(text), &lines.replace("\r\n", "\n").replace('\n', "\r\n"))?;
    }
    let archive = release.output.join(format!("{name}.zip"));
    let mut entries = Vec::new();
    collect(&folder, &name, &mut entries)?;
    write_zip(&archive, entries)?;
    Ok(archive)
}

/// All files below a folder, sorted by name, at `path` in the archive.
fn collect(folder: &Path, path: &str, entries: &mut Vec<Entry>) -> Result<(), Failure> {
    let failed = |error: std::io::Error| file_failure(folder, &error);
    let mut files: Vec<PathBuf> = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        files.push(entry.map_err(failed)?.path());
    }
    files.sort();
    for file in files {
        let path = format!("{path}/{}", file.file_name().unwrap_or_default().to_string_lossy());
        if file.is_dir() {
            collect(&file, &path, entries)?;
        } else {
            let bytes = std::fs::read(&file).map_err(|error| file_failure(&file, &error))?;
            entries.push(Entry { path, bytes });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_texts_are_there_and_name_what_is_packed() {
        for text in TEXTS {
            let lines = std::fs::read_to_string(repository().join("assets/windows").join(text)).expect(text);
            // Console programs of Windows read texts in many encodings.
            assert!(lines.is_ascii(), "{text}");
            assert!(text == "unregister.cmd" || lines.contains(PROGRAMS[1].name), "{text}");
        }
    }

    #[test]
    fn what_is_registered_is_unregistered() {
        let read =
            |name: &str| std::fs::read_to_string(repository().join("assets/windows").join(name)).expect(name);
        let keys = |script: &str, verb: &str| {
            let lines = script.lines().filter_map(|line| line.strip_prefix(verb)?.split('"').nth(1));
            lines.map(str::to_owned).collect::<Vec<String>>()
        };
        let (added, deleted) =
            (keys(&read("register.cmd"), "reg add "), keys(&read("unregister.cmd"), "reg delete "));
        assert!(added.len() >= 9 && deleted.len() >= 5);
        for key in added {
            let is_deleted =
                deleted.iter().any(|other| key == *other || key.starts_with(&format!("{other}\\")));
            assert!(is_deleted, "{key}");
        }
    }
}
