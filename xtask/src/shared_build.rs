//! The program and its tests are built from the same dependencies: same crates, same features.
//!
//! A test tool may turn on features of a crate that the program uses too. Then that crate, and all above it, are
//! compiled twice, once for the program and once for its tests: minutes, for the window. So features that the
//! tools of the tests want are turned on for the program as well.

use crate::chore::{Failure, cargo, output_of};
use std::collections::BTreeSet;

/// Checks the workspace as it is.
pub fn check() -> Result<(), Failure> {
    let (program, with_tests) = (crates("normal,build")?, crates("normal,build,dev")?);
    let twice = built_twice(&program, &with_tests);
    if twice.is_empty() {
        return Ok(());
    }
    Err(Failure::new(format!(
        "the tests of focus-brush build these once more, with other features (turn those on in Cargo.toml):\n  {}",
        twice.join("\n  ")
    )))
}

/// The crates under focus-brush by edges of these kinds, a line each: name, version, features.
fn crates(edges: &str) -> Result<String, Failure> {
    let arguments =
        ["-p", "focus-brush", "-e", edges, "--prefix", "none", "--no-dedupe", "-f", "{p} {f}", "--locked"];
    let listed = output_of(cargo("tree").args(arguments))?;
    Ok(String::from_utf8_lossy(&listed).into_owned())
}

/// The lines of the program that its tests do not share.
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
