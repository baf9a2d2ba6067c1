//! Nasty meshes: unwrapping ends, and every triangle has a place of its own.

mod meshes;
mod unwrapped;

use super::harness::made_files::{glb, put};
use super::harness::promise::{Context, Promise, Verdict, Workplace, ended_as_documented, nothing};
use meshes::Mesh;
use serde_json::{Value, json};
use unwrapped::Unwrapped;

/// Unwrapping ends, with every triangle placed.
pub const PROMISE: Promise = Promise {
    name: "unwrapping",
    sentence: "Unwrapping ends, with every triangle placed",
    what_is_done: "twenty kinds of nasty meshes (without area, doubled, non-manifold, huge, tiny, slivers, one-sided, \
                   self-intersecting, loose, fans, spikes, folds …) in three sizes: it ends in time, no triangle is \
                   lost, each lies inside the atlas, and no two share a place",
    full: 3 * meshes::KINDS,
    short: 12,
    batch: 4,
    at_once: 2,
    prepare: nothing,
    case: unwrap,
};

/// Triangles, about, of each of the sizes.
const SIZES: [usize; 3] = [24, 600, 9000];
/// Smallest height of a triangle in the atlas, as a share of its side, that must not vanish in 32-bit coordinates.
const MIN_HEIGHT: f64 = 1e-5;

fn unwrap(case: usize, place: &Workplace, context: &Context) -> Verdict {
    let size = SIZES[case / meshes::KINDS % SIZES.len()];
    let (what, mesh) = meshes::mesh(case % meshes::KINDS, size, case);
    let what = |why: String| format!("{what}, {} triangles: {why}", mesh.triangles.len());
    put(&place.own, "mesh.glb", mesh_glb(&mesh))?;
    let run = context.program.line(&place.own, "unwrap mesh.glb -o out.glb --json").run();
    ended_as_documented(&run).map_err(&what)?;
    if run.code != Some(0) {
        return Err(what(format!("{}: exit code {:?}: {}", run.shown, run.code, run.last_line())));
    }
    let report: Value = serde_json::from_str(&run.stdout).map_err(|e| what(format!("{}: {e}", run.shown)))?;
    if report["triangles"].as_u64() != Some(mesh.triangles.len() as u64) {
        return Err(what(format!("{} triangles were read", report["triangles"])));
    }
    let bytes = std::fs::read(place.own.join("out.glb")).map_err(|e| what(format!("out.glb: {e}")))?;
    let unwrapped = Unwrapped::read(&bytes).ok_or_else(|| what("out.glb cannot be read".into()))?;
    judge(&mesh, &unwrapped, &report).map_err(what)
}

fn judge(mesh: &Mesh, unwrapped: &Unwrapped, report: &Value) -> Verdict {
    let Unwrapped { triangles } = unwrapped;
    if triangles.len() != mesh.triangles.len() {
        return Err(format!("{} triangles were written", triangles.len()));
    }
    if let Some(lost) =
        triangles.iter().position(|corners| corners.as_flattened().iter().any(|c| !(0.0..=1.0).contains(c)))
    {
        return Err(format!("triangle {lost} lies outside the atlas: {:?}", triangles[lost]));
    }
    let number = |name: &str| report[name].as_f64().unwrap_or(0.0);
    let scale = number("texels_per_unit") / number("width").max(number("height")).max(1.0);
    for (index, (corners, in_space)) in triangles.iter().zip(&mesh.triangles).enumerate() {
        let height = mesh.smallest_height(*in_space) * scale;
        if height.is_finite() && height > MIN_HEIGHT && unwrapped::area(corners) == 0.0 {
            return Err(format!(
                "triangle {index} has no area in the atlas, but should be {height:.1e} of it high"
            ));
        }
    }
    match unwrapped.overlapping() {
        Some([a, b]) => {
            Err(format!("triangles {a} and {b} overlap in the atlas: {:?}, {:?}", triangles[a], triangles[b]))
        }
        None => Ok(()),
    }
}

/// A GLB of a mesh, of its positions and indices alone.
fn mesh_glb(mesh: &Mesh) -> Vec<u8> {
    let mut buffer: Vec<u8> = mesh.positions.as_flattened().iter().flat_map(|c| c.to_le_bytes()).collect();
    let positions = buffer.len();
    buffer.extend(mesh.triangles.as_flattened().iter().flat_map(|index| index.to_le_bytes()));
    let bound = |of: fn(f32, f32) -> f32, start: f32| {
        let fold = |axis: usize| mesh.positions.iter().map(|p| p[axis]).fold(start, of);
        [fold(0), fold(1), fold(2)]
    };
    let (low, high) = (bound(f32::min, f32::INFINITY), bound(f32::max, f32::NEG_INFINITY));
    let scene = json!({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": mesh.positions.len(), "type": "VEC3", "min": low,
                "max": high},
            {"bufferView": 1, "componentType": 5125, "count": 3 * mesh.triangles.len(), "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": positions},
            {"buffer": 0, "byteOffset": positions, "byteLength": buffer.len() - positions}],
        "buffers": [{"byteLength": buffer.len()}]});
    glb(&scene.to_string(), &buffer)
}
