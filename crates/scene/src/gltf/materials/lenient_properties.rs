//! Material properties that the picture can do without: a faulty one is reported as a warning, and its default is
//! used.

use crate::error::Fault;
use crate::gltf::container::json_object::Object;
use crate::gltf::materials::texture_info::{TextureInfo, section};
use crate::gltf::materials::texture_reader::TextureReader;
use crate::{NormalMap, Scalar, TextureRef, Tint};
use glam::Vec3;

/// The properties of a material, or of a part or an extension of it.
pub(crate) struct LenientProperties<'r, 'a> {
    reader: &'r mut TextureReader<'a>,
    object: Object<'a>,
    /// The material's further UV sets.
    sets: &'r [u32],
}

impl<'r, 'a> LenientProperties<'r, 'a> {
    /// Reads the properties of `object`, a material or an extension of it; `sets` are the UV sets of the primitives
    /// that use it.
    pub fn new(reader: &'r mut TextureReader<'a>, object: Object<'a>, sets: &'r [u32]) -> Self {
        Self { reader, object, sets }
    }

    /// The value, or a warning.
    fn or_warn<T>(&self, read: Result<Option<T>, Fault>) -> Option<T> {
        read.unwrap_or_else(|fault| {
            self.reader.document.warn(format!("{fault}; it is left out"));
            None
        })
    }

    /// The properties of the object or extension `name`, if it exists.
    pub fn section(&mut self, name: &str) -> Option<LenientProperties<'_, 'a>> {
        let object = self.or_warn(section(&self.object, name))?;
        Some(LenientProperties { reader: self.reader, object, sets: self.sets })
    }

    /// The property `key` as a number, clamped to the range from `low` to `high`; `absent` if it is missing or faulty.
    pub fn number(&self, key: &str, absent: f32, [low, high]: [f32; 2]) -> f32 {
        self.or_warn(self.object.number(key)).map_or(absent, |number| number as f32).clamp(low, high)
    }

    /// The property `key` as a number that may be infinite, which is its default (as attenuation distances are, in
    /// scene units).
    pub fn distance(&self, key: &str) -> f64 {
        let distance = self.or_warn(self.object.number(key)).unwrap_or(f64::INFINITY);
        if distance > 0.0 { distance } else { f64::INFINITY }
    }

    /// The property `key` as a linear colour, each channel clamped to [0, `high`]; `absent` if it is missing or
    /// faulty.
    pub fn color(&self, key: &str, absent: Vec3, high: f32) -> Vec3 {
        let color = self.or_warn(self.object.numbers::<3>(key));
        color
            .map_or(absent, |color| Vec3::from_array(color.map(|v| v as f32)))
            .clamp(Vec3::ZERO, Vec3::splat(high))
    }

    /// The texture `key`, if it exists and can be read; `is_color`: whether it is stored as sRGB.
    pub fn texture(&mut self, key: &str, is_color: bool) -> Option<TextureRef> {
        let info = self.or_warn(TextureInfo::read(&self.object, key))?;
        let place = format!("{}/{key}", self.object.place);
        let texture = self.reader.texture(&info, &place, is_color, self.sets);
        self.or_warn(texture)
    }

    /// A number in [0, 1] with the texture that scales it; the texture is not read if the number is 0.
    pub fn scalar(&mut self, [key, texture]: [&str; 2], absent: f32, channel: u8) -> Scalar {
        let factor = self.number(key, absent, [0.0, 1.0]);
        let texture = if factor > 0.0 { self.texture(texture, false) } else { None };
        Scalar { factor, texture: texture.map(|texture| (texture, channel)) }
    }

    /// A colour with the texture that scales it; the texture is not read if the colour is black.
    pub fn tint(&mut self, [key, texture]: [&str; 2], absent: Vec3, high: f32) -> Tint {
        let factor = self.color(key, absent, high);
        Tint { factor, texture: if factor == Vec3::ZERO { None } else { self.texture(texture, true) } }
    }

    /// The normal map `key`, if it exists and can be read.
    pub fn normal_map(&mut self, key: &str) -> Option<NormalMap> {
        let scale = self.or_warn(TextureInfo::read(&self.object, key))?.scale;
        let texture = self.texture(key, false)?;
        Some(NormalMap { texture, scale: scale.clamp(-1e3, 1e3) })
    }
}
