//! Inputs to begin with: small valid files of every kind.

use super::super::harness::made_files::put;
use super::super::harness::promise::Context;
use super::super::malformed;
use super::targets::{TARGETS, targets_of};
use crate::chore::repository;
use base64::Engine;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Larger files are left out: changes to them find little.
const MAX_BYTES: u64 = 100_000;

/// Writes the seeds of each target, into a folder of its name in `seeds`, with files made in `made`.
///
/// # Errors
/// A file cannot be written, or the program does not make one.
pub fn write(made: &Path, seeds: &Path, context: &Context) -> Result<(), String> {
    malformed::prepare(made, context)?;
    write_others(made)?;
    let mut files = Vec::new();
    list(made, &mut files);
    for folder in ["crates/scene/tests/compressed", "assets/presets"] {
        list(&repository().join(folder), &mut files);
    }
    let _ = std::fs::remove_dir_all(seeds);
    for (index, file) in files.iter().enumerate() {
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        for (target, before) in targets_of(&name) {
            let content = std::fs::read(file).map_err(|e| format!("{}: {e}", file.display()))?;
            put(seeds, &format!("{target}/{index}-{name}"), [before, &content].concat())?;
        }
    }
    // libFuzzer begins without a file where there is none.
    TARGETS.iter().try_for_each(|target| {
        let folder = seeds.join(target);
        std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))
    })
}

/// All files below a folder, in the order of their paths.
fn list(folder: &Path, files: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.sort();
    for path in paths {
        match path.metadata() {
            Ok(data) if data.is_dir() => list(&path, files),
            Ok(data) if data.len() <= MAX_BYTES => files.push(path),
            _ => {}
        }
    }
}

/// Formats of which there is no file elsewhere.
fn write_others(folder: &Path) -> Result<(), String> {
    put(
        folder,
        "keys.json",
        json!({"focus": [{"seconds": 0, "value": {"distance": 3.0}, "ease": "smooth"},
            {"seconds": 1, "value": {"point": {"triangle": 1, "barycentric": [0.2, 0.3]}}}],
            "f_number": [{"seconds": 0, "value": 2.8}]})
        .to_string(),
    )?;
    put(
        folder,
        "others/cameras.nvm",
        "NVM_V3 \n\n2\n1.png\t16 1 0 0 0 0.2 0 -3 0.01 0\n2.png\t16 1 0 0 0 -0.2 0 -3 0 0\n\n0\n",
    )?;
    put(folder, "others/cameras.xml", METASHAPE)?;
    put(folder, "others/model.bin", colmap_binary())?;
    put(
        folder,
        "others/views.json",
        json!({"views": [{"file": "input_Cam000.png", "position": [0, 0]}, {"file": "input_Cam001.png", "position": [1, 0]}],
            "reference": "input_Cam000.png"})
        .to_string(),
    )?;
    put(
        folder,
        "others/attributes.dat",
        "16 // xRes\n16 // yRes\n2 // hRes\n2 // vRes\n1.5 // dH\n1.5 // dV\n0.5 // shift\n10 // focalLength\n",
    )?;
    put(
        folder,
        "others/cameras.json",
        json!([{"id": 0, "img_name": "1", "width": 16, "height": 16, "position": [0.0, 0.0, 3.0],
            "rotation": [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], "fx": 16.0, "fy": 16.0}])
        .to_string(),
    )?;
    let picture = |name: &str| std::fs::read(folder.join(name)).map_err(|e| format!("{name}: {e}"));
    put(folder, "others/gdepth.jpg", gdepth(&picture("a.jpg")?, &picture("t.png")?))?;
    put(folder, "others/quad.atlas", atlas())
}

const METASHAPE: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<document version="1.5.0"><chunk label="c"><sensors>
<sensor id="0" label="s" type="frame"><resolution width="16" height="16"/>
<calibration class="adjusted"><resolution width="16" height="16"/><f>16</f><k1>0.01</k1></calibration></sensor>
</sensors><cameras><group>
<camera id="0" sensor_id="0" label="1"><transform>1 0 0 -0.2 0 1 0 0 0 0 1 -3 0 0 0 1</transform></camera>
<camera id="1" sensor_id="0" label="2" master_id="0"/>
</group></cameras><transform><rotation>1 0 0 0 1 0 0 0 1</rotation><translation>1 2 3</translation><scale>2</scale></transform>
</chunk></document>
"#;

/// The length of `cameras.bin`, then it, then `images.bin`.
fn colmap_binary() -> Vec<u8> {
    let mut cameras = 1u64.to_le_bytes().to_vec();
    // A camera: its number, its model (1: PINHOLE), its size, its parameters.
    cameras.extend([1u32, 1].into_iter().flat_map(u32::to_le_bytes));
    cameras.extend([16u64, 16].into_iter().flat_map(u64::to_le_bytes));
    cameras.extend([16.0f64, 16.0, 8.0, 8.0].into_iter().flat_map(f64::to_le_bytes));
    let mut images = 2u64.to_le_bytes().to_vec();
    for (number, x) in [(1u32, 0.2), (2, -0.2)] {
        // An image: its number, rotation, translation, camera, name, and that it has no points.
        images.extend(number.to_le_bytes());
        images.extend([1.0f64, 0.0, 0.0, 0.0, x, 0.0, 3.0].into_iter().flat_map(f64::to_le_bytes));
        images.extend(1u32.to_le_bytes());
        images.extend(format!("{number}.png\0").into_bytes());
        images.extend(0u64.to_le_bytes());
    }
    [&(cameras.len() as u16).to_le_bytes()[..], &cameras, &images].concat()
}

/// A JPEG with a map of levels in its XMP.
fn gdepth(jpeg: &[u8], levels: &[u8]) -> Vec<u8> {
    let data = base64::engine::general_purpose::STANDARD.encode(levels);
    let xmp = format!(
        "http://ns.adobe.com/xap/1.0/\0<x:xmpmeta xmlns:x=\"adobe:ns:meta/\">\
         <rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\"><rdf:Description rdf:about=\"\" \
         xmlns:GDepth=\"http://ns.google.com/photos/1.0/depthmap/\" GDepth:Format=\"RangeInverse\" GDepth:Near=\"1\" \
         GDepth:Far=\"10\" GDepth:Mime=\"image/png\" GDepth:Data=\"{data}\"/></rdf:RDF></x:xmpmeta>"
    );
    let length = (xmp.len() as u16 + 2).to_be_bytes();
    [&jpeg[..2], b"\xff\xe1", &length, xmp.as_bytes(), &jpeg[2..]].concat()
}

/// An atlas of two triangles, in the form of `crates/atlas/src/bytes.rs`; its hash is not that of its content.
fn atlas() -> Vec<u8> {
    let mut bytes = b"FBATLAS1".to_vec();
    // Columns, rows, triangles, charts; then texels a unit.
    bytes.extend([16u32, 16, 2, 1].into_iter().flat_map(u32::to_le_bytes));
    bytes.extend(16.0f64.to_le_bytes());
    let corners = [[0.1f32, 0.1], [0.9, 0.1], [0.9, 0.9], [0.1, 0.1], [0.9, 0.9], [0.1, 0.9]];
    bytes.extend(corners.as_flattened().iter().flat_map(|corner| corner.to_le_bytes()));
    // The triangles' chart, the chart's part.
    bytes.extend([0; 12]);
    bytes.extend([b'0'; 64]);
    bytes
}
