//! Linting: defects of a document that reading it would not detect, because the picture does not depend on them.
//!
//! They are reported as warnings, each with its place, in the spirit of the Khronos validator: an author learns that
//! a file is invalid even if it opens here. Nothing in this folder prevents a file from opening.

mod accessors;
mod animations;
mod images;
mod meshes;
mod nodes;
mod properties;
mod vertex_data;

use crate::gltf::document::Document;
use crate::gltf::extension;
use std::collections::BTreeSet;

/// Warns about all defects.
pub(crate) fn lint(document: &Document<'_>) {
    properties::lint(document);
    lint_versions_and_extensions(document);
    accessors::lint(document);
    images::lint(document);
    meshes::lint(document);
    nodes::lint(document);
    animations::lint(document);
}

/// The asset's versions, and whether extensions are declared correctly.
fn lint_versions_and_extensions(document: &Document<'_>) {
    let asset = document.root_object().object("asset").ok().flatten();
    let version = |key: &str| {
        let text = asset.as_ref()?.text(key).ok()??;
        let parsed = text.split_once('.').and_then(|(major, minor)| Some((digits(major)?, digits(minor)?)));
        if parsed.is_none() {
            document.warn(format!("/asset/{key}: {text:?} is not of the form 2.0"));
        }
        parsed
    };
    if let (Some(version), Some(least)) = (version("version"), version("minVersion"))
        && least > version
    {
        document.warn("/asset/minVersion: is greater than the version");
    }
    let used: BTreeSet<&str> = extension::used(document).collect();
    let required: BTreeSet<&str> = extension::required(document).collect();
    for name in required.difference(&used) {
        document.warn(format!("/extensionsRequired: {name} is not in extensionsUsed"));
    }
    const QUANTIZATION: &str = "KHR_mesh_quantization";
    if used.contains(QUANTIZATION) && !required.contains(QUANTIZATION) {
        document.warn(format!("/extensionsUsed: {QUANTIZATION} must be required too"));
    }
}

fn digits(text: &str) -> Option<u32> {
    text.bytes().all(|byte| byte.is_ascii_digit()).then(|| text.parse().ok()).flatten()
}
