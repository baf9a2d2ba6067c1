//! Reading the file's textures, and the images they need.

use crate::error::Fault;
use crate::gltf::container::json_object::as_whole_number;
use crate::gltf::document::Document;
use crate::gltf::focus_brush_extras::RadianceInfo;
use crate::gltf::materials::texture_info::{TextureInfo, uv_set};
use crate::{Image, TextureRef, Wrap};
use glam::Mat3;
use gltf::texture::{MagFilter, WrappingMode};
use std::collections::HashMap;

/// Reads textures, and decodes each image once.
pub(crate) struct TextureReader<'a> {
    pub document: &'a Document<'a>,
    /// Image indices by index in the file; `None` for one that cannot be read.
    image_indices: HashMap<usize, Option<u32>>,
    pub images: Vec<Image>,
    /// Image indices of radiance pictures, by URI; `None` for one that cannot be read.
    radiance_indices: HashMap<String, Option<u32>>,
}

impl<'a> TextureReader<'a> {
    /// A reader of a document's textures that has read none.
    pub fn new(document: &'a Document<'a>) -> Self {
        Self { document, image_indices: HashMap::new(), images: Vec::new(), radiance_indices: HashMap::new() }
    }

    /// The texture at `place`; `None` (which is white) with a warning if its image cannot be read. `is_color`:
    /// whether it is stored as sRGB.
    ///
    /// # Errors
    /// The texture does not exist, or it or its sampler is faulty.
    pub fn texture(
        &mut self,
        info: &TextureInfo,
        place: &str,
        is_color: bool,
        further_sets: &[u32],
    ) -> Result<Option<TextureRef>, Fault> {
        let texture_place = self.document.entry("textures", info.index, &format!("{place}/index"))?;
        self.document.check_at(&texture_place)?;
        self.document.check_at(&format!("{texture_place}/sampler"))?;
        let Some(texture) = self.document.typed().textures().nth(info.index) else { return Ok(None) };
        let Some(image) = self.texture_image(&texture, &texture_place) else { return Ok(None) };
        let sampler = texture.sampler();
        Ok(Some(TextureRef {
            image,
            is_color,
            uv_set: info.uv_set(further_sets),
            transform: info.transform,
            wrap: [sampler.wrap_s(), sampler.wrap_t()].map(wrap),
            nearest: sampler.mag_filter() == Some(MagFilter::Nearest),
        }))
    }

    /// The picture of a radiance as a texture; `None`, with a warning, if it cannot be read.
    pub fn radiance(&mut self, info: &RadianceInfo<'_>, further_sets: &[u32]) -> Option<TextureRef> {
        let image = match self.radiance_indices.get(info.uri) {
            Some(cached) => *cached,
            None => {
                let image = self.document.decode_radiance(info).map(|image| {
                    self.images.push(image);
                    self.images.len() as u32 - 1
                });
                let image =
                    image.map_err(|fault| self.document.warn(format!("{fault}; the light is left out"))).ok();
                self.radiance_indices.insert(info.uri.into(), image);
                image
            }
        };
        Some(TextureRef {
            image: image?,
            is_color: true,
            uv_set: uv_set(info.set, further_sets),
            transform: Mat3::IDENTITY,
            wrap: [Wrap::Clamp; 2],
            nearest: false,
        })
    }

    /// The first of a texture's images that can be read: Basis Universal, WebP, then the plain one.
    fn texture_image(&mut self, texture: &gltf::Texture<'_>, place: &str) -> Option<u32> {
        let extension_source = |name: &str| {
            let index = texture.extension_value(name).and_then(|value| as_whole_number(value.get("source")?));
            (index.map(|index| index as usize), format!("{place}/extensions/{name}/source"))
        };
        // The typed view requires a source.
        let json = self.document.typed().as_json().textures.get(texture.index());
        let plain = json.map(|texture| texture.source.value()).filter(|&i| i < self.document.len("images"));
        let plain = (plain, format!("{place}/source"));
        let (mut has_warned, mut sources) = (false, 0);
        for (source, place) in
            [extension_source("KHR_texture_basisu"), extension_source("EXT_texture_webp"), plain]
        {
            if let Err(fault) = self.document.check_at(&place) {
                self.document.warn(format!("{fault}; the texture is white"));
                has_warned = true;
            }
            let Some(source) = source else { continue };
            sources += 1;
            if let Some(image) = self.image(source, &place) {
                return Some(image);
            }
        }
        if sources == 0 && !has_warned {
            self.document.warn(format!("{place}: has no image of a supported format; it is white"));
        }
        None
    }

    fn image(&mut self, index: usize, place: &str) -> Option<u32> {
        if let Some(cached) = self.image_indices.get(&index) {
            return *cached;
        }
        let image = match self.document.decode_image(index, place) {
            Ok(image) => {
                self.images.push(image);
                Some(self.images.len() as u32 - 1)
            }
            Err(fault) => {
                self.document.warn(format!("{fault}; the texture is white"));
                None
            }
        };
        self.image_indices.insert(index, image);
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
