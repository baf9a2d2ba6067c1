//! Writes the scene as one .glb: a node, mesh, primitive and material an object, one texture for all that is
//! baked.

use super::sheet::Sheet;
use super::surface::{Object, Shine};
use super::view::View;
use crate::chore::Failure;
use glam::Vec3;
use image::ImageEncoder;
use serde_json::{Value, json};

/// The file's bytes.
///
/// # Errors
/// The texture cannot be encoded.
pub fn glb(objects: &[Object], sheet: &Sheet, texture: &[u8], view: &View) -> Result<Vec<u8>, Failure> {
    let mut blob = Blob::default();
    let (mut meshes, mut nodes, mut materials) = (Vec::new(), Vec::new(), Vec::new());
    for (index, (object, blocks)) in objects.iter().zip(&sheet.blocks).enumerate() {
        let (mut positions, mut uvs, mut indices) = (Vec::new(), Vec::new(), Vec::new());
        for (surface, block) in object.surfaces.iter().zip(blocks) {
            let triangles = surface.triangles();
            // Points that no triangle uses (poles have many) are left out.
            let mut renamed = vec![u32::MAX; surface.points.len()];
            for corner in triangles.into_iter().flatten() {
                let slot = &mut renamed[corner as usize];
                if *slot == u32::MAX {
                    *slot = positions.len() as u32;
                    positions.push(view.staged(surface.points[corner as usize]));
                    uvs.push(sheet.texture_uv(block, surface.uv_of(corner as usize)));
                }
                indices.push(*slot);
            }
        }
        let attributes =
            json!({"POSITION": blob.positions(&positions), "TEXCOORD_0": blob.texture_coordinates(&uvs)});
        let indices = blob.indices(&indices, positions.len());
        meshes.push(json!({"name": object.name,
            "primitives": [{"attributes": attributes, "indices": indices, "material": index}]}));
        nodes.push(json!({"name": object.name, "mesh": index}));
        materials.push(material(object));
    }
    let mut png = Vec::new();
    image::codecs::png::PngEncoder::new_with_quality(
        &mut png,
        image::codecs::png::CompressionType::Best,
        image::codecs::png::FilterType::Adaptive,
    )
    .write_image(texture, sheet.width as u32, sheet.height as u32, image::ExtendedColorType::Rgb8)
    .map_err(|e| Failure::new(format!("the texture: {e}")))?;
    let png = blob.view(&png, None);
    nodes.push(json!({"name": "camera", "camera": 0, "matrix": view.matrix().to_cols_array()}));
    let document = json!({
        "asset": {"version": "2.0", "generator": "focus-brush demo"},
        "extensionsUsed": ["KHR_materials_unlit", "KHR_materials_emissive_strength"],
        "scene": 0,
        "scenes": [{"name": "demo", "nodes": (0..nodes.len()).collect::<Vec<_>>()}],
        "nodes": nodes,
        "meshes": meshes,
        "materials": materials,
        "cameras": [{"name": "camera", "type": "perspective", "perspective":
            {"yfov": view.yfov, "aspectRatio": 16.0 / 9.0, "znear": 0.01, "zfar": 100.0}}],
        "textures": [{"source": 0, "sampler": 0}],
        "samplers": [{"magFilter": 9729, "minFilter": 9729, "wrapS": 33071, "wrapT": 33071}],
        "images": [{"name": "light sheet", "bufferView": png, "mimeType": "image/png"}],
        "accessors": blob.accessors,
        "bufferViews": blob.views,
        "buffers": [{"byteLength": blob.bytes.len()}],
    });
    Ok(container(&document, blob.bytes))
}

fn material(object: &Object) -> Value {
    match object.shine {
        Shine::Baked => json!({"name": object.name, "doubleSided": true,
            "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0.0},
            "extensions": {"KHR_materials_unlit": {}}}),
        Shine::Emitter(color, strength) => json!({"name": object.name, "doubleSided": true,
            "pbrMetallicRoughness": {"baseColorFactor": [0.0, 0.0, 0.0, 1.0], "metallicFactor": 0.0},
            "emissiveFactor": color.to_array(),
            "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": strength}}}),
    }
}

/// The binary part, with the views and accessors into it.
#[derive(Default)]
struct Blob {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Blob {
    fn view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let mut view = json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()});
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.views.push(view);
        self.bytes.extend_from_slice(bytes);
        self.views.len() - 1
    }

    fn accessor(&mut self, accessor: Value) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn positions(&mut self, positions: &[Vec3]) -> usize {
        let bytes: Vec<u8> = positions.iter().flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes).collect();
        let low = positions.iter().fold(Vec3::INFINITY, |a, p| a.min(*p)).to_array();
        let high = positions.iter().fold(Vec3::NEG_INFINITY, |a, p| a.max(*p)).to_array();
        let view = self.view(&bytes, Some(34962));
        self.accessor(
            json!({"bufferView": view, "componentType": 5126, "count": positions.len(), "type": "VEC3",
            "min": low, "max": high}),
        )
    }

    fn texture_coordinates(&mut self, uvs: &[glam::Vec2]) -> usize {
        let encode = |x: f32| ((x * 65535.0).round() as u16).to_le_bytes();
        let bytes: Vec<u8> = uvs.iter().flat_map(|uv| uv.to_array()).flat_map(encode).collect();
        let view = self.view(&bytes, Some(34962));
        self.accessor(
            json!({"bufferView": view, "componentType": 5123, "normalized": true, "count": uvs.len(),
            "type": "VEC2"}),
        )
    }

    fn indices(&mut self, indices: &[u32], points: usize) -> usize {
        let small = points <= 65535;
        let bytes: Vec<u8> = if small {
            indices.iter().flat_map(|i| (*i as u16).to_le_bytes()).collect()
        } else {
            indices.iter().flat_map(|i| i.to_le_bytes()).collect()
        };
        let view = self.view(&bytes, Some(34963));
        let component = if small { 5123 } else { 5125 };
        self.accessor(
            json!({"bufferView": view, "componentType": component, "count": indices.len(), "type": "SCALAR"}),
        )
    }
}

fn container(document: &Value, mut blob: Vec<u8>) -> Vec<u8> {
    let mut json = document.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    blob.resize(blob.len().next_multiple_of(4), 0);
    let mut file = b"glTF".to_vec();
    let word = |file: &mut Vec<u8>, x: usize| file.extend_from_slice(&(x as u32).to_le_bytes());
    word(&mut file, 2);
    word(&mut file, 12 + 8 + json.len() + 8 + blob.len());
    for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &blob)] {
        word(&mut file, chunk.len());
        file.extend_from_slice(kind);
        file.extend_from_slice(chunk);
    }
    file
}
