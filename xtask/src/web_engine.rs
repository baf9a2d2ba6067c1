//! `web-engine`: the program of web pages that visitors paint on, as a WebAssembly module.
//!
//! It comes with the sources (`assets/web-engine`), so that nobody needs a compiler for WebAssembly; this chore builds it anew once what it draws
//! has changed. Rust's standard library for it comes with rustup, or is built with the compiler that Debian has for the web.

use crate::chore::{Failure, cargo, copy, execute, file_failure, output_of, repository};
use crate::package::target;
use crate::packages::has_program;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Rust's name of WebAssembly without a system around it.
const TARGET: &str = "wasm32-unknown-unknown";

/// Debian's compiler for it, with the sources of its standard library.
const DEBIAN: [&str; 5] =
    ["rustc-web", "rust-web-src", "libstd-rust-web-1.96", "libstd-rust-web-dev", "libllvm22"];

/// Builds the module.
///
/// # Errors
/// Arguments, no compiler for WebAssembly, or a step fails.
pub fn web_engine(arguments: &[OsString]) -> Result<(), Failure> {
    let output = match arguments {
        [] => repository().join("assets/web-engine/engine.wasm"),
        [file] => PathBuf::from(file),
        _ => return Err(Failure::new("usage: cargo xtask web-engine [FILE.wasm]")),
    };
    let folder = target().join("web-engine");
    // The type of the crate is chosen here and not in its manifest: files of a `cdylib` have no checksum in their names, so that builds with
    // other features would take each other's place.
    let mut build = cargo("rustc");
    build.args(["--package", "web-engine", "--lib", "--crate-type", "cdylib"]);
    build.args(["--release", "--target", TARGET]).arg("--target-dir").arg(&folder);
    let profile =
        [("LTO", "fat"), ("CODEGEN_UNITS", "1"), ("PANIC", "abort"), ("STRIP", "true"), ("DEBUG", "false")];
    build.envs(profile.map(|(option, value)| (format!("CARGO_PROFILE_RELEASE_{option}"), value)));
    build.env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER", linker()?);
    let mut sources = vec![(repository(), "focus-brush"), (cargo_home(), "cargo")];
    if !has_standard_library() {
        let compiler = debian_compiler(&folder.join("debian"))?;
        build.args(["-Z", "build-std=std,panic_abort"]).env("RUSTC_BOOTSTRAP", "1");
        build.env("RUSTC", compiler.join("usr/bin/rustc"));
        build.env("LD_LIBRARY_PATH", compiler.join("usr/lib/x86_64-linux-gnu"));
        sources.push((compiler, "rust"));
    }
    // No path of this machine gets into the module.
    let remapped = sources.iter().map(|(from, to)| format!("--remap-path-prefix={}={to}", from.display()));
    build.env("CARGO_ENCODED_RUSTFLAGS", remapped.collect::<Vec<_>>().join("\u{1f}"));
    execute(&mut build)?;
    copy(&folder.join(TARGET).join("release/web_engine.wasm"), &output)?;
    println!("{}", output.display());
    Ok(())
}

fn cargo_home() -> PathBuf {
    let home = || std::env::home_dir().unwrap_or_default().join(".cargo");
    std::env::var_os("CARGO_HOME").map_or_else(home, PathBuf::from)
}

/// What the compiler prints of itself, one line.
fn rustc(arguments: &[&str]) -> Result<String, Failure> {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let printed = output_of(Command::new(rustc).args(arguments))?;
    Ok(String::from_utf8_lossy(&printed).trim().to_owned())
}

fn has_standard_library() -> bool {
    rustc(&["--print", "target-libdir", "--target", TARGET]).is_ok_and(|folder| Path::new(&folder).is_dir())
}

/// The linker for WebAssembly that comes with Rust.
fn linker() -> Result<PathBuf, Failure> {
    let host = rustc(&["--print", "target-libdir"])?;
    let linker = Path::new(&host).with_file_name("bin").join("rust-lld");
    if linker.exists() {
        return Ok(linker);
    }
    Err(Failure::new(format!("{}: not there (install Rust by rustup)", linker.display())))
}

/// Debian's compiler for the web, unpacked into `folder`: installed, it would take the place of rustup's.
fn debian_compiler(folder: &Path) -> Result<PathBuf, Failure> {
    if !has_program("apt-get") || !has_program("dpkg-deb") {
        return Err(Failure::new(format!(
            "Rust's standard library for WebAssembly is missing (rustup target add {TARGET})"
        )));
    }
    if folder.join("usr/bin/rustc").exists() {
        return Ok(folder.to_owned());
    }
    std::fs::create_dir_all(folder).map_err(|error| file_failure(folder, &error))?;
    execute(Command::new("apt-get").args(["-q", "download"]).args(DEBIAN).current_dir(folder))?;
    let entries = std::fs::read_dir(folder).map_err(|error| file_failure(folder, &error))?;
    for package in entries
        .flatten()
        .map(|entry| entry.path())
        .filter(|file| file.extension().is_some_and(|e| e == "deb"))
    {
        execute(Command::new("dpkg-deb").arg("-x").arg(&package).arg(folder))?;
        std::fs::remove_file(&package).map_err(|error| file_failure(&package, &error))?;
    }
    Ok(folder.to_owned())
}
