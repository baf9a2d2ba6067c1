//! The compilers for Windows, and how cargo is told to use them.

use crate::chore::{Failure, copy, output_of};
use crate::package::release::target;
use crate::packages::{TO_BUILD, TO_BUILD_FOR_WINDOWS, has_program, install_missing};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Cargo's name of the system.
const TARGET: &str = "x86_64-pc-windows-gnu";

/// The compilers' libraries that become part of the programs: C++, and the threads that it uses.
const STATIC_LIBRARIES: [&str; 2] = ["libstdc++.a", "libwinpthread.a"];

/// Size of the main thread's stack, bytes: that of Linux. Windows' own would be an eighth of it.
const STACK_BYTES: u32 = 8 << 20;

/// How the package is built.
pub struct WindowsOptions {
    /// Whether to build with the profile of the tests, which is quick.
    pub is_dev: bool,
    /// More arguments of cargo, as for compilers that bring no standard library for Windows (`-Z build-std`).
    pub cargo_arguments: Vec<OsString>,
}

/// The compilers that were found.
pub struct Toolchain {
    c: &'static str,
    cpp: &'static str,
    /// Holds [`STATIC_LIBRARIES`], and nothing that would be loaded at run time.
    libraries: PathBuf,
}

impl Toolchain {
    /// Finds the compilers; on Debian and its derivatives they are installed if they are missing.
    ///
    /// # Errors
    /// Something is missing; the message tells how to get it.
    pub fn find(options: &WindowsOptions) -> Result<Self, Failure> {
        install_missing(&[TO_BUILD, TO_BUILD_FOR_WINDOWS])?;
        let brings_library =
            options.cargo_arguments.iter().any(|a| a.to_string_lossy().contains("build-std"));
        if !brings_library && !has_standard_library() {
            return Err(Failure::new(format!(
                "Rust's standard library for Windows is missing (rustup target add {TARGET}; or, with a compiler that comes with the \
                 library's source: cargo xtask package --windows -- -Z build-std=std,panic_unwind)"
            )));
        }
        // Debian has compilers for two kinds of threads; only those named posix know those of C++.
        let first = |names: [&'static str; 2]| {
            names.into_iter().find(|name| has_program(name)).ok_or_else(|| {
                Failure::new(format!(
                    "{}: the compiler for Windows is missing (install mingw-w64; on Debian: apt-get install \
                     g++-mingw-w64-x86-64-posix)",
                    names[1]
                ))
            })
        };
        let c = first(["x86_64-w64-mingw32-gcc-posix", "x86_64-w64-mingw32-gcc"])?;
        let cpp = first(["x86_64-w64-mingw32-g++-posix", "x86_64-w64-mingw32-g++"])?;
        let libraries = target().join(TARGET).join("static-libraries");
        for library in STATIC_LIBRARIES {
            let printed = output_of(Command::new(cpp).arg(format!("-print-file-name={library}")))?;
            let file = PathBuf::from(String::from_utf8_lossy(&printed).trim());
            if !file.is_absolute() {
                return Err(Failure::new(format!("{cpp} has no {library} (install all of mingw-w64)")));
            }
            copy(&file, &libraries.join(library))?;
        }
        Ok(Self { c, cpp, libraries })
    }

    /// The programs `objdump`, `windres`, … for Windows.
    pub fn tool(&self, name: &str) -> Command {
        Command::new(format!("x86_64-w64-mingw32-{name}"))
    }

    /// Lets this run of cargo build for Windows.
    pub fn apply(&self, cargo: &mut Command) {
        // The linker looks into folders in the order they are given, and here finds no library but the static one.
        let flags = [
            "-Ctarget-feature=+crt-static".into(),
            format!("-Lnative={}", self.libraries.display()),
            "-Clink-arg=-static-libgcc".into(),
            format!("-Clink-arg=-Wl,--no-insert-timestamp,--stack,{STACK_BYTES}"),
            "-Clink-arg=-s".into(),
        ];
        cargo.args(["--target", TARGET]).env("CARGO_ENCODED_RUSTFLAGS", flags.join("\u{1f}"));
        cargo.env("CARGO_TARGET_X86_64_PC_WINDOWS_GNU_LINKER", self.c);
        cargo.env("CC_x86_64_pc_windows_gnu", self.c).env("CXX_x86_64_pc_windows_gnu", self.cpp);
        cargo.env("AR_x86_64_pc_windows_gnu", "x86_64-w64-mingw32-ar");
    }

    /// The folder of the programs that cargo built.
    pub fn built(&self, options: &WindowsOptions) -> PathBuf {
        target().join(TARGET).join(if options.is_dev { "debug" } else { "release" })
    }
}

/// Whether the compiler brings the standard library for Windows.
fn has_standard_library() -> bool {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let printed = output_of(Command::new(rustc).args(["--print", "target-libdir", "--target", TARGET]));
    printed.is_ok_and(|printed| Path::new(String::from_utf8_lossy(&printed).trim()).is_dir())
}
