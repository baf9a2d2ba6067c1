//! `lint`: all checks that run no tests, the quick ones first; `ci`: these, and the tests.

use crate::chore::{Failure, cargo, execute};
use crate::packages::{TO_BUILD, TO_RUN, install_missing};
use crate::{
    architecture_paths, crate_directions, figures, licences, module_circles, shared_build, spelling,
};

/// Runs every check and all tests, and stops at the first that fails.
///
/// # Errors
/// The first check that fails.
pub fn ci() -> Result<(), Failure> {
    lint()?;
    execute(cargo("test").arg("--workspace"))?;
    println!("all checks passed");
    Ok(())
}

/// Runs every check but the tests, and stops at the first that fails.
///
/// # Errors
/// The first check that fails.
pub fn lint() -> Result<(), Failure> {
    install_missing(&[TO_BUILD, TO_RUN])?;
    crate_directions::check()?;
    architecture_paths::check()?;
    module_circles::check()?;
    licences::check()?;
    shared_build::check()?;
    figures::figures(&["--check".into()])?;
    spelling::check()?;
    execute(cargo("fmt").args(["--all", "--check"]))?;
    execute(cargo("clippy").args(["--workspace", "--all-targets", "--", "-D", "warnings"]))?;
    execute(cargo("doc").args(["--workspace", "--no-deps"]).env("RUSTDOCFLAGS", "-D warnings"))
}
