//! Projects as programs wrote them when each version of the format was new.
//!
//! A version was introduced whenever an older program would have misread what was new, and a program writes the oldest
//! version that can express a project. So each of these has what made its version necessary, and the manifest's fields
//! of that time.

use crate::endure::harness::archive::{Entry, zip};
use crate::endure::harness::made_files::{camera, glb_of, picture_with_depth, put, scene};
use crate::endure::harness::promise::Workplace;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

/// The side of the atlas and its margin, texels.
const SIDE: u32 = 64;
const MARGIN: f32 = 4.0;

/// A project that is being written: its manifest, and its other entries.
struct Project {
    manifest: Value,
    entries: Vec<(&'static str, Vec<u8>)>,
}

/// Writes `p.fbrush` of this version, with its scene, into the case's folder.
pub fn write(place: &Workplace, version: u64) -> Result<(), String> {
    let project = match version {
        7 | 8 => of_picture(place, version)?,
        _ => of_scene(place, version)?,
    };
    let Project { mut manifest, entries } = project;
    for (name, bytes) in &entries {
        manifest["checksums"][*name] = sha256(bytes).into();
    }
    let manifest = manifest.to_string();
    let mut packed = vec![Entry::plain("manifest.json", manifest.as_bytes())];
    packed.extend(entries.iter().map(|(name, bytes)| Entry::plain(name, bytes)));
    put(&place.own, "p.fbrush", zip(&packed))
}

/// What the manifests of all versions have.
fn manifest(version: u64, scene: &str, scene_bytes: &[u8]) -> Value {
    json!({
        "format": "focus-brush project", "version": version, "written_by": "Focus Brush 0.1.0",
        "scene": {"path": scene, "sha256": sha256(scene_bytes)},
        "cameras": [{"name": "shot", "camera": camera()}], "active_camera": 0, "exposure": "normalise",
        "background_focus": [1.0, 0.0], "brush": brush(version), "view": null, "focus_map": null, "checksums": {},
    })
}

/// The brush with the fields that it had.
fn brush(version: u64) -> Value {
    let mut brush = json!({
        "radius": 0.1, "hardness": 0.5, "strength": 1.0, "flow": 1.0, "spacing": 0.25, "mode": "set",
        "target": {"t": 0.95, "anchor": 1.0}, "channels": "both", "offset_limits": [0.25, 4.0],
        "normal_limit_degrees": 90.0, "pressure_to_strength": 0.0, "pressure_to_radius": 0.0,
    });
    if version >= 3 {
        brush["drawn_falloff"] = Value::Null;
        brush["clone_offset"] = json!([0.0, 0.0, 0.0]);
        brush["mirror"] = json!([version == 3, false, false]);
        brush["radial"] = json!(1);
        brush["mirror_center"] = json!([0.0, 0.0, 0.0]);
    }
    if version == 3 {
        brush["mirror_axes"] = json!([[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, 1.0]]);
    }
    if version == 6 {
        brush["target"]["gloss"] = json!(0.5);
    }
    brush
}

/// A project of the quad: painted and, from version 2 on, with what the version is for.
fn of_scene(place: &Workplace, version: u64) -> Result<Project, String> {
    let mut quad = scene();
    if version == 5 {
        let mut other = quad["materials"][0].clone();
        other["name"] = json!("other paint");
        quad["materials"] = json!([quad["materials"][0], other]);
        quad["meshes"][0]["primitives"][0]["extensions"] =
            json!({"KHR_materials_variants": {"mappings": [{"material": 1, "variants": [0]}]}});
        quad["extensions"] = json!({"KHR_materials_variants": {"variants": [{"name": "Other"}]}});
        quad["extensionsUsed"] = json!(["KHR_materials_unlit", "KHR_materials_variants"]);
    }
    if version == 11 {
        quad["materials"] = json!([{"name": "matte", "doubleSided": true}]);
    }
    let scene = glb_of(&quad);
    put(&place.own, "s.glb", &scene)?;
    let mut manifest = manifest(version, "s.glb", &scene);
    let painted = |t: f32, anchor: f32| texels(|x, y| if x + y < SIDE { [t, anchor] } else { [1.0, 0.0] });
    manifest["focus_map"] = json!({"entry": "focus.f32", "width": SIDE, "height": SIDE});
    let mut entries = vec![("atlas.bin", atlas()), ("focus.f32", painted(0.95, 1.0))];
    let layer = |name: &str, blend: &str, opacity: f64, mask: f64| json!({"name": name, "visible": true, "opacity": opacity, "blend": blend, "background": [1.0, 0.0, mask]});
    match version {
        2 => {
            let (mut below, mut above) = (layer("Paint", "set", 1.0, 1.0), layer("Layer", "mix", 0.5, 0.0));
            let mut curve = layer("Depth curve", "multiply-defocus", 1.0, 1.0);
            below["values"] = json!("layers/0.f32");
            above["values"] = json!("layers/1.f32");
            above["mask"] = json!("layers/1.mask.f32");
            curve["curve"] = json!({"curve": [[0.0, 1.0], [2.0, 1.02]], "anchor": 1.0});
            manifest["layers"] = json!({"active": 1, "layers": [below, above, curve]});
            let mask =
                (0..SIDE * SIDE).flat_map(|k| ((k % SIDE) as f32 / SIDE as f32).to_le_bytes()).collect();
            entries.extend([
                ("layers/0.f32", painted(0.95, 1.0)),
                ("layers/1.f32", painted(1.05, 0.5)),
                ("layers/1.mask.f32", mask),
            ]);
        }
        4 => {
            let (mut below, mut plane) =
                (layer("Paint", "set", 1.0, 1.0), layer("Focal plane", "mix", 1.0, 1.0));
            below["values"] = json!("layers/0.f32");
            plane["plane"] =
                json!({"points": [[-1.0, 0.0, 0.5], [1.0, 0.0, -0.5], [0.0, 1.0, 0.0]], "curvature": 0.01});
            manifest["layers"] = json!({"active": 0, "layers": [below, plane]});
            entries.push(("layers/0.f32", painted(0.95, 1.0)));
        }
        5 => manifest["variant"] = json!("Other"),
        6 => {
            manifest["background_gloss"] = json!(0.25);
            manifest["focus_map"]["gloss"] = json!("focus.gloss.f32");
            let gloss = (0..SIDE * SIDE).flat_map(|k| ((k % 2) as f32).to_le_bytes()).collect();
            entries.push(("focus.gloss.f32", gloss));
        }
        9 => {
            let mut spread = layer("Paint", "set", 1.0, 1.0);
            spread["values"] = json!("layers/0.f32");
            spread["spread"] = json!({
                "strokes": {"background": [1.0, 0.0, 0.0], "values": "layers/0.strokes.f32"},
                "settings": {"reach": 12.0, "softness": 0.5, "contrast": 0.5},
            });
            manifest["layers"] = json!({"active": 0, "layers": [spread]});
            entries.push(("layers/0.f32", painted(0.95, 1.0)));
            entries.push(("layers/0.strokes.f32", painted(0.95, 1.0)));
        }
        // What is added has no place in an atlas of the quad alone: the scene is unwrapped when it is opened.
        10 => {
            put(&place.own, "scan.splat", splats())?;
            manifest["splats"] = json!({"file": "scan.splat", "scale": 2.0, "hidden": [[1, 2]]});
            (manifest["focus_map"], entries) = (Value::Null, Vec::new());
        }
        11 => {
            manifest["floor"] = json!(true);
            (manifest["focus_map"], entries) = (Value::Null, Vec::new());
        }
        _ => {}
    }
    Ok(Project { manifest, entries })
}

/// Three splats (.splat) in a row.
fn splats() -> Vec<u8> {
    let row = |k: u8| {
        let floats = [0.2 * f32::from(k), 0.0, 0.0, 0.1, 0.1, 0.1];
        let floats = floats.into_iter().flat_map(f32::to_le_bytes);
        floats.chain([200, 90, 40, 250, 255, 128, 128, 128]).collect::<Vec<_>>()
    };
    (0..3).flat_map(row).collect()
}

/// A project of a picture with depth, which was repaired (7), or is the layer of a file that was chosen (8).
fn of_picture(place: &Workplace, version: u64) -> Result<Project, String> {
    let (scene, bytes) = match version {
        7 => {
            picture_with_depth(&place.own, [12, 8])?;
            ("a.jpg", std::fs::read(place.own.join("a.jpg")).map_err(|e| format!("a.jpg: {e}"))?)
        }
        _ => {
            put(&place.own, "a.exr", layered_exr())?;
            ("a.exr", layered_exr())
        }
    };
    let mut manifest = manifest(version, scene, &bytes);
    manifest["capture"] = match version {
        7 => json!({"kind": "depth", "depth_strokes": [{"repair": "nearer", "way": [[3.0, 4.0], [6.5, 4.0]],
            "radius_px": 2.0, "hardness": 0.5, "strength": 1.0}]}),
        _ => json!({"kind": "depth", "layer": "Second"}),
    };
    Ok(Project { manifest, entries: Vec::new() })
}

/// A map's entry: t and anchor of every texel.
fn texels(of: impl Fn(u32, u32) -> [f32; 2]) -> Vec<u8> {
    let all = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y)));
    all.flat_map(|(x, y)| of(x, y)).flat_map(f32::to_le_bytes).collect()
}

/// The quad in an atlas of its own.
fn atlas() -> Vec<u8> {
    let far = SIDE as f32 - MARGIN;
    let corners = [[MARGIN, far], [far, far], [far, MARGIN], [MARGIN, MARGIN]];
    let triangles = [0, 1, 2, 0, 2, 3].map(|corner: usize| corners[corner]);
    let triangles: Vec<u8> = triangles.as_flattened().iter().flat_map(|c| c.to_le_bytes()).collect();
    let sides: Vec<u8> = [SIDE, SIDE].iter().flat_map(|side| side.to_le_bytes()).collect();
    let density = f64::from(SIDE as f32 - 2.0 * MARGIN) / 2.0;
    let mut bytes = b"FBATLAS1".to_vec();
    bytes.extend(&sides);
    bytes.extend([2u32, 1].iter().flat_map(|count| count.to_le_bytes()));
    bytes.extend(density.to_le_bytes());
    bytes.extend(&triangles);
    // The chart of both triangles, and its part.
    bytes.extend([0; 12]);
    bytes.extend(sha256(&[sides, triangles].concat()).bytes());
    bytes
}

/// An EXR, 12 × 8 and not compressed, of two layers with a picture and its depth each.
fn layered_exr() -> Vec<u8> {
    const SIZE: [u32; 2] = [12, 8];
    const CHANNELS: [&str; 8] =
        ["First.B", "First.G", "First.R", "First.Z", "Second.B", "Second.G", "Second.R", "Second.Z"];
    let mut file = vec![0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0];
    let mut attribute = |name: &str, kind: &str, value: Vec<u8>| {
        file.extend([name.as_bytes(), &[0], kind.as_bytes(), &[0]].concat());
        file.extend((value.len() as u32).to_le_bytes());
        file.extend(value);
    };
    // Of each channel: floats, in all columns and rows.
    let channel =
        |name: &&str| [name.as_bytes(), &[0, 2, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0]].concat();
    let channels: Vec<u8> = CHANNELS.iter().flat_map(channel).chain([0]).collect();
    let window: Vec<u8> = [0, 0, SIZE[0] - 1, SIZE[1] - 1].iter().flat_map(|c| c.to_le_bytes()).collect();
    attribute("channels", "chlist", channels);
    attribute("compression", "compression", vec![0]);
    attribute("dataWindow", "box2i", window.clone());
    attribute("displayWindow", "box2i", window);
    attribute("lineOrder", "lineOrder", vec![0]);
    attribute("pixelAspectRatio", "float", 1f32.to_le_bytes().to_vec());
    attribute("screenWindowCenter", "v2f", vec![0; 8]);
    attribute("screenWindowWidth", "float", 1f32.to_le_bytes().to_vec());
    file.push(0);
    let line_bytes = CHANNELS.len() * SIZE[0] as usize * 4;
    let first = file.len() + 8 * SIZE[1] as usize;
    for y in 0..SIZE[1] as usize {
        file.extend(((first + y * (8 + line_bytes)) as u64).to_le_bytes());
    }
    for y in 0..SIZE[1] {
        file.extend(y.to_le_bytes());
        file.extend((line_bytes as u32).to_le_bytes());
        for (k, channel) in CHANNELS.iter().enumerate() {
            let value = |x: u32| match channel.ends_with('Z') {
                true => 1.0 + (x / 4) as f32,
                false => 0.1 * (k + 1) as f32,
            };
            file.extend((0..SIZE[0]).flat_map(|x| value(x).to_le_bytes()));
        }
    }
    file
}

/// SHA-256 in hex.
fn sha256(bytes: &[u8]) -> String {
    hex::encode(Sha256::digest(bytes))
}
