//! A surface that does not come from a glTF file (a scan, a surface made from depth) as a standalone GLB: its mesh,
//! its atlas as the first UV set, and one texture that lies in the atlas and is shown unlit (KHR_materials_unlit).

use crate::glb::export_glb::write_atomically;
use crate::glb::glb_document::GlbDocument;
use crate::{Atlas, AtlasError};
use glam::Vec2;
use progress::{Progress, Stage};
use scene::{AlphaMode, Part, Scene};
use serde_json::{Map, Value, json};
use std::collections::HashMap;
use std::path::Path;

/// glTF's numbers.
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const CLAMP_TO_EDGE: u32 = 33071;

/// Writes a surface and its texture, the bytes of a PNG that covers the atlas, to `path`, replacing an existing file
/// only once the new one is complete. `amend` is applied to the document first.
///
/// # Errors
/// The result is too large for a GLB, the file cannot be written, or the work was cancelled; an existing file then
/// stays as it was.
pub fn write_surface_glb(
    scene: &Scene,
    atlas: &Atlas,
    texture_png: &[u8],
    path: &Path,
    amend: &dyn Fn(&mut Map<String, Value>),
    progress: &dyn Progress,
) -> Result<(), AtlasError> {
    let mut glb = GlbDocument::empty();
    let view = glb.add_data_view(texture_png);
    let root = json!({
        "asset": { "version": "2.0", "generator": "Focus Brush" },
        "extensionsUsed": ["KHR_materials_unlit"],
        "images": [{ "bufferView": view, "mimeType": "image/png" }],
        "samplers": [{ "wrapS": CLAMP_TO_EDGE, "wrapT": CLAMP_TO_EDGE }],
        "textures": [{ "source": 0, "sampler": 0 }],
        "materials": scene.materials.iter().map(material_json).collect::<Vec<_>>(),
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0, "name": scene.nodes.first().map_or("surface", |node| node.name.as_str()) }],
    });
    glb.root_mut().extend(root.as_object().cloned().unwrap_or_default());
    let mut primitives = Vec::with_capacity(scene.parts.len());
    for (number, part) in scene.parts.iter().enumerate() {
        progress.check()?;
        let done = |number: usize| 0.9 * number as f32 / scene.parts.len() as f32;
        let stage = Stage::new(progress, done(number), done(number + 1));
        primitives.push(primitive(&mut glb, scene, atlas, part, &stage)?);
    }
    glb.push("meshes", json!({ "primitives": primitives }));
    amend(glb.root_mut());
    let bytes = glb.into_bytes()?;
    progress.check()?;
    write_atomically(path, &bytes)?;
    progress.report(1.0);
    Ok(())
}

fn material_json(material: &scene::Material) -> Value {
    let mut json = json!({
        "name": material.name,
        "doubleSided": material.double_sided,
        "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "metallicFactor": 0, "roughnessFactor": 1 },
        "extensions": { "KHR_materials_unlit": {} },
    });
    if matches!(material.alpha, AlphaMode::Blend) {
        json["alphaMode"] = "BLEND".into();
    }
    json
}

/// The primitive of a part: one vertex for each atlas place of a vertex of the scene.
fn primitive(
    glb: &mut GlbDocument,
    scene: &Scene,
    atlas: &Atlas,
    part: &Part,
    progress: &dyn Progress,
) -> Result<Value, AtlasError> {
    let size = Vec2::new(atlas.width as f32, atlas.height as f32);
    let mut numbers: HashMap<(u32, [u32; 2]), u32> = HashMap::new();
    let (mut positions, mut normals, mut places, mut indices) =
        (Vec::<f32>::new(), Vec::<f32>::new(), Vec::<f32>::new(), Vec::<u32>::new());
    let has_normals = !scene.normals.is_empty() && scene.normals.iter().all(|normal| normal.length() > 0.5);
    for triangle in part.triangles.clone() {
        if triangle.is_multiple_of(4096) {
            progress.check()?;
        }
        let vertices = scene.triangles[triangle as usize].vertices;
        for (vertex, corner) in vertices.into_iter().zip(atlas.corners[triangle as usize]) {
            let place = corner / size;
            let number = *numbers.entry((vertex, place.to_array().map(f32::to_bits))).or_insert_with(|| {
                positions.extend(scene.positions[vertex as usize].as_vec3().to_array());
                places.extend(place.to_array());
                if has_normals {
                    normals.extend(scene.normals[vertex as usize].normalize().to_array());
                }
                (places.len() / 2 - 1) as u32
            });
            indices.push(number);
        }
    }
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for position in positions.as_chunks::<3>().0 {
        low = std::array::from_fn(|axis| low[axis].min(position[axis]));
        high = std::array::from_fn(|axis| high[axis].max(position[axis]));
    }
    let count = places.len() / 2;
    let attribute = |glb: &mut GlbDocument, values: &[f32], components: usize| {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        let view = glb.add_vertex_view(&bytes, 4 * components);
        let kind = if components == 3 { "VEC3" } else { "VEC2" };
        glb.push(
            "accessors",
            json!({ "bufferView": view, "componentType": FLOAT, "count": count, "type": kind }),
        )
    };
    let position = attribute(glb, &positions, 3);
    let mut attributes = json!({ "POSITION": position, "TEXCOORD_0": attribute(glb, &places, 2) });
    if has_normals {
        attributes["NORMAL"] = attribute(glb, &normals, 3).into();
    }
    glb.list("accessors")[position]["min"] = json!(low);
    glb.list("accessors")[position]["max"] = json!(high);
    let bytes: Vec<u8> = indices.iter().flat_map(|index| index.to_le_bytes()).collect();
    let view = glb.add_index_view(&bytes);
    let accessor = json!({
        "bufferView": view, "componentType": UNSIGNED_INT, "count": indices.len(), "type": "SCALAR"
    });
    let indices = glb.push("accessors", accessor);
    Ok(json!({ "attributes": attributes, "indices": indices, "material": part.material }))
}
