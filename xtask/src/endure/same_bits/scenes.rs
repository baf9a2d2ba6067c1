//! Scenes with something to see: walls behind each other, light, metal, paint.

use crate::endure::harness::made_files::{camera, glb, glb_of, put, quad_bytes, scene, write_all};
use crate::endure::harness::promise::Context;
use serde_json::{Value, json};
use std::path::Path;

/// Writes what all promises use, and scenes of our own.
pub fn write(folder: &Path, context: &Context) -> Result<(), String> {
    write_all(folder, context)?;
    put(folder, "walls.glb", glb(&walls().to_string(), &quad_bytes()))?;
    let mut lit = scene();
    lit["materials"][0]["extensions"] = json!({});
    put(folder, "lit.glb", glb_of(&lit))?;
    lit["materials"][0]["pbrMetallicRoughness"]["metallicFactor"] = json!(1.0);
    lit["materials"][0]["pbrMetallicRoughness"]["roughnessFactor"] = json!(0.2);
    put(folder, "metal.glb", glb_of(&lit))?;
    let mut dark = camera();
    if let Some(camera) = dark.as_object_mut() {
        camera.remove("background");
    }
    put(folder, "dark.json", dark.to_string())?;
    let gloss = json!({"default": {"t": 1.03, "anchor": 0.5, "gloss": 1}});
    put(folder, "gloss.json", gloss.to_string())
}

/// Writes a project with painted layers, of the walls.
pub fn write_painted(folder: &Path, context: &Context) -> Result<(), String> {
    let view = json!({"camera_to_world": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 3, 1], "yfov": 0.8,
        "aspect": 1.0});
    let stroke = |layer: &str, mode: &str, t: f64, points: Value| {
        json!({"stroke": {"layer": layer, "view": view, "points": points,
            "brush": {"radius": 0.3, "hardness": 0.4, "mode": mode, "target": {"t": t, "anchor": 1}}}})
    };
    let steps = json!([
        stroke("Paint", "set", 1.04, json!([[0.2, 0.3, 1], [0.8, 0.35, 0.5]])),
        {"layers": "add-paint"},
        stroke("Layer 1", "add", 0.97, json!([[0.5, 0.8, 1], [0.3, 0.5, 1]])),
        {"layers": {"opacity": [1, 0.6]}},
    ]);
    let file =
        |steps: &Value| json!({"format": "focus-brush strokes", "version": 3, "steps": steps}).to_string();
    put(folder, "steps.json", file(&steps))?;
    context.program.line(folder, "new walls.glb --camera cam.json -o blank.fbrush").succeed()?;
    context.program.line(folder, "replay blank.fbrush steps.json -o painted.fbrush").succeed()?;
    Ok(())
}

/// Three walls one behind the other, of two materials, in two variants.
pub fn walls() -> Value {
    let mut walls = scene();
    let node = |name: &str, mesh: usize, x: f64, z: f64, scale: f64| json!({"mesh": mesh, "name": name, "translation": [x, 0, z], "scale": [scale, scale, 1]});
    walls["nodes"] = json!([
        node("wall", 0, -0.6, 1.0, 0.5),
        {"camera": 0, "translation": [0, 0, 3]},
        node("middle", 1, 0.7, 0.0, 0.6),
        node("far", 0, 0.0, -2.0, 3.0)
    ]);
    walls["scenes"][0]["nodes"] = json!([0, 1, 2, 3]);
    let mut other = walls["materials"][0].clone();
    other["name"] = json!("other paint");
    other["pbrMetallicRoughness"]["baseColorFactor"] = json!([0.2, 0.4, 0.9, 1]);
    walls["materials"] = json!([walls["materials"][0], other]);
    let mut mesh = walls["meshes"][0].clone();
    mesh["primitives"][0]["material"] = json!(1);
    mesh["primitives"][0]["extensions"] =
        json!({"KHR_materials_variants": {"mappings": [{"material": 0, "variants": [0]}]}});
    walls["meshes"] = json!([walls["meshes"][0], mesh]);
    walls["extensions"] =
        json!({"KHR_materials_variants": {"variants": [{"name": "Same"}, {"name": "As painted"}]}});
    walls["extensionsUsed"] = json!(["KHR_materials_unlit", "KHR_materials_variants"]);
    walls
}
