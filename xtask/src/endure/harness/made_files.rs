//! Small files of every kind that the program reads: made here, or by the program from these.

use super::archive::zlib_zeros;
use super::promise::Context;
use serde_json::{Value, json};
use std::path::Path;

/// A camera close to the scene's wall; its background lights the scene at once.
pub fn camera() -> Value {
    json!({"width": 24, "height": 24, "yfov": 0.8, "focus_distance": 2.5, "aperture_radius": 0.1,
        "sensor_height": 0.024, "background": [0.5, 0.5, 0.5],
        "camera_to_world": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 3], [0, 0, 0, 1]],
        "aperture": {"shape": "polygon", "blades": 6, "rotation": 0.2, "roundness": 0.3, "ratio": 1.0}})
}

/// Positions and indices of a quad with texture coordinates: the buffer of [`scene`].
pub fn quad_bytes() -> Vec<u8> {
    let corners = [(-1.0f32, -1.0f32), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let mut bytes = Vec::new();
    for (x, y) in corners {
        bytes.extend([x, y, 0.0].into_iter().flat_map(f32::to_le_bytes));
    }
    for (x, y) in corners {
        bytes.extend([x * 0.5 + 0.5, y * 0.5 + 0.5].into_iter().flat_map(f32::to_le_bytes));
    }
    bytes.extend([0u16, 1, 2, 0, 2, 3].into_iter().flat_map(u16::to_le_bytes));
    bytes
}

/// A quad that shines, and a camera.
pub fn scene() -> Value {
    json!({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "extensionsUsed": ["KHR_materials_unlit"],
        "nodes": [{"mesh": 0, "name": "wall"}, {"camera": 0, "translation": [0, 0, 3]}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1, "aspectRatio": 1.0}}],
        "materials": [{"name": "paint", "pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.4, 0.2, 1]},
            "extensions": {"KHR_materials_unlit": {}}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-1, -1, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
            {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 32},
            {"buffer": 0, "byteOffset": 80, "byteLength": 12}],
        "buffers": [{"byteLength": 92}]})
}

/// The scene with a picture on its wall, named by a URI.
pub fn scene_with_texture(uri: &str, mime: Option<&str>) -> Value {
    let mut scene = scene();
    let image = mime.map_or_else(|| json!({"uri": uri}), |mime| json!({"uri": uri, "mimeType": mime}));
    scene["images"] = json!([image]);
    scene["textures"] = json!([{"source": 0}]);
    scene["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = json!({"index": 0});
    scene
}

/// A GLB of this JSON and buffer.
pub fn glb(json: &str, buffer: &[u8]) -> Vec<u8> {
    let padded = |bytes: &[u8], filler: u8| {
        let mut bytes = bytes.to_vec();
        bytes.resize(bytes.len().next_multiple_of(4), filler);
        bytes
    };
    let (json, buffer) = (padded(json.as_bytes(), b' '), padded(buffer, 0));
    let mut file = b"glTF\x02\0\0\0".to_vec();
    file.extend(((12 + 8 + json.len() + 8 + buffer.len()) as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &buffer)] {
        file.extend((chunk.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(chunk);
    }
    file
}

/// A GLB of this scene over the quad's buffer.
pub fn glb_of(scene: &Value) -> Vec<u8> {
    glb(&scene.to_string(), &quad_bytes())
}

/// A chunk of a PNG.
pub fn png_chunk(kind: &[u8; 4], content: &[u8]) -> Vec<u8> {
    let mut chunk = (content.len() as u32).to_be_bytes().to_vec();
    chunk.extend(kind);
    chunk.extend(content);
    let checksum = crc32fast::hash(&chunk[4..]);
    chunk.extend(checksum.to_be_bytes());
    chunk
}

/// A PNG that says it has this size, with further chunks after its head and this many zeros as its pixels.
pub fn png_of_zeros(size: [u32; 2], color_type: u8, chunks: &[u8], zeros: u64) -> Vec<u8> {
    let mut head = Vec::new();
    head.extend(size.iter().flat_map(|side| side.to_be_bytes()));
    head.extend([8, color_type, 0, 0, 0]);
    let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
    file.extend(png_chunk(b"IHDR", &head));
    file.extend(chunks);
    file.extend(png_chunk(b"IDAT", &zlib_zeros(zeros)));
    file.extend(png_chunk(b"IEND", b""));
    file
}

/// A small picture in a format that the `image` crate writes.
pub fn picture(file: &Path, size: [u32; 2]) -> Result<(), String> {
    let pixel = |x: u32, y: u32| image::Rgb([(x * 9) as u8, (y * 11) as u8, 128]);
    let picture = image::DynamicImage::ImageRgb8(image::RgbImage::from_fn(size[0], size[1], pixel));
    let is_radiance = file.extension().is_some_and(|extension| extension == "hdr");
    let picture = if is_radiance { picture.to_rgb32f().into() } else { picture };
    picture.save(file).map_err(|e| format!("{}: {e}", file.display()))
}

/// Writes a file.
pub fn put(folder: &Path, name: &str, content: impl AsRef<[u8]>) -> Result<(), String> {
    let file = folder.join(name);
    if let Some(parent) = file.parent() {
        std::fs::create_dir_all(parent).map_err(|e| format!("{}: {e}", parent.display()))?;
    }
    std::fs::write(&file, content).map_err(|e| format!("{}: {e}", file.display()))
}

/// Writes the scene, its camera, a recipe, strokes, keys, a world, presets and pictures.
pub fn write_inputs(folder: &Path) -> Result<(), String> {
    put(folder, "s.glb", glb_of(&scene()))?;
    put(folder, "texture.gltf", {
        let mut scene = scene_with_texture("t.png", None);
        scene["buffers"] = json!([{"byteLength": 92, "uri": "quad.bin"}]);
        scene.to_string()
    })?;
    put(folder, "quad.bin", quad_bytes())?;
    put(folder, "cam.json", camera().to_string())?;
    put(
        folder,
        "recipe.json",
        json!({"default": {"t": 1, "anchor": 0}, "nodes": {"wall": {"t": 0.9, "anchor": 0.5}}}).to_string(),
    )?;
    put(folder, "strokes.json", strokes().to_string())?;
    put(
        folder,
        "world.json",
        json!({"environment": "sky.hdr", "rotation": 0.1, "strength": 1.0, "bounces": 0}).to_string(),
    )?;
    put(
        folder,
        "bokeh.json",
        json!({"format": "focus-brush preset", "version": 1, "name": "Mask",
        "bokeh": {"shape": "mask", "ratio": 1, "mask": {"name": "m", "rows": ["00ff", "ffff"]}}})
        .to_string(),
    )?;
    put(
        folder,
        "lens.json",
        json!({"format": "focus-brush preset", "version": 1, "name": "Lens",
        "lens": {"focal_length": 0.085, "f_number": 1.4, "sensor_height": 0.024}})
        .to_string(),
    )?;
    for name in ["t.png", "a.jpg", "a.webp"] {
        picture(&folder.join(name), [12, 8])?;
    }
    picture(&folder.join("sky.hdr"), [16, 8])
}

/// A stroke over the middle of the wall.
pub fn strokes() -> Value {
    json!({"format": "focus-brush strokes", "version": 1, "strokes": [{"layer": "Paint",
        "brush": {"radius": 0.2, "mode": "set", "target": {"t": 0.95, "anchor": 1}},
        "view": {"camera_to_world": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 3, 1], "yfov": 0.8, "aspect": 1.0},
        "points": [[0.4, 0.5, 1.0], [0.6, 0.5, 0.9]]}]})
}

/// Writes what [`write_inputs`] does, and with the program a project, a light field, maps, parts and pictures.
pub fn write_all(folder: &Path, context: &Context) -> Result<(), String> {
    write_inputs(folder)?;
    for line in [
        "new s.glb --camera cam.json --focus recipe.json -o p.fbrush",
        "bake s.glb --camera cam.json -o l.salf",
        "export p.fbrush --focus-map m.exr",
        "export p.fbrush --focus-map m.png",
        "render l.salf --backend cpu -o r.exr",
        "render l.salf --backend cpu -o r.png",
        "render s.glb --camera cam.json --size 64x64 --backend cpu --tiles 2x1 --shard 1/2 -o tiles.exr",
        "render s.glb --camera cam.json --size 64x64 --backend cpu --tiles 2x1 --shard 2/2 -o tiles.exr",
    ] {
        context.program.line(folder, line).succeed()?;
    }
    Ok(())
}

/// A picture `a.jpg` of this size, and beside it its depth, which rises in steps to the right.
pub fn picture_with_depth(folder: &Path, [width, height]: [u32; 2]) -> Result<(), String> {
    picture(&folder.join("a.jpg"), [width, height])?;
    let depth = |x: u32, y: u32| 1.0 + (12 * x / width + 2 * y / height) as f32 / 6.0;
    put(folder, "a_depth.pfm", pfm([width, height], depth))
}

/// A PFM of one channel; its rows run upwards.
pub fn pfm([width, height]: [u32; 2], value: impl Fn(u32, u32) -> f32) -> Vec<u8> {
    let mut bytes = format!("Pf\n{width} {height}\n-1.0\n").into_bytes();
    for y in (0..height).rev() {
        bytes.extend((0..width).flat_map(|x| value(x, y).to_le_bytes()));
    }
    bytes
}
