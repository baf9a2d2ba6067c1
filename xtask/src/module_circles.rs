//! No cycles between modules: within a crate, what two modules need of each other belongs in a module below
//! both.
//!
//! A module here is a source file. It depends on another if its code names something that the other
//! *defines*, in a `use` or by a path: `tokens` reads the text (without tests), `source` what each module
//! declares and names, `crate_modules` follows every name through `pub use` and `*` to the file that defines
//! it, `circle` finds the files that depend on one another. `mod x;` is no dependency, nor is the re-export
//! of an item of a child module.
//!
//! Sibling modules are compared once more, each together with its folder (`siblings`): files may form no
//! cycle while the folders that hold them do.
//!
//! It reads text, not types, and therefore ignores uses without a path: methods and fields, and so `impl`s of
//! one type in several files.

mod circle;
mod crate_modules;
mod siblings;
mod source;
#[cfg(test)]
mod tests;
mod tokens;

use crate::chore::{Failure, cargo, output_of};
use circle::{Circle, circles_of};
use crate_modules::CrateModules;
use serde_json::Value;
use siblings::Siblings;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// Checks the workspace.
pub fn check() -> Result<(), Failure> {
    circles(&[])
}

/// Checks the named crates, or all.
///
/// # Errors
/// There are cycles; the message lists each of them with the names that cause it.
pub fn circles(crates: &[OsString]) -> Result<(), Failure> {
    let metadata = output_of(cargo("metadata").args(["--no-deps", "--format-version", "1"]))?;
    let metadata: Value =
        serde_json::from_slice(&metadata).map_err(|e| Failure::new(format!("cargo metadata: {e}")))?;
    let mut messages = Vec::new();
    for (name, root) in roots(&metadata) {
        if crates.is_empty() || crates.iter().any(|chosen| *chosen == *name) {
            let read = |file: &Path| std::fs::read_to_string(file).ok();
            let crate_circles = circles_in(&root, &read).map_err(Failure::new)?;
            messages.extend(crate_circles.iter().map(|circle| format!("{name}: {circle}")));
        }
    }
    if messages.is_empty() {
        return Ok(());
    }
    Err(Failure::new(format!("circles of modules:\n\n{}", messages.join("\n"))))
}

/// The libraries and programs in the output of `cargo metadata --no-deps`: the package's name and the root
/// file.
fn roots(metadata: &Value) -> Vec<(String, PathBuf)> {
    let mut roots = Vec::new();
    for package in metadata["packages"].as_array().into_iter().flatten() {
        for target in package["targets"].as_array().into_iter().flatten() {
            let kinds = target["kind"].as_array().into_iter().flatten();
            let counts = kinds.filter_map(Value::as_str).any(|kind| ["lib", "bin"].contains(&kind));
            if let (true, Some(root)) = (counts, target["src_path"].as_str()) {
                roots.push((package["name"].as_str().unwrap_or_default().to_string(), root.into()));
            }
        }
    }
    roots
}

/// Descriptions of the cycles in the crate whose root is the file `root`: between files or, if there are none,
/// between sibling modules.
fn circles_in(root: &Path, read: &dyn Fn(&Path) -> Option<String>) -> Result<Vec<String>, String> {
    let modules = CrateModules::read(root, read)?;
    let folder = root.parent().unwrap_or(Path::new(""));
    let shown = |file: usize| {
        let file = &modules.files()[file];
        file.strip_prefix(folder).unwrap_or(file).display().to_string()
    };
    let arrows = modules.arrows();
    let mut circles: Vec<_> =
        circles_of(&arrows).iter().map(|circle| describe_circle(circle, &shown)).collect();
    if circles.is_empty() {
        let paths: Vec<_> = (0..modules.files().len()).map(shown).collect();
        let siblings = Siblings::new(&paths, &arrows);
        let name = |sibling: usize| siblings.names()[sibling].clone();
        circles.extend(circles_of(siblings.arrows()).iter().map(|circle| describe_circle(circle, &name)));
    }
    Ok(circles)
}

/// Describes a cycle: the number of modules, then one line per dependency.
fn describe_circle(circle: &Circle, shown: &dyn Fn(usize) -> String) -> String {
    let mut lines = vec![format!("{} modules in a circle", circle.files.len())];
    for arrows in circle.arrows.chunk_by(|a, b| (a.from, a.to) == (b.from, b.to)) {
        let names: Vec<_> = arrows.iter().map(|arrow| arrow.name.as_str()).collect();
        lines.push(format!("  {} -> {}: {}", shown(arrows[0].from), shown(arrows[0].to), names.join(", ")));
    }
    lines.push(String::new());
    lines.join("\n")
}
