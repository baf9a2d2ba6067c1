//! Permitted dependencies between crates: the layers of ARCHITECTURE.md as a table, checked against the
//! manifests.

use crate::chore::{Failure, cargo, output_of};
use serde_json::Value;

/// Each crate of the workspace and the crates of the workspace it may depend on.
const ALLOWED: &[(&str, &[&str])] = &[
    ("lens", &[]),
    ("gaussians", &["lens", "numerics", "progress"]),
    ("material", &[]),
    ("progress", &[]),
    ("numerics", &[]),
    ("window-launcher", &[]),
    ("atomic-file", &[]),
    ("spread", &["numerics", "progress"]),
    ("web-page", &["numerics"]),
    ("surface", &[]),
    ("web-engine", &["splat", "salf", "surface", "lens", "numerics", "progress"]),
    ("disparity", &["numerics", "progress"]),
    ("scene", &["gaussians", "surface", "lens", "numerics", "progress"]),
    ("capture", &["scene", "lens", "progress"]),
    ("relief", &["numerics", "progress"]),
    ("atlas", &["atomic-file", "scene", "progress"]),
    ("trace", &["scene", "gaussians", "lens", "numerics", "progress"]),
    ("slf", &["material", "trace", "scene", "atlas", "numerics", "progress"]),
    ("salf", &["slf", "trace", "scene", "gaussians", "surface", "lens", "numerics", "progress"]),
    ("focus", &["spread", "atlas", "scene", "lens", "numerics", "progress"]),
    ("graphics-card", &[]),
    ("sight-on-card", &["graphics-card", "trace", "scene"]),
    ("splat", &["graphics-card", "salf", "surface", "lens", "numerics", "progress"]),
    ("test-scenes", &["scene"]),
    (
        "hard-cases",
        &[
            "lens",
            "material",
            "scene",
            "atlas",
            "trace",
            "slf",
            "salf",
            "focus",
            "splat",
            "progress",
            "test-scenes",
        ],
    ),
    ("baselines", &["salf", "trace", "scene", "lens", "progress"]),
    ("project", &["atomic-file", "scene", "relief", "focus", "atlas", "lens", "numerics"]),
    ("jobs", &["progress"]),
    ("light", &["atomic-file", "jobs", "slf", "trace", "atlas", "scene", "lens", "progress"]),
    (
        "document",
        &[
            "gaussians",
            "atomic-file",
            "light",
            "jobs",
            "project",
            "capture",
            "disparity",
            "relief",
            "focus",
            "spread",
            "salf",
            "slf",
            "trace",
            "atlas",
            "scene",
            "lens",
            "numerics",
            "progress",
        ],
    ),
    (
        "render",
        &[
            "graphics-card",
            "sight-on-card",
            "gaussians",
            "document",
            "atomic-file",
            "web-page",
            "web-engine",
            "light",
            "jobs",
            "baselines",
            "project",
            "splat",
            "focus",
            "salf",
            "slf",
            "trace",
            "atlas",
            "scene",
            "lens",
            "numerics",
            "progress",
        ],
    ),
    (
        "session",
        &[
            "graphics-card",
            "sight-on-card",
            "render",
            "document",
            "light",
            "jobs",
            "baselines",
            "project",
            "relief",
            "splat",
            "focus",
            "salf",
            "slf",
            "trace",
            "atlas",
            "scene",
            "lens",
            "numerics",
            "progress",
        ],
    ),
    (
        "report",
        &[
            "graphics-card",
            "session",
            "atomic-file",
            "render",
            "document",
            "light",
            "jobs",
            "hard-cases",
            "baselines",
            "project",
            "splat",
            "focus",
            "salf",
            "trace",
            "atlas",
            "scene",
            "lens",
            "numerics",
            "progress",
        ],
    ),
    (
        "focus-brush",
        &[
            "graphics-card",
            "report",
            "session",
            "render",
            "document",
            "light",
            "jobs",
            "baselines",
            "project",
            "splat",
            "focus",
            "salf",
            "slf",
            "trace",
            "atlas",
            "scene",
            "lens",
            "numerics",
            "progress",
        ],
    ),
    (
        "python",
        &[
            "graphics-card",
            "report",
            "render",
            "document",
            "light",
            "jobs",
            "project",
            "splat",
            "focus",
            "salf",
            "atlas",
            "scene",
            "lens",
            "progress",
        ],
    ),
    ("xtask", &[]),
];

/// External crates, by prefix of their names, and the only crates that may depend on them.
const RESERVED: &[(&str, &[&str])] = &[
    ("eframe", &["focus-brush"]),
    ("egui", &["focus-brush"]),
    ("wgpu", &["focus-brush", "graphics-card", "sight-on-card", "splat"]),
    ("rfd", &["focus-brush"]),
    ("anyhow", &["focus-brush"]),
    ("clap", &["focus-brush"]),
    ("xatlas", &["atlas"]),
    ("webp", &["web-page"]),
    ("pyo3", &["python"]),
    ("numpy", &["python"]),
];

/// Checks the workspace.
///
/// # Errors
/// A forbidden dependency, or `cargo metadata` fails.
pub fn check() -> Result<(), Failure> {
    let metadata = output_of(cargo("metadata").args(["--no-deps", "--format-version", "1"]))?;
    let metadata: Value =
        serde_json::from_slice(&metadata).map_err(|e| Failure::new(format!("cargo metadata: {e}")))?;
    let wrong = violations(&metadata);
    if wrong.is_empty() {
        return Ok(());
    }
    Err(Failure::new(format!("crate directions (see ARCHITECTURE.md):\n  {}", wrong.join("\n  "))))
}

/// Violations of the table in the output of `cargo metadata --no-deps`, one sentence each.
fn violations(metadata: &Value) -> Vec<String> {
    let mut wrong = Vec::new();
    for package in metadata["packages"].as_array().into_iter().flatten() {
        let name = package["name"].as_str().unwrap_or_default();
        let Some((_, allowed)) = ALLOWED.iter().find(|(of, _)| *of == name) else {
            wrong.push(format!("{name} is not in the table (xtask/src/crate_directions.rs)"));
            continue;
        };
        for dependency in package["dependencies"].as_array().into_iter().flatten() {
            let on = dependency["name"].as_str().unwrap_or_default();
            let ours = ALLOWED.iter().any(|(of, _)| *of == on);
            // Tests may use crates of higher layers.
            let for_tests = dependency["kind"] == "dev";
            if ours && !for_tests && !allowed.contains(&on) {
                wrong.push(format!("{name} may not depend on {on}"));
            }
            let reserved = RESERVED.iter().find(|(prefix, _)| on.starts_with(prefix));
            if let Some((_, knowing)) = reserved.filter(|(_, knowing)| !knowing.contains(&name)) {
                wrong.push(format!("{name} may not know {on} (only {} may)", knowing.join(" and ")));
            }
        }
    }
    wrong
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn package(name: &str, dependencies: &[(&str, Option<&str>)]) -> Value {
        let dependencies: Vec<_> =
            dependencies.iter().map(|(name, kind)| json!({"name": name, "kind": kind})).collect();
        json!({"name": name, "dependencies": dependencies})
    }

    #[test]
    fn the_workspace_keeps_its_directions() {
        check().unwrap_or_else(|failure| panic!("{failure}"));
    }

    #[test]
    fn what_the_table_forbids_is_found() {
        let metadata = json!({"packages": [
            package("lens", &[("glam", None), ("scene", None)]),
            package("salf", &[("wgpu", None)]),
            package("session", &[("egui_tiles", Some("dev"))]),
            package("helper", &[]),
        ]});
        let wrong = violations(&metadata).join("\n");
        assert!(wrong.contains("lens may not depend on scene"), "{wrong}");
        assert!(wrong.contains("salf may not know wgpu"), "{wrong}");
        assert!(wrong.contains("session may not know egui_tiles"), "{wrong}");
        assert!(wrong.contains("helper is not in the table"), "{wrong}");
    }

    #[test]
    fn what_the_table_allows_passes() {
        let metadata = json!({"packages": [
            package("splat", &[("salf", None), ("wgpu", None), ("project", Some("dev"))]),
            package("focus-brush", &[("egui", None), ("session", None)]),
        ]});
        assert_eq!(violations(&metadata), Vec::<String>::new());
    }
}
