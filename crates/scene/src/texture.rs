//! Images, references to them as textures, and their sampling.

mod lookup;

pub use numerics::{linear_from_srgb, srgb_from_linear};

use glam::Mat3;

/// A decoded image: encoded values as in the file, four channels per texel, row 0 on top.
#[derive(Clone, Debug)]
pub struct Image {
    /// Its name or URI, for messages.
    pub name: String,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// RGBA texels.
    pub texels: ImageLevel,
}

/// The texels of an image, RGBA interleaved; colours of 8 or 16 bits are sRGB-encoded, opacity is linear.
#[derive(Clone, Debug)]
pub enum ImageLevel {
    /// 8 bits per channel.
    Bits8(Vec<u8>),
    /// 16 bits per channel.
    Bits16(Vec<u16>),
    /// Radiance: linear, unbounded, opacity 1.
    Float(Vec<f32>),
}

/// How a texture is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureRef {
    /// Index into [`Scene::images`](crate::Scene::images).
    pub image: u32,
    /// Whether its RGB values are sRGB-encoded colours; otherwise they are linear numbers.
    pub is_color: bool,
    /// UV set: an index into [`Scene::uv`](crate::Scene::uv), from 2 on into
    /// [`Scene::further_uv`](crate::Scene::further_uv). See [`Scene::uv_set`](crate::Scene::uv_set).
    pub uv_set: u8,
    /// KHR_texture_transform: uv' = transform · (u, v, 1).
    pub transform: Mat3,
    /// Wrap in u and v.
    pub wrap: [Wrap; 2],
    /// Whether magnification uses the nearest texel.
    pub nearest: bool,
}

/// What a texture shows outside [0, 1].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Wrap {
    /// Repeats.
    #[default]
    Repeat,
    /// Continues its border.
    Clamp,
    /// Repeats mirrored.
    Mirror,
}
