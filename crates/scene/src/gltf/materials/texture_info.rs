//! The textures that a material of the file refers to, and their UV sets.
//!
//! A texture may lie in any TEXCOORD_n. Sets 0 and 1 are always read, since they may also be an unwrapping; of the
//! others, those that the mesh's material uses. [`TextureRef::uv_set`](crate::TextureRef::uv_set) numbers them
//! consecutively, separately for each material.

use crate::error::Fault;
use crate::gltf::container::json_object::Object;
use crate::gltf::document::Document;
use crate::gltf::focus_brush_extras;
use glam::{Mat3, Vec2, Vec3};

/// Where a material's textures are: in itself (""), in a part of it or in one of its extensions; and under which
/// keys.
const TEXTURES: [(&str, &[&str]); 11] = [
    ("", &["normalTexture", "emissiveTexture"]),
    ("pbrMetallicRoughness", &["baseColorTexture", "metallicRoughnessTexture"]),
    ("KHR_materials_pbrSpecularGlossiness", &["diffuseTexture", "specularGlossinessTexture"]),
    ("KHR_materials_specular", &["specularTexture", "specularColorTexture"]),
    ("KHR_materials_transmission", &["transmissionTexture"]),
    ("KHR_materials_volume", &["thicknessTexture"]),
    ("KHR_materials_clearcoat", &["clearcoatTexture", "clearcoatRoughnessTexture", "clearcoatNormalTexture"]),
    ("KHR_materials_sheen", &["sheenColorTexture", "sheenRoughnessTexture"]),
    ("KHR_materials_anisotropy", &["anisotropyTexture"]),
    ("KHR_materials_iridescence", &["iridescenceTexture", "iridescenceThicknessTexture"]),
    (
        "KHR_materials_diffuse_transmission",
        &["diffuseTransmissionTexture", "diffuseTransmissionColorTexture"],
    ),
];

/// Textures that need tangents, in order of precedence for the UVs that the tangents follow.
const WITH_TANGENTS: [(&str, &str); 3] = [
    ("", "normalTexture"),
    ("KHR_materials_clearcoat", "clearcoatNormalTexture"),
    ("KHR_materials_anisotropy", "anisotropyTexture"),
];

/// A property that refers to a texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TextureInfo {
    /// Index into the file's textures, which may not exist.
    pub index: usize,
    /// The n of its TEXCOORD_n: that of its transform if given, else its own.
    pub set: u32,
    /// KHR_texture_transform.
    pub transform: Mat3,
    /// For a normal map.
    pub scale: f32,
}

impl TextureInfo {
    /// Reads the texture property `key` of `owner`; `None` if absent.
    ///
    /// # Errors
    /// It is malformed.
    pub fn read(owner: &Object<'_>, key: &str) -> Result<Option<Self>, Fault> {
        let Some(info) = owner.object(key)? else { return Ok(None) };
        let Some(index) = info.index("index")? else { return Err(info.malformed("index", "is missing")) };
        let transform = info.extension("KHR_texture_transform")?;
        let set_of = |object: &Object<'_>| object.whole_number("texCoord");
        let own_set = set_of(&info)?;
        let set = transform.as_ref().map(set_of).transpose()?.flatten().or(own_set).unwrap_or(0);
        let set = u32::try_from(set).map_err(|_| info.malformed("texCoord", "is too large"))?;
        let scale = info.number("scale")?.unwrap_or(1.0) as f32;
        let transform = transform.map_or(Ok(Mat3::IDENTITY), |transform| transform_matrix(&transform))?;
        Ok(Some(Self { index, set, transform, scale }))
    }

    /// [`TextureRef::uv_set`](crate::TextureRef::uv_set), given the further sets of the material.
    pub fn uv_set(&self, further: &[u32]) -> u8 {
        uv_set(self.set, further)
    }
}

/// [`TextureRef::uv_set`](crate::TextureRef::uv_set) of a TEXCOORD_n, given the further sets of the material.
pub(crate) fn uv_set(set: u32, further: &[u32]) -> u8 {
    match set {
        set @ (0 | 1) => set as u8,
        set => 2 + further.iter().position(|&other| other == set).unwrap_or(0) as u8,
    }
}

/// KHR_texture_transform: translation · rotation · scale. The rotation is counter-clockwise as seen with v downwards,
/// that is, from +v to +u.
fn transform_matrix(transform: &Object<'_>) -> Result<Mat3, Fault> {
    let pair = |key: &str, absent: Vec2| -> Result<Vec2, Fault> {
        Ok(transform.numbers::<2>(key)?.map_or(absent, |pair| Vec2::from_array(pair.map(|v| v as f32))))
    };
    let (offset, scale) = (pair("offset", Vec2::ZERO)?, pair("scale", Vec2::ONE)?);
    let (sin, cos) = (transform.number("rotation")?.unwrap_or(0.0) as f32).sin_cos();
    Ok(Mat3::from_cols(
        Vec3::new(cos * scale.x, -sin * scale.x, 0.0),
        Vec3::new(sin * scale.y, cos * scale.y, 0.0),
        offset.extend(1.0),
    ))
}

/// A part or an extension of a material; the material itself for "".
pub(crate) fn section<'a>(material: &Object<'a>, name: &str) -> Result<Option<Object<'a>>, Fault> {
    match name {
        "" => Ok(Some(material.clone())),
        _ if name.starts_with("KHR_") => material.extension(name),
        _ => material.object(name),
    }
}

/// The UV sets from 2 on that the textures of a material of the file use, each once.
pub(crate) fn further_uv_sets(document: &Document<'_>, material: Option<usize>) -> Vec<u32> {
    let mut sets = Vec::new();
    let Some(material) = material.and_then(|index| document.item("materials", index, "").ok()) else {
        return sets;
    };
    let emissive = material.numbers::<3>("emissiveFactor").ok().flatten().unwrap_or_default();
    let is_sampled = |key: &&&str| **key != "emissiveTexture" || emissive != [0.0; 3];
    for (name, keys) in TEXTURES {
        // Faults are reported when the material is read.
        let Ok(Some(section)) = section(&material, name) else { continue };
        for info in
            keys.iter().filter(is_sampled).filter_map(|key| TextureInfo::read(&section, key).ok().flatten())
        {
            if info.set > 1 && !sets.contains(&info.set) {
                sets.push(info.set);
            }
        }
    }
    if let Ok(Some(radiance)) = focus_brush_extras::radiance(document, &material)
        && radiance.set > 1
        && !sets.contains(&radiance.set)
    {
        sets.push(radiance.set);
    }
    sets
}

/// The texture whose UVs the tangents of a material of the file follow; `None` if nothing needs tangents. Anisotropy
/// without a texture follows set 0.
pub(crate) fn tangent_texture(document: &Document<'_>, material: Option<usize>) -> Option<TextureInfo> {
    let material = document.item("materials", material?, "").ok()?;
    if material.extension("KHR_materials_unlit").ok()?.is_some() {
        return None;
    }
    let texture_info =
        |&(name, key): &(&str, &str)| TextureInfo::read(&section(&material, name).ok()??, key).ok()?;
    let default_info = TextureInfo { index: 0, set: 0, transform: Mat3::IDENTITY, scale: 1.0 };
    let is_anisotropic =
        || material.extension("KHR_materials_anisotropy").ok().flatten().map(|_| default_info);
    WITH_TANGENTS.iter().find_map(texture_info).or_else(is_anisotropic)
}
