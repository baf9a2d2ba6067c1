//! `package`: packages for users without a compiler, and a source archive that builds without a network.
//!
//! ```text
//! cargo build --release ─▶ layout ─┬▶ deb      focus-brush_VERSION_ARCH.deb
//!                                  └▶ tarball  focus-brush-VERSION-linux-ARCH.tar.xz
//! git, cargo vendor ────────────────▶ source   focus-brush-VERSION-source.tar.xz
//! cargo rustc --target … ───────────▶ windows  focus-brush-VERSION-windows-x86_64.zip
//! ```
//!
//! Builds are reproducible: the same commit, compiler and system libraries give the same bytes. Times in
//! archives are the commit's.

mod deb;
mod layout;
mod release;
mod source;
mod staging;
mod tarball;
mod windows;

use crate::chore::{Failure, cargo, execute};
use crate::packages::{TO_BUILD, TO_PACKAGE, install_missing};
use release::Release;
pub use release::target;
use std::ffi::OsString;
use std::path::PathBuf;
use windows::WindowsOptions;

/// Builds the named packages, `deb`, `tarball` or `source`; all of them if none is named. With `--windows`, builds the one for Windows.
///
/// # Errors
/// An unknown kind of package, or one that cannot be made.
pub fn package(kinds: &[OsString]) -> Result<(), Failure> {
    if let Some(("--windows", options)) = kinds.split_first().and_then(|(a, b)| Some((a.to_str()?, b))) {
        print_package(windows::make(&Release::of_commit()?, &windows_options(options)?)?);
        return Ok(());
    }
    const KINDS: [&str; 3] = ["deb", "tarball", "source"];
    if let Some(other) = kinds.iter().find(|kind| !KINDS.iter().any(|supported| kind == supported)) {
        return Err(Failure::new(format!(
            "{}: no package (there are {})",
            other.display(),
            KINDS.join(", ")
        )));
    }
    let is_selected = |kind: &str| kinds.is_empty() || kinds.iter().any(|selected| selected == kind);
    install_missing(&[TO_BUILD, TO_PACKAGE])?;
    let release = Release::of_commit()?;
    if is_selected("deb") || is_selected("tarball") {
        execute(cargo("build").args(["--release", "--package", "focus-brush"]))?;
        let program = target().join("release/focus-brush");
        if is_selected("deb") {
            print_package(deb::make(&release, &program)?);
        }
        if is_selected("tarball") {
            print_package(tarball::make(&release, &program)?);
        }
    }
    if is_selected("source") {
        print_package(source::make(&release)?);
    }
    Ok(())
}

/// What stands behind `--windows`: `--dev`, then `--` and arguments for cargo.
fn windows_options(arguments: &[OsString]) -> Result<WindowsOptions, Failure> {
    let separator = arguments.iter().position(|argument| argument == "--");
    let (own, cargo) = arguments.split_at(separator.unwrap_or(arguments.len()));
    match own {
        [] => (),
        [only] if only == "--dev" => (),
        _ => return Err(Failure::new("usage: cargo xtask package --windows [--dev] [-- ARG…]")),
    }
    Ok(WindowsOptions { is_dev: !own.is_empty(), cargo_arguments: cargo.iter().skip(1).cloned().collect() })
}

fn print_package(package: PathBuf) {
    let size = std::fs::metadata(&package).map_or(0, |data| data.len());
    println!("{} ({} MiB)", package.display(), size.div_ceil(1 << 20));
}
