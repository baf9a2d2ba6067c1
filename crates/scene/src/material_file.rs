//! Materials of the file, reduced to what light transport here uses, and the images they need.

use crate::document::{Document, named};
use crate::error::Fault;
use crate::json_object::integer;
use crate::{AlphaMode, Image, Material, TextureRef, Wrap};
use glam::{Mat3, Vec2, Vec3, Vec4};
use gltf::texture::{MagFilter, TextureTransform, WrappingMode};
use std::collections::HashMap;

/// glTF's default material.
pub(crate) fn default_material() -> Material {
    Material {
        name: "default material".into(),
        base_color: Vec4::ONE,
        base_color_texture: None,
        emissive: Vec3::ZERO,
        emissive_texture: None,
        metallic: 1.0,
        roughness: 1.0,
        specular: 1.0,
        unlit: false,
        alpha: AlphaMode::Opaque,
        double_sided: false,
    }
}

/// Reads materials, and decodes each image once.
pub(crate) struct MaterialReader<'a> {
    document: &'a Document<'a>,
    /// By index in the file; `None` for one that cannot be read.
    known: HashMap<usize, Option<u32>>,
    pub images: Vec<Image>,
}

impl<'a> MaterialReader<'a> {
    pub fn new(document: &'a Document<'a>) -> Self {
        Self { document, known: HashMap::new(), images: Vec::new() }
    }

    /// The name of material `index`.
    pub fn name(&self, index: usize) -> String {
        let material = self.document.typed().materials().nth(index);
        material.and_then(|material| named(material.name())).unwrap_or_else(|| format!("material {index}"))
    }

    /// Material `index`, which is used by `place`.
    pub fn read(&mut self, index: usize, place: &str) -> Result<Material, Fault> {
        let document = self.document;
        let place = document.entry("materials", index, place)?;
        let name = self.name(index);
        let Some(file) = document.typed().materials().nth(index) else {
            return Ok(Material { name, ..default_material() });
        };
        document.sound(&place)?;
        for key in ["pbrMetallicRoughness", "emissiveFactor", "doubleSided", "extensions"] {
            document.sound_below(&format!("{place}/{key}"))?;
        }
        let pbr = file.pbr_metallic_roughness();
        let strength = file.emissive_strength().unwrap_or(1.0);
        let base_color = Vec4::from_array(pbr.base_color_factor());
        let emissive = strength * Vec3::from_array(file.emissive_factor());
        if !base_color.is_finite() || !emissive.is_finite() {
            return Err(Fault::Malformed { place, what: "its colours are not finite".into() });
        }
        let base_color_texture = match pbr.base_color_texture() {
            Some(info) => self.texture(&info, &format!("{place}/pbrMetallicRoughness/baseColorTexture"))?,
            None => None,
        };
        let mut emissive_texture = None;
        if emissive != Vec3::ZERO {
            let place = format!("{place}/emissiveTexture");
            document.sound_below(&place)?;
            if let Some(info) = file.emissive_texture() {
                emissive_texture = self.texture(&info, &place)?;
            }
        }
        let alpha = match file.alpha_mode() {
            gltf::material::AlphaMode::Opaque => AlphaMode::Opaque,
            gltf::material::AlphaMode::Mask => {
                document.sound(&format!("{place}/alphaCutoff"))?;
                AlphaMode::Mask(file.alpha_cutoff().unwrap_or(0.5))
            }
            gltf::material::AlphaMode::Blend => AlphaMode::Blend,
        };
        Ok(Material {
            name,
            base_color,
            base_color_texture,
            emissive,
            emissive_texture,
            metallic: pbr.metallic_factor().clamp(0.0, 1.0),
            roughness: pbr.roughness_factor().clamp(0.0, 1.0),
            specular: file.specular().map_or(1.0, |specular| specular.specular_factor()).clamp(0.0, 1.0),
            unlit: file.unlit(),
            alpha,
            double_sided: file.double_sided(),
        })
    }

    /// The texture of a property; nothing (which is white) with a warning if its image cannot be had.
    fn texture(&mut self, info: &gltf::texture::Info<'_>, place: &str) -> Result<Option<TextureRef>, Fault> {
        let transform = info.texture_transform();
        let own_set = transform.as_ref().and_then(|transform| transform.tex_coord());
        let uv_set = match own_set.unwrap_or(info.tex_coord()) {
            set @ (0 | 1) => set as u8,
            set => {
                self.document
                    .warn(format!("{place}: needs TEXCOORD_{set}; sets 0 and 1 are read, so it is white"));
                return Ok(None);
            }
        };
        let texture = info.texture();
        let texture_place = format!("/textures/{}", texture.index());
        self.document.sound(&texture_place)?;
        self.document.sound(&format!("{texture_place}/sampler"))?;
        let Some(image) = self.texture_image(&texture, &texture_place) else { return Ok(None) };
        let sampler = texture.sampler();
        Ok(Some(TextureRef {
            image,
            uv_set,
            transform: transform.map_or(Mat3::IDENTITY, |transform| texture_transform(&transform)),
            wrap: [sampler.wrap_s(), sampler.wrap_t()].map(wrap),
            nearest: sampler.mag_filter() == Some(MagFilter::Nearest),
        }))
    }

    /// The first of a texture's images that can be read: WebP, then the plain one.
    fn texture_image(&mut self, texture: &gltf::Texture<'_>, place: &str) -> Option<u32> {
        let webp = texture.extension_value("EXT_texture_webp").and_then(|webp| integer(webp.get("source")?));
        // The typed view relies on the source to be there.
        let json = self.document.typed().as_json().textures.get(texture.index());
        let plain = json.map(|texture| texture.source.value()).filter(|&i| i < self.document.len("images"));
        let webp = (webp.map(|index| index as usize), format!("{place}/extensions/EXT_texture_webp/source"));
        let (mut is_told, mut sources) = (false, 0);
        for (source, place) in [webp, (plain, format!("{place}/source"))] {
            if let Err(fault) = self.document.sound(&place) {
                self.document.warn(format!("{fault}; the texture is white"));
                is_told = true;
            }
            let Some(source) = source else { continue };
            sources += 1;
            if let Some(image) = self.image(source, &place) {
                return Some(image);
            }
        }
        if sources == 0 && !is_told {
            self.document.warn(format!("{place}: has no image of a supported format; it is white"));
        }
        None
    }

    fn image(&mut self, index: usize, place: &str) -> Option<u32> {
        if let Some(known) = self.known.get(&index) {
            return *known;
        }
        let image = match self.document.image(index, place) {
            Ok(image) => {
                self.images.push(image);
                Some(self.images.len() as u32 - 1)
            }
            Err(fault) => {
                self.document.warn(format!("{fault}; the texture is white"));
                None
            }
        };
        self.known.insert(index, image);
        image
    }
}

fn wrap(mode: WrappingMode) -> Wrap {
    match mode {
        WrappingMode::Repeat => Wrap::Repeat,
        WrappingMode::ClampToEdge => Wrap::Clamp,
        WrappingMode::MirroredRepeat => Wrap::Mirror,
    }
}

/// KHR_texture_transform: translation · rotation · scale. The rotation runs counter-clockwise as seen with v
/// downwards, that is, from +v to +u.
fn texture_transform(transform: &TextureTransform<'_>) -> Mat3 {
    let (offset, scale) = (Vec2::from_array(transform.offset()), Vec2::from_array(transform.scale()));
    let (sin, cos) = transform.rotation().sin_cos();
    Mat3::from_cols(
        Vec3::new(cos * scale.x, -sin * scale.x, 0.0),
        Vec3::new(sin * scale.y, cos * scale.y, 0.0),
        offset.extend(1.0),
    )
}
