//! `package`: what people install who have no compiler, and a source archive that builds without a network.
//!
//! ```text
//! cargo build --release ─▶ layout ─┬▶ deb      focus-brush_VERSION_ARCH.deb
//!                                  └▶ tarball  focus-brush-VERSION-linux-ARCH.tar.xz
//! git, cargo vendor ────────────────▶ source   focus-brush-VERSION-source.tar.xz
//! ```
//!
//! Of the same commit, compiler and system libraries come the same bytes: times in archives are the commit's.

mod deb;
mod layout;
mod source;
mod staging;
mod tarball;

use crate::chore::{Failure, cargo, execute, output_of, repository};
use crate::packages::{TO_BUILD, TO_PACKAGE, install_missing};
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::Command;

/// What is packaged.
struct Release {
    version: String,
    /// Seconds since 1970 that everything in archives is as old as: the commit's.
    time: String,
    /// Where packages go.
    output: PathBuf,
}

impl Release {
    fn of_commit() -> Result<Self, Failure> {
        let output = target().join("package");
        std::fs::create_dir_all(&output).map_err(|e| Failure::new(format!("{}: {e}", output.display())))?;
        let time = output_of(git().args(["log", "-1", "--format=%ct"]))?;
        Ok(Self {
            version: env!("CARGO_PKG_VERSION").into(),
            time: String::from_utf8_lossy(&time).trim().into(),
            output,
        })
    }
}

/// Makes the packages that are named, `deb`, `tarball` or `source`; all of them where none is.
pub fn package(kinds: &[OsString]) -> Result<(), Failure> {
    const KINDS: [&str; 3] = ["deb", "tarball", "source"];
    if let Some(other) = kinds.iter().find(|kind| !KINDS.iter().any(|known| kind == known)) {
        return Err(Failure::new(format!(
            "{}: no package (there are {})",
            other.display(),
            KINDS.join(", ")
        )));
    }
    let is_wanted = |kind: &str| kinds.is_empty() || kinds.iter().any(|wanted| wanted == kind);
    install_missing(&[TO_BUILD, TO_PACKAGE])?;
    let release = Release::of_commit()?;
    if is_wanted("deb") || is_wanted("tarball") {
        execute(cargo("build").args(["--release", "--package", "focus-brush"]))?;
        let program = target().join("release/focus-brush");
        if is_wanted("deb") {
            told(deb::make(&release, &program)?);
        }
        if is_wanted("tarball") {
            told(tarball::make(&release, &program)?);
        }
    }
    if is_wanted("source") {
        told(source::make(&release)?);
    }
    Ok(())
}

fn told(package: PathBuf) {
    let size = std::fs::metadata(&package).map_or(0, |data| data.len());
    println!("{} ({} MiB)", package.display(), size.div_ceil(1 << 20));
}

fn git() -> Command {
    let mut command = Command::new("git");
    command.arg("-C").arg(repository());
    command
}

fn target() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| repository().join("target"), PathBuf::from)
}
