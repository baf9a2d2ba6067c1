//! The program, its tests and the whole workspace must be built from the same dependencies with the same features.
//!
//! A test dependency, or another crate of the workspace, may enable features of a crate that the program uses, too. That crate and its
//! dependents are then compiled twice, which takes minutes for the window: for the program and for its tests, or for `--workspace` and for
//! `--package focus-brush`. Features that others need are therefore enabled for the program as well.

use crate::chore::{Failure, cargo, output_of};
use std::collections::BTreeSet;

/// Checks the workspace.
///
/// # Errors
/// A crate is built with other features for the tests or the workspace, or `cargo tree` fails.
pub fn check() -> Result<(), Failure> {
    let program = crates(&["--package", "focus-brush", "-e", "normal,build"])?;
    let with_tests = crates(&["--package", "focus-brush", "-e", "normal,build,dev"])?;
    let workspace = crates(&["--workspace", "-e", "normal,build,dev"])?;
    for (larger, name) in [(&with_tests, "the tests of focus-brush"), (&workspace, "the whole workspace")] {
        let twice = built_twice(&program, larger);
        if !twice.is_empty() {
            return Err(Failure::new(format!(
                "{name} need these built once more, with other features (turn those on in Cargo.toml):\n  {}",
                twice.join("\n  ")
            )));
        }
    }
    Ok(())
}

/// The dependencies of these packages by these edges, one line each: name, version, features.
fn crates(of: &[&str]) -> Result<String, Failure> {
    let arguments = ["--prefix", "none", "--no-dedupe", "-f", "{p} {f}", "--locked"];
    let listed = output_of(cargo("tree").args(of).args(arguments))?;
    Ok(String::from_utf8_lossy(&listed).into_owned())
}

/// Lines of the program that are not among those of what is larger than it.
fn built_twice<'a>(program: &'a str, larger: &str) -> Vec<&'a str> {
    let shared: BTreeSet<_> = larger.lines().collect();
    let own: BTreeSet<_> = program.lines().filter(|line| !shared.contains(line)).collect();
    own.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_program_its_tests_and_the_workspace_share_their_dependencies() {
        check().unwrap_or_else(|failure| panic!("{failure}"));
    }

    #[test]
    fn a_feature_more_is_found() {
        let program = "egui v0.37.0 serde\nwgpu v30.0.1 std,wgsl\n";
        let tests = "egui v0.37.0 serde\nkittest v0.4.0 \nwgpu v30.0.1 gles,std,wgsl\n";
        assert_eq!(built_twice(program, tests), ["wgpu v30.0.1 std,wgsl"]);
        assert_eq!(built_twice(program, program), Vec::<&str>::new());
    }
}
