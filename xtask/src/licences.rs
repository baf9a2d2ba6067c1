//! Licences: every linked crate must be usable in a program under MIT or Apache-2.0.
//!
//! Where `cargo deny` is installed, it checks bans and sources as well (`deny.toml`).

use crate::chore::{Failure, cargo, execute, output_of};
use serde_json::Value;

/// Licences that require no more than a notice; MPL-2.0 also requires the publication of changes to its own
/// files, of which there are none.
const PERMISSIVE: &[&str] = &[
    "0BSD",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "BSL-1.0",
    "CC0-1.0",
    "ISC",
    "MIT",
    "MIT-0",
    "MPL-2.0",
    "OFL-1.1",
    "Ubuntu-font-1.0",
    "UFL-1.0",
    "Unicode-3.0",
    "Unlicense",
    "Zlib",
];

/// Checks all dependencies for this machine's platform.
///
/// # Errors
/// A licence is not permissive, or `cargo metadata` fails.
pub fn check() -> Result<(), Failure> {
    let has_deny = cargo("deny").arg("--version").output().is_ok_and(|output| output.status.success());
    if has_deny {
        execute(cargo("deny").args(["check", "licenses", "bans", "sources"]))?;
    }
    let platform = format!("{}-unknown-linux-gnu", std::env::consts::ARCH);
    let metadata =
        output_of(cargo("metadata").args(["--format-version", "1", "--filter-platform", &platform]))?;
    let metadata: Value =
        serde_json::from_slice(&metadata).map_err(|e| Failure::new(format!("cargo metadata: {e}")))?;
    let reached = metadata["resolve"]["nodes"].as_array().map_or(&[][..], Vec::as_slice);
    let packages = metadata["packages"].as_array().into_iter().flatten();
    let wrong: Vec<String> = packages
        .filter(|package| reached.iter().any(|node| node["id"] == package["id"]))
        .filter(|package| !package["license"].as_str().is_some_and(is_permissive))
        .map(|package| format!("{} {}: {}", package["name"], package["version"], package["license"]))
        .collect();
    if wrong.is_empty() {
        return Ok(());
    }
    Err(Failure::new(format!(
        "licences that are not on the list of permissive ones:\n  {}",
        wrong.join("\n  ")
    )))
}

/// Whether an SPDX expression offers a permissive choice: in each operand of `AND`, one alternative of `OR`.
///
/// `A OR B AND C` is read as `(A OR B) AND C`, stricter than SPDX: in doubt, a licence is rejected.
fn is_permissive(expression: &str) -> bool {
    let plain = expression.replace(['(', ')'], " ").replace('/', " OR ");
    plain
        .split(" AND ")
        .all(|choice| choice.split(" OR ").any(|licence| PERMISSIVE.contains(&licence.trim())))
}

#[cfg(test)]
mod tests {
    use super::is_permissive;

    #[test]
    fn a_permissive_choice_is_enough_and_needed() {
        for good in ["MIT", "MIT/Apache-2.0", "(MIT OR GPL-3.0) AND Unicode-3.0", "Zlib OR Apache-2.0 OR MIT"]
        {
            assert!(is_permissive(good), "{good}");
        }
        for bad in ["GPL-3.0", "MIT AND GPL-3.0", "LGPL-3.0-only", "", "(MIT OR Zlib) AND CC-BY-NC-4.0"] {
            assert!(!is_permissive(bad), "{bad}");
        }
    }
}
