//! Which colours and textures of a material of the file count here, and in which UV sets the textures lie.
//!
//! A texture may lie in any TEXCOORD_n. Sets 0 and 1 are always read, for they may be an unwrapping too; of the others
//! those that the material of a mesh asks for. [`TextureRef::uv_set`](crate::TextureRef::uv_set) numbers them through,
//! material by material.

use glam::{Vec3, Vec4};
use gltf::Material;
use gltf::texture::Info;

/// The base colour of a material.
pub(crate) struct BaseColor<'a> {
    pub factor: Vec4,
    pub texture: Option<Info<'a>>,
    pub metallic: f32,
    pub roughness: f32,
}

impl<'a> BaseColor<'a> {
    /// By metallic-roughness, or the diffuse colour of KHR_materials_pbrSpecularGlossiness, which is the albedo of a
    /// surface that is no metal.
    ///
    /// Where both are there, the extension wants to be preferred, and it is, but for two cases: an unlit material
    /// shows its base colour by definition; and a black diffuse factor is that of a metal, whose colour is the
    /// specular one, which is not read: metallic-roughness knows it, if it says any colour.
    pub fn of(material: &Material<'a>) -> Self {
        let plain = material.pbr_metallic_roughness();
        let plain = Self {
            factor: Vec4::from_array(plain.base_color_factor()),
            texture: plain.base_color_texture(),
            metallic: plain.metallic_factor(),
            roughness: plain.roughness_factor(),
        };
        let Some(glossy) = material.pbr_specular_glossiness() else { return plain };
        let diffuse = Vec4::from_array(glossy.diffuse_factor());
        let says_a_color = plain.texture.is_some() || plain.factor != Vec4::ONE;
        if says_a_color && (material.unlit() || diffuse.truncate() == Vec3::ZERO) {
            return plain;
        }
        Self { factor: diffuse, texture: glossy.diffuse_texture(), metallic: 0.0, roughness: 1.0 }
    }
}

/// The emitted radiance of a material, and its texture where there is any.
pub(crate) fn emission<'a>(material: &Material<'a>) -> (Vec3, Option<Info<'a>>) {
    let strength = material.emissive_strength().unwrap_or(1.0);
    let radiance = strength * Vec3::from_array(material.emissive_factor());
    (radiance, material.emissive_texture().filter(|_| radiance != Vec3::ZERO))
}

/// The n of the TEXCOORD_n that a texture lies in: that of its transform, if it has one, else its own.
fn set_of(texture: &Info<'_>) -> u32 {
    let transform = texture.texture_transform();
    transform.and_then(|transform| transform.tex_coord()).unwrap_or(texture.tex_coord())
}

/// The UV sets from 2 on that the textures of a material lie in, each once.
pub(crate) fn further_uv_sets(material: &Material<'_>) -> Vec<u32> {
    let mut sets = Vec::new();
    for texture in [BaseColor::of(material).texture, emission(material).1].iter().flatten() {
        let set = set_of(texture);
        if set > 1 && !sets.contains(&set) {
            sets.push(set);
        }
    }
    sets
}

/// [`TextureRef::uv_set`](crate::TextureRef::uv_set) of a texture of `material`.
pub(crate) fn uv_set(material: &Material<'_>, texture: &Info<'_>) -> u8 {
    match set_of(texture) {
        set @ (0 | 1) => set as u8,
        set => 2 + further_uv_sets(material).iter().position(|&further| further == set).unwrap_or(0) as u8,
    }
}
