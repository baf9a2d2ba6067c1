//! Materials, textures and images of an exported scene.

use crate::AtlasError;
use crate::export_glb::Glb;
use progress::Progress;
use scene::{AlphaMode, Image, ImageLevel, Material, Scene, TextureRef, Wrap};
use serde_json::{Map, Value, json};
use std::collections::{BTreeMap, BTreeSet};

/// The TEXCOORD number of a UV set of the scene ([`TextureRef::uv_set`]): the atlas takes TEXCOORD_1.
pub(crate) fn tex_coord(uv_set: u8) -> u32 {
    u32::from(uv_set) + u32::from(uv_set > 0)
}

/// Adds `materials`, `textures`, `samplers` and `images`.
pub(crate) fn write(glb: &mut Glb, scene: &Scene, progress: &dyn Progress) -> Result<(), AtlasError> {
    let mut textures = Textures::default();
    let materials: Vec<Value> = scene.materials.iter().map(|m| material(glb, m, &mut textures)).collect();
    let mut images: BTreeMap<u32, usize> = BTreeMap::new();
    let mut image_values = Vec::new();
    for (done, &(image, ..)) in textures.list.iter().enumerate() {
        progress.check()?;
        progress.report(done as f32 / textures.list.len() as f32);
        if let Some(picture) = scene.images.get(image as usize).filter(|_| !images.contains_key(&image)) {
            let view = glb.add_view(&png_of(picture)?, None);
            images.insert(image, image_values.len());
            image_values.push(json!({ "name": picture.name, "mimeType": "image/png", "bufferView": view }));
        }
    }
    let samplers: BTreeSet<([u32; 2], bool)> = textures.list.iter().map(|t| (t.1, t.2)).collect();
    let samplers: Vec<_> = samplers.into_iter().collect();
    let list = textures.list.iter().map(|&(image, wrap, nearest)| {
        let sampler = samplers.iter().position(|s| *s == (wrap, nearest));
        json!({ "source": images.get(&image), "sampler": sampler })
    });
    glb.set("textures", list.collect());
    let sampler = |&([s, t], nearest): &([u32; 2], bool)| {
        let (mag, min) = if nearest { (9728, 9984) } else { (9729, 9987) };
        json!({ "wrapS": s, "wrapT": t, "magFilter": mag, "minFilter": min })
    };
    glb.set("samplers", samplers.iter().map(sampler).collect());
    glb.set("images", image_values);
    glb.set("materials", materials);
    Ok(())
}

/// The textures used so far: image, wrap in s and t (glTF's numbers), nearest.
#[derive(Default)]
struct Textures {
    list: Vec<(u32, [u32; 2], bool)>,
}

impl Textures {
    fn reference(&mut self, glb: &mut Glb, texture: &TextureRef) -> Value {
        let wrap = texture.wrap.map(|wrap| match wrap {
            Wrap::Repeat => 10497,
            Wrap::Clamp => 33071,
            Wrap::Mirror => 33648,
        });
        let key = (texture.image, wrap, texture.nearest);
        let index = self.list.iter().position(|t| *t == key).unwrap_or_else(|| {
            self.list.push(key);
            self.list.len() - 1
        });
        let mut value = json!({ "index": index, "texCoord": tex_coord(texture.uv_set) });
        // Columns (cos·sx, −sin·sx), (sin·sy, cos·sy), offset.
        let [x, y, offset] = [texture.transform.x_axis, texture.transform.y_axis, texture.transform.z_axis];
        if texture.transform != glam::Mat3::IDENTITY {
            let rotation = (-x.y).atan2(x.x);
            let scale = [x.truncate().length(), rotation.sin() * y.x + rotation.cos() * y.y];
            let extension = json!({ "offset": [offset.x, offset.y], "rotation": rotation, "scale": scale });
            value["extensions"] = json!({ "KHR_texture_transform": extension });
            glb.uses("KHR_texture_transform");
        }
        value
    }
}

fn material(glb: &mut Glb, material: &Material, textures: &mut Textures) -> Value {
    let mut extensions = Map::new();
    let mut metallic_roughness = json!({
        "baseColorFactor": material.base_color.to_array(),
        "metallicFactor": material.metallic,
        "roughnessFactor": material.roughness,
    });
    if let Some(texture) = &material.base_color_texture {
        metallic_roughness["baseColorTexture"] = textures.reference(glb, texture);
    }
    // Factors are at most 1: what exceeds it is strength.
    let strength = material.emissive.max_element().max(1.0);
    let mut value = json!({
        "name": material.name,
        "pbrMetallicRoughness": metallic_roughness,
        "emissiveFactor": (material.emissive / strength).to_array(),
        "doubleSided": material.double_sided,
    });
    if let Some(texture) = &material.emissive_texture {
        value["emissiveTexture"] = textures.reference(glb, texture);
    }
    match material.alpha {
        AlphaMode::Opaque => {}
        AlphaMode::Mask(cutoff) => {
            value["alphaMode"] = json!("MASK");
            value["alphaCutoff"] = json!(cutoff);
        }
        AlphaMode::Blend => value["alphaMode"] = json!("BLEND"),
    }
    if strength > 1.0 {
        extensions.insert("KHR_materials_emissive_strength".into(), json!({ "emissiveStrength": strength }));
    }
    if material.unlit {
        extensions.insert("KHR_materials_unlit".into(), json!({}));
    }
    if material.specular != 1.0 {
        extensions.insert("KHR_materials_specular".into(), json!({ "specularFactor": material.specular }));
    }
    extensions.keys().for_each(|name| glb.uses(name));
    if !extensions.is_empty() {
        value["extensions"] = extensions.into();
    }
    value
}

fn png_of(image: &Image) -> Result<Vec<u8>, AtlasError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, image.width, image.height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_compression(png::Compression::Fast);
    let (depth, data) = match &image.texels {
        ImageLevel::Bits8(texels) => (png::BitDepth::Eight, texels.clone()),
        ImageLevel::Bits16(texels) => {
            (png::BitDepth::Sixteen, texels.iter().flat_map(|t| t.to_be_bytes()).collect())
        }
    };
    encoder.set_depth(depth);
    let write = |encoder: png::Encoder<'_, &mut Vec<u8>>| encoder.write_header()?.write_image_data(&data);
    write(encoder).map_err(|source| AtlasError::Texture { name: image.name.clone(), source })?;
    Ok(bytes)
}
