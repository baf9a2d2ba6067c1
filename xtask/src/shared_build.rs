//! The program and its tests must be built from the same dependencies with the same features.
//!
//! A test dependency may enable features of a crate that the program uses, too. That crate and its dependents
//! are then compiled twice, for the program and for its tests, which takes minutes for the window. Features
//! that test dependencies need are therefore enabled for the program as well.

use crate::chore::{Failure, cargo, output_of};
use std::collections::BTreeSet;

/// Checks the workspace.
///
/// # Errors
/// A crate is built with other features for the tests, or `cargo tree` fails.
pub fn check() -> Result<(), Failure> {
    let (program, with_tests) = (crates("normal,build")?, crates("normal,build,dev")?);
    let twice = built_twice(&program, &with_tests);
    if twice.is_empty() {
        return Ok(());
    }
    Err(Failure::new(format!(
        "the tests of focus-brush build these once more, with other features (turn those on in \
         Cargo.toml):\n  {}",
        twice.join("\n  ")
    )))
}

/// The dependencies of focus-brush by edges of these kinds, one line each: name, version, features.
fn crates(edges: &str) -> Result<String, Failure> {
    let arguments =
        ["-p", "focus-brush", "-e", edges, "--prefix", "none", "--no-dedupe", "-f", "{p} {f}", "--locked"];
    let listed = output_of(cargo("tree").args(arguments))?;
    Ok(String::from_utf8_lossy(&listed).into_owned())
}

/// Lines of the program that are not among those of its tests.
fn built_twice<'a>(program: &'a str, tests: &str) -> Vec<&'a str> {
    let shared: BTreeSet<_> = tests.lines().collect();
    let own: BTreeSet<_> = program.lines().filter(|line| !shared.contains(line)).collect();
    own.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_program_and_its_tests_share_their_dependencies() {
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
