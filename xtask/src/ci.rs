//! `ci`: all checks, the quick ones first.

use crate::chore::{Failure, cargo, execute};
use crate::packages::{TO_BUILD, TO_RUN, install_missing};
use crate::{crate_directions, licences, module_circles, shared_build};

/// Runs every check and stops at the first that fails.
///
/// # Errors
/// The first check that fails.
pub fn ci() -> Result<(), Failure> {
    install_missing(&[TO_BUILD, TO_RUN])?;
    crate_directions::check()?;
    module_circles::check()?;
    licences::check()?;
    shared_build::check()?;
    execute(cargo("fmt").args(["--all", "--check"]))?;
    execute(cargo("clippy").args(["--workspace", "--all-targets", "--", "-D", "warnings"]))?;
    execute(cargo("doc").args(["--workspace", "--no-deps"]).env("RUSTDOCFLAGS", "-D warnings"))?;
    execute(cargo("test").arg("--workspace"))?;
    println!("all checks passed");
    Ok(())
}
