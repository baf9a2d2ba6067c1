//! The scene with its atlas as a self-contained GLB: TEXCOORD_1 is the atlas in [0, 1].
//!
//! The scene is exported as it is in memory: world space, instances flattened, a mesh for each node and a primitive
//! for each part. Vertices are split where charts part. The scene's UV sets from 1 on become TEXCOORD_2 and so on. glTF
//! wants UV sets numbered without gaps, so a part that lacks a set below others has the atlas there too.

use crate::glb_materials;
use crate::{Atlas, AtlasError};
use glam::{DVec3, Vec2, Vec3, Vec4};
use progress::{Progress, Stage};
use scene::{LightKind, Scene};
use serde_json::{Map, Value, json};
use std::collections::{BTreeSet, HashMap};
use std::io::Write;
use std::path::Path;

/// glTF's numbers for buffers and components.
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;

/// The share of the work that meshes are; textures, which are packed as PNG, take the rest.
const MESHES_SHARE: f32 = 0.3;

/// Writes the scene with its atlas to a file, replacing it only when the new one is complete.
///
/// # Errors
/// The file cannot be written, is too large for a GLB, or the work was cancelled; the old file then stays.
pub fn write_glb(
    scene: &Scene,
    atlas: &Atlas,
    path: &Path,
    progress: &dyn Progress,
) -> Result<(), AtlasError> {
    let bytes = glb_bytes(scene, atlas, progress)?;
    progress.check()?;
    let write = || {
        let mut file = atomic_write_file::AtomicWriteFile::open(path)?;
        file.write_all(&bytes)?;
        file.commit()
    };
    write().map_err(|source| AtlasError::Write { path: path.to_owned(), source })
}

/// The bytes of [`write_glb`]. The atlas must be of this scene.
///
/// # Errors
/// A texture cannot be encoded, all is too large for a GLB, or the work was cancelled.
pub fn glb_bytes(scene: &Scene, atlas: &Atlas, progress: &dyn Progress) -> Result<Vec<u8>, AtlasError> {
    let mut glb = Glb::default();
    write_meshes(&mut glb, scene, atlas, &Stage::new(progress, 0.0, MESHES_SHARE))?;
    glb_materials::write(&mut glb, scene, &Stage::new(progress, MESHES_SHARE, 1.0))?;
    write_cameras(&mut glb, scene);
    write_lights(&mut glb, scene);
    glb.finish()
}

/// A GLB being put together: its JSON by top-level key, and its one buffer.
#[derive(Default)]
pub(crate) struct Glb {
    lists: Map<String, Value>,
    extensions: Map<String, Value>,
    used: BTreeSet<String>,
    nodes: Vec<Value>,
    accessors: Vec<Value>,
    views: Vec<Value>,
    buffer: Vec<u8>,
}

impl Glb {
    /// Sets a top-level list; glTF forbids empty ones.
    pub fn set(&mut self, key: &str, list: Vec<Value>) {
        if !list.is_empty() {
            self.lists.insert(key.into(), list.into());
        }
    }

    /// Notes that an extension is used.
    pub fn uses(&mut self, extension: &str) {
        self.used.insert(extension.into());
    }

    /// Appends bytes to the buffer; the index of their view.
    pub fn add_view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
        let mut view = json!({ "buffer": 0, "byteOffset": self.buffer.len(), "byteLength": bytes.len() });
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.buffer.extend(bytes);
        self.buffer.resize(self.buffer.len().next_multiple_of(4), 0);
        self.views.push(view);
        self.views.len() - 1
    }

    fn add_floats<const N: usize>(&mut self, values: &[[f32; N]]) -> usize {
        let bytes: Vec<u8> = values.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][N - 1];
        self.add_accessor(&bytes, ARRAY_BUFFER, FLOAT, kind, values.len())
    }

    fn add_accessor(&mut self, bytes: &[u8], target: u32, component: u32, kind: &str, count: usize) -> usize {
        let view = self.add_view(bytes, Some(target));
        let accessor =
            json!({ "bufferView": view, "componentType": component, "type": kind, "count": count });
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn finish(mut self) -> Result<Vec<u8>, AtlasError> {
        let roots: Vec<usize> = (0..self.nodes.len()).collect();
        let mut document = json!({
            "asset": { "version": "2.0", "generator": concat!("focus-brush ", env!("CARGO_PKG_VERSION")) },
            "scene": 0,
            "scenes": [{ "nodes": roots }],
            "buffers": [{ "byteLength": self.buffer.len() }],
        });
        let (nodes, accessors, views) = (
            std::mem::take(&mut self.nodes),
            std::mem::take(&mut self.accessors),
            std::mem::take(&mut self.views),
        );
        self.set("nodes", nodes);
        self.set("accessors", accessors);
        self.set("bufferViews", views);
        for (key, list) in self.lists {
            document[key] = list;
        }
        if !self.used.is_empty() {
            document["extensionsUsed"] = self.used.into_iter().collect();
        }
        if !self.extensions.is_empty() {
            document["extensions"] = self.extensions.into();
        }
        let mut text = document.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let total = 12 + 8 + text.len() as u64 + 8 + self.buffer.len() as u64;
        let total = u32::try_from(total).map_err(|_| AtlasError::GlbTooLarge { bytes: total })?;
        let mut bytes = Vec::with_capacity(total as usize);
        bytes.extend(b"glTF");
        bytes.extend([2, total].into_iter().flat_map(u32::to_le_bytes));
        bytes.extend((text.len() as u32).to_le_bytes());
        bytes.extend(b"JSON");
        bytes.extend(text);
        bytes.extend((self.buffer.len() as u32).to_le_bytes());
        bytes.extend(b"BIN\0");
        bytes.extend(self.buffer);
        Ok(bytes)
    }
}

fn write_meshes(
    glb: &mut Glb,
    scene: &Scene,
    atlas: &Atlas,
    progress: &dyn Progress,
) -> Result<(), AtlasError> {
    let mut primitives: Vec<Vec<Value>> = vec![Vec::new(); scene.nodes.len()];
    for (index, part) in scene.parts.iter().enumerate() {
        progress.check()?;
        progress.report(index as f32 / scene.parts.len() as f32);
        let vertices = SplitVertices::new(scene, atlas, part.triangles.clone());
        if !vertices.indices.is_empty() {
            primitives[part.node as usize].push(primitive(glb, scene, part, &vertices));
        }
    }
    let mut meshes = Vec::new();
    for (node, primitives) in scene.nodes.iter().zip(primitives) {
        if !primitives.is_empty() {
            glb.nodes.push(json!({ "name": node.name, "mesh": meshes.len() }));
            meshes.push(json!({ "name": node.name, "primitives": primitives }));
        }
    }
    glb.set("meshes", meshes);
    Ok(())
}

/// The vertices of a part, one for each pair of scene vertex and place in the atlas.
struct SplitVertices {
    /// Scene vertex and atlas position in [0, 1].
    vertices: Vec<(u32, Vec2)>,
    indices: Vec<u32>,
}

impl SplitVertices {
    /// Triangles with a corner that is not finite are left out: glTF cannot hold them.
    fn new(scene: &Scene, atlas: &Atlas, triangles: std::ops::Range<u32>) -> Self {
        let size = Vec2::new(atlas.width as f32, atlas.height as f32);
        let mut split = Self { vertices: Vec::new(), indices: Vec::new() };
        let mut number: HashMap<(u32, [u32; 2]), u32> = HashMap::new();
        for triangle in triangles {
            if !scene.corners(triangle).iter().all(|c| c.as_vec3().is_finite()) {
                continue;
            }
            let vertices = scene.triangles[triangle as usize].vertices;
            for (vertex, corner) in vertices.into_iter().zip(atlas.corners[triangle as usize]) {
                let index =
                    *number.entry((vertex, corner.to_array().map(f32::to_bits))).or_insert_with(|| {
                        split.vertices.push((vertex, corner / size));
                        split.vertices.len() as u32 - 1
                    });
                split.indices.push(index);
            }
        }
        split
    }

    /// The values of a vertex attribute.
    fn values<T: Copy, const N: usize>(&self, of: &[T], array: impl Fn(T) -> [f32; N]) -> Vec<[f32; N]> {
        self.vertices.iter().map(|&(vertex, _)| array(of[vertex as usize])).collect()
    }
}

fn primitive(glb: &mut Glb, scene: &Scene, part: &scene::Part, split: &SplitVertices) -> Value {
    let mut attributes = Map::new();
    let positions = split.values(&scene.positions, |p: DVec3| p.as_vec3().to_array());
    let accessor = glb.add_floats(&positions);
    let (low, high) = positions.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), &p| {
        (low.min(p.into()), high.max(p.into()))
    });
    glb.accessors[accessor]["min"] = json!(low.to_array());
    glb.accessors[accessor]["max"] = json!(high.to_array());
    attributes.insert("POSITION".into(), accessor.into());
    let has_normal = |&(vertex, _): &(u32, Vec2)| {
        scene.normals.get(vertex as usize).is_some_and(|n| (n.length_squared() - 1.0).abs() < 1e-3)
    };
    if split.vertices.iter().all(has_normal) {
        let normals = split.values(&scene.normals, |n: Vec3| n.normalize().to_array());
        attributes.insert("NORMAL".into(), glb.add_floats(&normals).into());
    }
    let places: Vec<[f32; 2]> = split.vertices.iter().map(|(_, place)| place.to_array()).collect();
    let atlas = glb.add_floats(&places);
    attributes.insert("TEXCOORD_1".into(), atlas.into());
    let mut highest = 1;
    for set in uv_sets(scene, part) {
        let values = split.values(scene.uv_set(set), |c: Vec2| c.to_array());
        if values.as_flattened().iter().all(|x| x.is_finite()) {
            let number = glb_materials::tex_coord(set);
            attributes.insert(format!("TEXCOORD_{number}"), glb.add_floats(&values).into());
            highest = highest.max(number);
        }
    }
    for number in 0..highest {
        attributes.entry(format!("TEXCOORD_{number}")).or_insert(atlas.into());
    }
    let colored =
        |&(vertex, _): &(u32, Vec2)| scene.colors.get(vertex as usize).is_some_and(|c| *c != Vec4::ONE);
    if split.vertices.iter().any(colored) {
        let colors = split.values(&scene.colors, |c: Vec4| c.to_array());
        attributes.insert("COLOR_0".into(), glb.add_floats(&colors).into());
    }
    let indices: Vec<u8> = split.indices.iter().flat_map(|i| i.to_le_bytes()).collect();
    let indices =
        glb.add_accessor(&indices, ELEMENT_ARRAY_BUFFER, UNSIGNED_INT, "SCALAR", split.indices.len());
    json!({ "attributes": attributes, "indices": indices, "material": part.material })
}

/// The UV sets that a part has: those of the file, and what the textures of its material lie in besides.
fn uv_sets(scene: &Scene, part: &scene::Part) -> Vec<u8> {
    let material = scene.materials.get(part.material as usize);
    let textures = material.into_iter().flat_map(|m| [m.base_color_texture, m.emissive_texture]).flatten();
    let mut sets: Vec<u8> = [0, 1].into_iter().filter(|&set| part.has_uv[set as usize]).collect();
    sets.extend(textures.map(|texture| texture.uv_set).filter(|&set| set > 1));
    sets.sort_unstable();
    sets.dedup();
    sets.retain(|&set| !scene.uv_set(set).is_empty());
    sets
}

fn write_cameras(glb: &mut Glb, scene: &Scene) {
    let mut cameras = Vec::new();
    for camera in scene.cameras.iter().filter(|_| !scene.camera_is_invented) {
        let mut perspective = json!({ "yfov": camera.yfov, "znear": 0.01 });
        if let Some(aspect) = camera.aspect {
            perspective["aspectRatio"] = aspect.into();
        }
        glb.nodes.push(json!({
            "name": camera.name,
            "camera": cameras.len(),
            "matrix": camera.camera_to_world.to_cols_array(),
        }));
        cameras.push(json!({ "name": camera.name, "type": "perspective", "perspective": perspective }));
    }
    glb.set("cameras", cameras);
}

fn write_lights(glb: &mut Glb, scene: &Scene) {
    let mut lights = Vec::new();
    for light in scene.lights.iter().filter(|_| !scene.lights_are_invented) {
        let intensity = light.intensity.max_element();
        if intensity.is_nan() || intensity <= 0.0 {
            continue;
        }
        let kind = match light.kind {
            LightKind::Point => "point",
            LightKind::Spot { .. } => "spot",
            LightKind::Directional => "directional",
            // Only scenes without lights of their own have it.
            LightKind::Ambient => continue,
        };
        let color = (light.intensity / intensity).to_array();
        let mut value = json!({ "name": light.name, "type": kind, "color": color, "intensity": intensity });
        if let LightKind::Spot { inner, outer } = light.kind {
            value["spot"] = json!({ "innerConeAngle": inner, "outerConeAngle": outer });
        }
        if light.range.is_finite() && kind != "directional" {
            value["range"] = light.range.into();
        }
        // Lights shine along −Z.
        let turn = glam::DQuat::from_rotation_arc(DVec3::NEG_Z, light.direction.normalize_or(DVec3::NEG_Z));
        glb.nodes.push(json!({
            "name": light.name,
            "translation": light.position.to_array(),
            "rotation": turn.to_array(),
            "extensions": { "KHR_lights_punctual": { "light": lights.len() } },
        }));
        lights.push(value);
    }
    if !lights.is_empty() {
        glb.uses("KHR_lights_punctual");
        glb.extensions.insert("KHR_lights_punctual".into(), json!({ "lights": lights }));
    }
}
