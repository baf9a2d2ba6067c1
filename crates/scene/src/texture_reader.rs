//! Textures of the file, and the images they need.

use crate::document::Document;
use crate::error::Fault;
use crate::json_object::integer;
use crate::material_textures::TextureInfo;
use crate::{Image, TextureRef, Wrap};
use gltf::texture::{MagFilter, WrappingMode};
use std::collections::HashMap;

/// Reads textures, and decodes each image once.
pub(crate) struct TextureReader<'a> {
    pub document: &'a Document<'a>,
    /// By index in the file; `None` for one that cannot be read.
    known: HashMap<usize, Option<u32>>,
    pub images: Vec<Image>,
}

impl<'a> TextureReader<'a> {
    pub fn new(document: &'a Document<'a>) -> Self {
        Self { document, known: HashMap::new(), images: Vec::new() }
    }

    /// The texture at `place`; nothing (which is white) with a warning if its image cannot be had.
    pub fn texture(
        &mut self,
        info: &TextureInfo,
        place: &str,
        is_color: bool,
        further_sets: &[u32],
    ) -> Result<Option<TextureRef>, Fault> {
        let texture_place = self.document.entry("textures", info.index, &format!("{place}/index"))?;
        self.document.sound(&texture_place)?;
        self.document.sound(&format!("{texture_place}/sampler"))?;
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

    /// The first of a texture's images that can be read: Basis Universal, WebP, then the plain one.
    fn texture_image(&mut self, texture: &gltf::Texture<'_>, place: &str) -> Option<u32> {
        let of_extension = |name: &str| {
            let index = texture.extension_value(name).and_then(|value| integer(value.get("source")?));
            (index.map(|index| index as usize), format!("{place}/extensions/{name}/source"))
        };
        // The typed view relies on the source to be there.
        let json = self.document.typed().as_json().textures.get(texture.index());
        let plain = json.map(|texture| texture.source.value()).filter(|&i| i < self.document.len("images"));
        let plain = (plain, format!("{place}/source"));
        let (mut is_told, mut sources) = (false, 0);
        for (source, place) in [of_extension("KHR_texture_basisu"), of_extension("EXT_texture_webp"), plain] {
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
