//! Materials of the file, reduced to what light transport here uses, and the images they need.

use crate::document::Document;
use crate::error::Fault;
use crate::json_object::Object;
use crate::{AlphaMode, Image, Material, TextureRef, Wrap};
use glam::{Mat3, Vec2, Vec3, Vec4};
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
        let object = self.document.item("materials", index, "");
        object.ok().and_then(|object| object.name()).map_or_else(|| format!("material {index}"), String::from)
    }

    /// Material `index`, which is used by `place`.
    pub fn read(&mut self, index: usize, place: &str) -> Result<Material, Fault> {
        let object = self.document.item("materials", index, place)?;
        let pbr = object.object("pbrMetallicRoughness")?;
        let mut material = Material { name: self.name(index), ..default_material() };
        if let Some(pbr) = &pbr {
            let color = pbr.numbers::<4>("baseColorFactor")?.unwrap_or([1.0; 4]);
            material.base_color = Vec4::from_array(color.map(|v| v as f32));
            material.metallic = unit(pbr, "metallicFactor", 1.0)?;
            material.roughness = unit(pbr, "roughnessFactor", 1.0)?;
            material.base_color_texture = self.texture(pbr, "baseColorTexture")?;
        }
        let strength = match object.extension("KHR_materials_emissive_strength")? {
            Some(extension) => extension.number("emissiveStrength")?.unwrap_or(1.0),
            None => 1.0,
        };
        let emissive = object.numbers::<3>("emissiveFactor")?.unwrap_or([0.0; 3]);
        material.emissive = Vec3::from_array(emissive.map(|v| (v * strength) as f32));
        if !material.base_color.is_finite() || !material.emissive.is_finite() {
            return Err(Fault::Malformed { place: object.place, what: "its colours are not finite".into() });
        }
        if material.emissive != Vec3::ZERO {
            material.emissive_texture = self.texture(&object, "emissiveTexture")?;
        }
        if let Some(extension) = object.extension("KHR_materials_specular")? {
            material.specular = unit(&extension, "specularFactor", 1.0)?;
        }
        material.unlit = object.extension("KHR_materials_unlit")?.is_some();
        material.double_sided = object.flag("doubleSided")?;
        material.alpha = match object.text("alphaMode")?.unwrap_or("OPAQUE") {
            "OPAQUE" => AlphaMode::Opaque,
            "MASK" => AlphaMode::Mask(object.number("alphaCutoff")?.unwrap_or(0.5) as f32),
            "BLEND" => AlphaMode::Blend,
            other => {
                self.document
                    .warn(format!("{}/alphaMode: {other:?} is unknown; taken as OPAQUE", object.place));
                AlphaMode::Opaque
            }
        };
        Ok(material)
    }

    /// The texture of a property; nothing (which is white) with a warning if its image cannot be had.
    fn texture(&mut self, owner: &Object<'_>, key: &str) -> Result<Option<TextureRef>, Fault> {
        let Some(info) = owner.object(key)? else { return Ok(None) };
        let texture = info.required("index", info.index("index")?)?;
        let texture = self.document.item("textures", texture, &format!("{}/index", info.place))?;
        let mut uv_set = info.integer("texCoord")?.unwrap_or(0);
        let mut matrix = Mat3::IDENTITY;
        if let Some(transform) = info.extension("KHR_texture_transform")? {
            matrix = texture_transform(&transform)?;
            uv_set = transform.integer("texCoord")?.unwrap_or(uv_set);
        }
        if uv_set > 1 {
            self.document.warn(format!(
                "{}: needs TEXCOORD_{uv_set}; sets 0 and 1 are read, so it is white",
                info.place
            ));
            return Ok(None);
        }
        let Some(image) = self.texture_image(&texture)? else { return Ok(None) };
        let (mut wrap, mut nearest) = ([Wrap::Repeat; 2], false);
        if let Some(sampler) = texture.index("sampler")? {
            let sampler = self.document.item("samplers", sampler, &format!("{}/sampler", texture.place))?;
            wrap = [self.wrap(&sampler, "wrapS")?, self.wrap(&sampler, "wrapT")?];
            nearest = sampler.integer("magFilter")? == Some(9728);
        }
        Ok(Some(TextureRef { image, uv_set: uv_set as u8, transform: matrix, wrap, nearest }))
    }

    fn wrap(&self, sampler: &Object<'_>, key: &str) -> Result<Wrap, Fault> {
        Ok(match sampler.integer(key)?.unwrap_or(10497) {
            10497 => Wrap::Repeat,
            33071 => Wrap::Clamp,
            33648 => Wrap::Mirror,
            other => {
                self.document.warn(format!("{}/{key}: {other} is unknown; taken as repeat", sampler.place));
                Wrap::Repeat
            }
        })
    }

    /// The first of a texture's images that can be read: WebP, then the plain one.
    fn texture_image(&mut self, texture: &Object<'_>) -> Result<Option<u32>, Fault> {
        let webp = texture.extension("EXT_texture_webp")?;
        let sources =
            [webp.map(|webp| webp.index("source")).transpose()?.flatten(), texture.index("source")?];
        for source in sources.into_iter().flatten() {
            if let Some(image) = self.image(source, &format!("{}/source", texture.place)) {
                return Ok(Some(image));
            }
        }
        if sources == [None, None] {
            self.document.warn(format!("{}: has no image of a supported format; it is white", texture.place));
        }
        Ok(None)
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

/// A number in [0, 1].
fn unit(object: &Object<'_>, key: &str, default: f64) -> Result<f32, Fault> {
    Ok(object.number(key)?.unwrap_or(default).clamp(0.0, 1.0) as f32)
}

/// KHR_texture_transform: translation · rotation · scale. The rotation runs counter-clockwise as seen with v
/// downwards, that is, from +v to +u.
fn texture_transform(transform: &Object<'_>) -> Result<Mat3, Fault> {
    let vector = |key, default| -> Result<Vec2, Fault> {
        Ok(transform.numbers::<2>(key)?.map_or(default, |v| Vec2::from_array(v.map(|v| v as f32))))
    };
    let (offset, scale) = (vector("offset", Vec2::ZERO)?, vector("scale", Vec2::ONE)?);
    let (sin, cos) = transform.number("rotation")?.unwrap_or(0.0).sin_cos();
    let (sin, cos) = (sin as f32, cos as f32);
    Ok(Mat3::from_cols(
        Vec3::new(cos * scale.x, -sin * scale.x, 0.0),
        Vec3::new(sin * scale.y, cos * scale.y, 0.0),
        offset.extend(1.0),
    ))
}
