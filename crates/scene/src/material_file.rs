//! Materials of the file, reduced to what light transport here uses, and the images they need.

use crate::document::{Document, named};
use crate::error::Fault;
use crate::json_object::integer;
use crate::material_textures::{BaseColor, emission, uv_set};
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
        for key in ["pbrMetallicRoughness", "emissiveFactor", "doubleSided"] {
            document.sound_below(&format!("{place}/{key}"))?;
        }
        extensions_are_sound(document, &format!("{place}/extensions"))?;
        let base = BaseColor::of(&file);
        let (emissive, emission) = emission(&file);
        if !base.factor.is_finite() || !emissive.is_finite() {
            return Err(Fault::Malformed { place, what: "its colours are not finite".into() });
        }
        if emissive != Vec3::ZERO {
            document.sound_below(&format!("{place}/emissiveTexture"))?;
        }
        let base_color_texture = self.texture(&file, base.texture.as_ref())?;
        let emissive_texture = self.texture(&file, emission.as_ref())?;
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
            base_color: base.factor,
            base_color_texture,
            emissive,
            emissive_texture,
            metallic: base.metallic.clamp(0.0, 1.0),
            roughness: base.roughness.clamp(0.0, 1.0),
            specular: file.specular().map_or(1.0, |specular| specular.specular_factor()).clamp(0.0, 1.0),
            unlit: file.unlit(),
            alpha,
            double_sided: file.double_sided(),
        })
    }

    /// The texture of a property of `material`; nothing (which is white) with a warning if its image cannot be had.
    fn texture(
        &mut self,
        material: &gltf::Material<'_>,
        info: Option<&gltf::texture::Info<'_>>,
    ) -> Result<Option<TextureRef>, Fault> {
        let Some(info) = info else { return Ok(None) };
        let texture = info.texture();
        let texture_place = format!("/textures/{}", texture.index());
        self.document.sound(&texture_place)?;
        self.document.sound(&format!("{texture_place}/sampler"))?;
        let Some(image) = self.texture_image(&texture, &texture_place) else { return Ok(None) };
        let sampler = texture.sampler();
        Ok(Some(TextureRef {
            image,
            uv_set: uv_set(material, info),
            transform: info.texture_transform().map_or(Mat3::IDENTITY, |own| texture_transform(&own)),
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

/// An error if something is wrong with what is read of a material's `extensions`.
fn extensions_are_sound(document: &Document<'_>, place: &str) -> Result<(), Fault> {
    document.sound(place)?;
    for name in ["emissive_strength", "specular", "unlit"] {
        document.sound_below(&format!("{place}/KHR_materials_{name}"))?;
    }
    let glossy = format!("{place}/KHR_materials_pbrSpecularGlossiness");
    document.sound(&glossy)?;
    document.sound_below(&format!("{glossy}/diffuseFactor"))?;
    document.sound_below(&format!("{glossy}/diffuseTexture"))
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
