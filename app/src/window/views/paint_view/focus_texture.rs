//! The focus map on the graphics card, updated rectangle by rectangle.

use super::device_errors::{GraphicsError, catch_device_errors};
use document::Document;
use focus::FocusMap;
use std::ops::Range;

/// Offset added to the anchor of frozen texels. Must equal the shader's constant.
const FROZEN_ANCHOR_OFFSET: f32 = 2.0;

/// t and anchor per texel, as 32-bit floats: t is too close to 1 for half floats to resolve a pixel of blur.
///
/// Frozen texels have 2 added to their anchor, which is at most 1.
pub struct FocusTexture {
    texture: wgpu::Texture,
    /// A flag per texel, row by row; `None` if everything may be painted.
    frozen: Option<Vec<bool>>,
}

impl FocusTexture {
    /// An unfilterable format: the shader interpolates.
    const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Float;

    /// Copies the whole map.
    ///
    /// # Errors
    /// As [`catch_device_errors`].
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, map: &FocusMap) -> Result<Self, GraphicsError> {
        let texture = catch_device_errors(device, || {
            let texture = device.create_texture(&wgpu::TextureDescriptor {
                label: Some("focus map"),
                size: wgpu::Extent3d { width: map.width(), height: map.height(), depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: Self::FORMAT,
                usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
                view_formats: &[],
            });
            Self { texture, frozen: None }
        })?;
        texture.update(queue, map, 0..map.width(), 0..map.height());
        Ok(texture)
    }

    /// Marks the texels outside the selection as frozen.
    pub fn freeze(&mut self, queue: &wgpu::Queue, document: &Document) {
        let (map, canvas) = (&document.map, &document.stage.canvas);
        self.frozen = document.selection.as_ref().map(|selection| {
            let width = map.width() as usize;
            let mut frozen = vec![false; width * map.height() as usize];
            for (index, texel) in canvas.texels().enumerate() {
                if !selection.contains(index) {
                    let own = [[texel.x, texel.y]];
                    for [x, y] in own.iter().chain(canvas.gutters_of(index)) {
                        frozen[*y as usize * width + *x as usize] = true;
                    }
                }
            }
            frozen
        });
        self.update(queue, map, 0..map.width(), 0..map.height());
    }

    /// t and anchor as encoded for the shader.
    fn encoded_texel(&self, map: &FocusMap, x: u32, y: u32) -> [f32; 2] {
        let [t, anchor] = map.texel(x, y);
        let place = y as usize * map.width() as usize + x as usize;
        let is_frozen = self.frozen.as_ref().is_some_and(|frozen| frozen.get(place) == Some(&true));
        [t, anchor + if is_frozen { FROZEN_ANCHOR_OFFSET } else { 0.0 }]
    }

    /// Columns and rows.
    pub fn size(&self) -> (u32, u32) {
        (self.texture.width(), self.texture.height())
    }

    /// The view that the shader reads.
    pub fn view(&self) -> wgpu::TextureView {
        self.texture.create_view(&wgpu::TextureViewDescriptor::default())
    }

    /// Copies a rectangle of the map, which has the texture's size.
    pub fn update(&self, queue: &wgpu::Queue, map: &FocusMap, columns: Range<u32>, rows: Range<u32>) {
        let columns = columns.start.min(map.width())..columns.end.min(map.width());
        let rows = rows.start.min(map.height())..rows.end.min(map.height());
        if columns.is_empty() || rows.is_empty() || self.size() != (map.width(), map.height()) {
            return;
        }
        let mut texels = Vec::with_capacity(columns.len() * rows.len());
        for y in rows.clone() {
            texels.extend(columns.clone().map(|x| self.encoded_texel(map, x, y)));
        }
        queue.write_texture(
            wgpu::TexelCopyTextureInfo {
                texture: &self.texture,
                mip_level: 0,
                origin: wgpu::Origin3d { x: columns.start, y: rows.start, z: 0 },
                aspect: wgpu::TextureAspect::All,
            },
            bytemuck::cast_slice(&texels),
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some((columns.len() * size_of::<[f32; 2]>()) as u32),
                rows_per_image: None,
            },
            wgpu::Extent3d {
                width: columns.len() as u32,
                height: rows.len() as u32,
                depth_or_array_layers: 1,
            },
        );
    }
}
