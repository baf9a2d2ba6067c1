//! Pictures of radiance: OpenEXR, linear, unbounded, within limits.

use crate::error::Fault;
use crate::gltf::document::Document;
use crate::gltf::focus_brush_extras::RadianceInfo;
use crate::{Image, ImageLevel};
use exr::prelude::{ReadChannels, ReadLayers};
use exr::prelude::{Vec2, read};
use std::io::Cursor;

/// Bytes per texel: RGBA of 32 bits.
const TEXEL_BYTES: u64 = 16;

impl Document<'_> {
    /// Decodes the EXR of a radiance, linear RGB.
    ///
    /// # Errors
    /// The file cannot be read or decoded, or exceeds the budget.
    pub fn decode_radiance(&self, info: &RadianceInfo<'_>) -> Result<Image, Fault> {
        let bytes = self.resource(&info.place, info.uri)?;
        let broken = |what: String| Fault::Malformed { place: format!("{}/uri", info.place), what };
        let unreadable = |error: exr::error::Error| broken(format!("is not a readable EXR: {error}"));
        // The declared size, before anything is allocated.
        let meta = exr::meta::MetaData::read_from_buffered(Cursor::new(&bytes), false).map_err(unreadable)?;
        let declared_size = meta.headers.first().map_or(Vec2(0, 0), |header| header.layer_size);
        let side = |side: usize| u32::try_from(side).unwrap_or(u32::MAX);
        let texels = self.checked_texel_count(
            [side(declared_size.0), side(declared_size.1)],
            bytes.len(),
            &info.place,
        )?;
        self.budget.take_memory(TEXEL_BYTES * texels, &info.place)?;
        let row = |size: Vec2<usize>, Vec2(x, y): Vec2<usize>| 4 * (y * size.0 + x);
        let picture = read()
            .no_deep_data()
            .largest_resolution_level()
            .rgb_channels(
                move |size: Vec2<usize>, _| (size, vec![1f32; 4 * size.area()]),
                move |(size, texels): &mut (Vec2<usize>, Vec<f32>), at, (r, g, b): (f32, f32, f32)| {
                    let at = row(*size, at);
                    texels[at..at + 3].copy_from_slice(&[r, g, b]);
                },
            )
            .first_valid_layer()
            .all_attributes()
            .non_parallel()
            .from_buffered(Cursor::new(&bytes))
            .map_err(unreadable)?;
        let (size, mut texels) = picture.layer_data.channel_data.pixels;
        if size != declared_size {
            return Err(broken("declares two different sizes".into()));
        }
        if !texels.iter().all(|value| value.is_finite()) {
            return Err(broken("has values that are not finite (bake it again)".into()));
        }
        // A filter in the program that wrote it may have produced negative values.
        texels.iter_mut().for_each(|value| *value = value.max(0.0));
        self.budget.release_memory(bytes.len() as u64);
        let (width, height) = (side(size.0), side(size.1));
        Ok(Image { name: info.uri.into(), width, height, texels: ImageLevel::Float(texels) })
    }
}
