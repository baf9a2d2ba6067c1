//! `cargo xtask CHORE`: the chores of a developer.
//!
//! * `run [FILE…]` installs what is missing, builds `focus-brush` and opens it; without a display it renders
//!   the demo to a picture.
//! * `test [ARG…]` installs what is missing and runs the whole test suite.
//! * `window` drives the real window with mouse and keyboard, under Xvfb.
//! * `endure [--full] [PROMISE…]` tries promises of the program by number: bombs, damaged files, faults, races.
//! * `circles [CRATE…]` lists cyclic dependencies between modules of a crate; there must be none.
//! * `ci` runs all checks: crate directions, module cycles, licences, formatting, lints, docs, tests.
//! * `package` builds packages for users without a compiler, and a source archive that builds without a
//!   network.
//! * `wheel` builds the Python package.
//! * `web-engine` builds the program of web pages that visitors paint on.
//! * `book [FOLDER]` writes the book as HTML pages.
//! * `demo` regenerates the demo scene in `assets/demo`.
//! * `figures` writes the tables and plots of the performance pages from `docs/figures`.
//!
//! Pure Rust without build scripts of its own, so that it needs nothing but Rust and a C linker.

mod architecture_paths;
mod book;
mod chore;
mod ci;
mod crate_directions;
mod demo;
#[cfg(target_os = "linux")]
mod endure;
mod figures;
mod licences;
mod module_circles;
mod package;
mod packages;
mod run;
mod shared_build;
mod spelling;
mod web_engine;
mod wheel;
mod zip_archive;

use chore::Failure;

const USAGE: &str = "\
usage: cargo xtask CHORE

  run [FILE…]   install what is missing, build focus-brush and open it
                (with no display: render the demo to a picture)
  test [ARG…]   install what is missing and run all tests; ARGs go to cargo test
  package [deb|tarball|source…]
                packages to install, a folder that runs from anywhere, a source archive that
                builds without a network; in target/package
  package --windows [--dev] [-- ARG…]
                a zip for Windows, built with mingw-w64; ARGs go to cargo (--dev: from the quick
                build of the tests)
  wheel [--dev] the Python package, for CPython 3.10 and newer; in target/package
                (--dev: from the quick build of the tests)
  web-engine [FILE.wasm]
                the program of web pages that visitors paint on, as a WebAssembly module; into
                assets/web-engine
  book [FOLDER] write the book as HTML pages; into target/book
  demo          regenerate the demo scene in assets/demo
  figures [--check]
                write the tables and plots of the performance pages from docs/figures
  window [ARG…] drive the real window under Xvfb, with a screenshot of every step
  endure [--full] [PROMISE…]
                keep promises by number: bombs, damaged files, faults, races …; --full
                continues the full counts, kept in docs/promises.json
  circles [CRATE…]
                cyclic dependencies between the modules of a crate, with the names that cause them
  lint          crate directions, paths in ARCHITECTURE.md, module cycles, licences, figures,
                spelling, formatting, lints, docs
  ci            these, and all tests";

/// The argument of `demo`: rays per texel, fewer for drafts.
fn sky_rays(arguments: &[std::ffi::OsString]) -> usize {
    arguments.first().and_then(|a| a.to_str()?.parse().ok()).unwrap_or(80)
}

fn main() -> std::process::ExitCode {
    let mut arguments = std::env::args_os().skip(1);
    let chore = arguments.next().map(|a| a.to_string_lossy().into_owned()).unwrap_or_default();
    let rest: Vec<_> = arguments.collect();
    let outcome = match chore.as_str() {
        "run" => run::run(&rest),
        "test" => run::test(&rest),
        "window" => run::window(&rest),
        "circles" => module_circles::circles(&rest),
        "package" => package::package(&rest),
        "wheel" => wheel::wheel(&rest),
        "web-engine" => web_engine::web_engine(&rest),
        "lint" => ci::lint(),
        "ci" => ci::ci(),
        #[cfg(target_os = "linux")]
        "endure" => endure::endure(&rest),
        #[cfg(not(target_os = "linux"))]
        "endure" => {
            eprintln!(
                "SKIPPED: promises are measured through /proc, prlimit and strace, which only Linux has"
            );
            Ok(())
        }
        "book" => book::write(&rest.first().map_or_else(book::default_folder, Into::into)),
        "demo" => demo::demo(sky_rays(&rest)),
        "figures" => figures::figures(&rest),
        "" | "help" | "-h" | "--help" => {
            println!("{USAGE}");
            Ok(())
        }
        other => Err(Failure::new(format!("{other}: there is no such chore\n\n{USAGE}"))),
    };
    match outcome {
        Ok(()) => std::process::ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("error: {failure}");
            std::process::ExitCode::from(failure.exit_code())
        }
    }
}
