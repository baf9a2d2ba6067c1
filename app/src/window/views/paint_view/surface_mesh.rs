//! The scene on the graphics card: triangle corners with atlas positions, and the textures of materials.
//!
//! Built on a worker thread ([`SurfaceMesh::upload`]), because the textures of a large scene take a while.

use super::device_errors::{GraphicsError, catch_device_errors};
use super::surface_overlay::SurfaceOverlay;
use atlas::Atlas;
use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec2, Vec3};
use scene::{AlphaMode, Image, ImageLevel, Material, Scene, TextureRef, Wrap, srgb_from_linear};
use std::collections::HashMap;
use std::ops::Range;
use wgpu::util::DeviceExt;

/// Triangles per vertex buffer: keeps it below the 256 MiB that every device supports.
const TRIANGLES_PER_BUFFER: usize = 1 << 20;
/// Longest side of a texture in the paint view, px: it is for orientation; the picture view shows the detail.
const LARGEST_TEXTURE_PX: u32 = 2048;
/// Opacity below which a transparent surface is neither drawn nor hit by the brush.
const BLEND_CUTOFF: f32 = 0.02;

/// One corner of one triangle.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Corner {
    position: [f32; 3],
    normal: [f32; 3],
    atlas: [f32; 2],
    base_uv: [f32; 2],
    emissive_uv: [f32; 2],
    color: [u8; 4],
}

/// Matches `Material` in surface.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct MaterialUniform {
    base_color: [f32; 4],
    emissive: [f32; 4],
    kind: [f32; 4],
}

/// A run of triangles of one material in one buffer.
#[derive(Clone, Debug)]
struct Draw {
    buffer: usize,
    corners: Range<u32>,
    material: u32,
}

/// A scene that is ready to draw.
pub struct SurfaceMesh {
    buffers: Vec<wgpu::Buffer>,
    draws: Vec<Draw>,
    materials: Vec<wgpu::BindGroup>,
    /// Offset subtracted from world positions.
    pub origin: DVec3,
    /// Diagonal of the scene's bounding box.
    pub extent: f64,
}

impl SurfaceMesh {
    /// The layout of a material's bind group.
    pub fn material_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty,
            count: None,
        };
        let texture = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: true },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
        let uniform = wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: false,
            min_binding_size: None,
        };
        device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("surface material"),
            entries: &[
                entry(0, uniform),
                entry(1, texture),
                entry(2, sampler),
                entry(3, texture),
                entry(4, sampler),
            ],
        })
    }

    /// The vertex layout of a corner.
    pub fn corner_layout() -> wgpu::VertexBufferLayout<'static> {
        const ATTRIBUTES: [wgpu::VertexAttribute; 6] = wgpu::vertex_attr_array![
            0 => Float32x3, 1 => Float32x3, 2 => Float32x2, 3 => Float32x2, 4 => Float32x2, 5 => Unorm8x4
        ];
        wgpu::VertexBufferLayout {
            array_stride: size_of::<Corner>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &ATTRIBUTES,
        }
    }

    /// Copies a scene to the graphics card, with an overlay if there is one. Takes seconds for a large scene:
    /// call it on a worker thread.
    ///
    /// # Errors
    /// The scene is too large for the device, or as [`catch_device_errors`].
    pub fn upload(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        scene: &Scene,
        atlas: &Atlas,
        coat: Option<&SurfaceOverlay>,
    ) -> Result<Self, GraphicsError> {
        catch_device_errors(device, || {
            let (low, high) = scene.bounds();
            let (origin, extent) = if low.is_finite() && high.is_finite() {
                ((low + high) / 2.0, (high - low).length())
            } else {
                (DVec3::ZERO, 1.0)
            };
            let mut buffers = Vec::new();
            let mut draws: Vec<Draw> = Vec::new();
            let count = scene.triangles.len();
            for start in (0..count).step_by(TRIANGLES_PER_BUFFER) {
                let range = start..(start + TRIANGLES_PER_BUFFER).min(count);
                let mut corners = Vec::with_capacity(range.len() * 3);
                for triangle in range {
                    let material = scene.parts[scene.triangles[triangle].part as usize].material;
                    push_corners(&mut corners, scene, atlas, triangle as u32, origin, coat.is_some());
                    let end = corners.len() as u32;
                    match draws.last_mut() {
                        Some(draw) if draw.material == material && draw.buffer == buffers.len() => {
                            draw.corners.end = end;
                        }
                        _ => draws.push(Draw { buffer: buffers.len(), corners: end - 3..end, material }),
                    }
                }
                buffers.push(device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                    label: Some("surface corners"),
                    contents: bytemuck::cast_slice(&corners),
                    usage: wgpu::BufferUsages::VERTEX,
                }));
            }
            let upload = MaterialUpload::new(device, queue, scene);
            let materials = match coat {
                Some(coat) => vec![upload.overlay_bind_group(coat); scene.materials.len()],
                None => upload.bind_groups(),
            };
            Self { buffers, draws, materials, origin, extent }
        })
    }

    /// Draws everything; the frame's bind group and the pipeline must be set.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        for draw in &self.draws {
            pass.set_bind_group(1, &self.materials[draw.material as usize], &[]);
            pass.set_vertex_buffer(0, self.buffers[draw.buffer].slice(..));
            pass.draw(draw.corners.clone(), 0..1);
        }
    }
}

fn push_corners(
    corners: &mut Vec<Corner>,
    scene: &Scene,
    atlas: &Atlas,
    triangle: u32,
    origin: DVec3,
    is_coated: bool,
) {
    let material = scene.material_of(triangle);
    let atlas_corners = atlas.corners.get(triangle as usize).copied().unwrap_or_default();
    let base_uv = match is_coated {
        true => atlas_corners.map(|corner| corner / Vec2::new(atlas.width as f32, atlas.height as f32)),
        false => texture_uv(scene, triangle, material.base_color_texture.as_ref()),
    };
    let emissive_uv = texture_uv(scene, triangle, material.emissive_texture.as_ref());
    let positions = scene.corners(triangle);
    let vertices = scene.triangles[triangle as usize].vertices;
    for (k, vertex) in vertices.into_iter().enumerate() {
        let color = scene.colors.get(vertex as usize).copied().filter(|_| !is_coated);
        let color = color.unwrap_or(glam::Vec4::ONE);
        corners.push(Corner {
            position: (positions[k] - origin).as_vec3().to_array(),
            normal: scene.normals.get(vertex as usize).copied().unwrap_or(Vec3::ZERO).to_array(),
            atlas: atlas_corners[k].to_array(),
            base_uv: base_uv[k].to_array(),
            emissive_uv: emissive_uv[k].to_array(),
            color: color.to_array().map(|c| (c.clamp(0.0, 1.0) * 255.0).round() as u8),
        });
    }
}

/// Texture coordinates of a triangle's corners with the texture's transform applied.
fn texture_uv(scene: &Scene, triangle: u32, texture: Option<&TextureRef>) -> [Vec2; 3] {
    let Some(texture) = texture else { return [Vec2::ZERO; 3] };
    scene.corner_uv(triangle, texture.uv_set).map(|uv| texture.transform.transform_point2(uv))
}

/// Uploads the materials of a scene; each image once.
struct MaterialUpload<'a> {
    device: &'a wgpu::Device,
    queue: &'a wgpu::Queue,
    scene: &'a Scene,
    layout: wgpu::BindGroupLayout,
    white: wgpu::TextureView,
    views: HashMap<u32, wgpu::TextureView>,
}

impl<'a> MaterialUpload<'a> {
    fn new(device: &'a wgpu::Device, queue: &'a wgpu::Queue, scene: &'a Scene) -> Self {
        let layout = SurfaceMesh::material_layout(device);
        let white =
            create_texture(device, queue, "white", &Level { width: 1, height: 1, rgba: vec![255; 4] });
        Self { device, queue, scene, layout, white, views: HashMap::new() }
    }

    fn bind_groups(mut self) -> Vec<wgpu::BindGroup> {
        self.scene.materials.iter().map(|material| self.bind_group(material)).collect()
    }

    /// The bind group for an overlay, drawn unlit.
    fn overlay_bind_group(mut self, coat: &SurfaceOverlay) -> wgpu::BindGroup {
        let image = 0;
        let level = Level { width: coat.width, height: coat.height, rgba: coat.rgba.clone() };
        self.views.insert(image, create_texture(self.device, self.queue, "coat", &level.reduced_to_limit()));
        let texture = TextureRef {
            image,
            is_color: true,
            uv_set: 0,
            transform: glam::Mat3::IDENTITY,
            wrap: [Wrap::Clamp; 2],
            nearest: false,
        };
        self.bind_group(&Material { base_color_texture: Some(texture), ..Material::unlit_white() })
    }

    fn bind_group(&mut self, material: &Material) -> wgpu::BindGroup {
        let cutoff = match material.alpha {
            AlphaMode::Opaque => -1.0,
            AlphaMode::Mask(cutoff) => cutoff,
            AlphaMode::Blend => BLEND_CUTOFF,
        };
        let uniform = MaterialUniform {
            base_color: material.base_color.to_array(),
            emissive: material.emissive.extend(0.0).to_array(),
            kind: [
                f32::from(material.unlit),
                cutoff,
                f32::from(material.culls_back_faces(self.scene.back_faces)),
                0.0,
            ],
        };
        let uniform = self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("surface material"),
            contents: bytemuck::bytes_of(&uniform),
            usage: wgpu::BufferUsages::UNIFORM,
        });
        let base = self.view(material.base_color_texture.as_ref());
        let emissive = self.view(material.emissive_texture.as_ref());
        let base_sampler = self.sampler(material.base_color_texture.as_ref());
        let emissive_sampler = self.sampler(material.emissive_texture.as_ref());
        self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(&material.name),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(&base) },
                wgpu::BindGroupEntry { binding: 2, resource: wgpu::BindingResource::Sampler(&base_sampler) },
                wgpu::BindGroupEntry { binding: 3, resource: wgpu::BindingResource::TextureView(&emissive) },
                wgpu::BindGroupEntry {
                    binding: 4,
                    resource: wgpu::BindingResource::Sampler(&emissive_sampler),
                },
            ],
        })
    }

    fn view(&mut self, texture: Option<&TextureRef>) -> wgpu::TextureView {
        if let Some(cached) = texture.and_then(|t| self.views.get(&t.image)) {
            return cached.clone();
        }
        let image =
            texture.and_then(|t| self.scene.images.get(t.image as usize).map(|image| (t.image, image)));
        let Some((index, image)) = image else { return self.white.clone() };
        let (device, queue) = (self.device, self.queue);
        let view = create_texture(device, queue, &image.name, &Level::from_image(image));
        self.views.insert(index, view.clone());
        view
    }

    fn sampler(&self, texture: Option<&TextureRef>) -> wgpu::Sampler {
        let address = |wrap| match wrap {
            Wrap::Repeat => wgpu::AddressMode::Repeat,
            Wrap::Clamp => wgpu::AddressMode::ClampToEdge,
            Wrap::Mirror => wgpu::AddressMode::MirrorRepeat,
        };
        let wrap = texture.map_or([Wrap::Repeat; 2], |t| t.wrap);
        let nearest = texture.is_some_and(|t| t.nearest);
        self.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("surface material"),
            address_mode_u: address(wrap[0]),
            address_mode_v: address(wrap[1]),
            mag_filter: if nearest { wgpu::FilterMode::Nearest } else { wgpu::FilterMode::Linear },
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        })
    }
}

/// An image at one resolution, 8 bits per channel.
struct Level {
    width: u32,
    height: u32,
    rgba: Vec<u8>,
}

impl Level {
    /// The image, halved until it fits [`LARGEST_TEXTURE_PX`].
    fn from_image(image: &Image) -> Self {
        let rgba = match &image.texels {
            ImageLevel::Bits8(texels) => texels.clone(),
            ImageLevel::Bits16(texels) => texels.iter().map(|t| (t >> 8) as u8).collect(),
            ImageLevel::Float(texels) => {
                texels.iter().map(|&light| (255.0 * srgb_from_linear(light.min(1.0))).round() as u8).collect()
            }
        };
        Self { width: image.width, height: image.height, rgba }.reduced_to_limit()
    }

    fn reduced_to_limit(self) -> Self {
        let mut level = self;
        while level.width.max(level.height) > LARGEST_TEXTURE_PX {
            level = level.half();
        }
        level
    }

    /// Half the texels per side (at least one), each the mean of four.
    fn half(&self) -> Self {
        let (width, height) = ((self.width / 2).max(1), (self.height / 2).max(1));
        let mut rgba = Vec::with_capacity(width as usize * height as usize * 4);
        for y in 0..height {
            for x in 0..width {
                for channel in 0..4 {
                    let texel = |dx: u32, dy: u32| {
                        let column = (2 * x + dx).min(self.width - 1) as usize;
                        let row = (2 * y + dy).min(self.height - 1) as usize;
                        self.rgba[(row * self.width as usize + column) * 4 + channel] as u32
                    };
                    rgba.push(((texel(0, 0) + texel(1, 0) + texel(0, 1) + texel(1, 1) + 2) / 4) as u8);
                }
            }
        }
        Self { width, height, rgba }
    }
}

/// A texture with all its mip levels.
fn create_texture(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    label: &str,
    level: &Level,
) -> wgpu::TextureView {
    let size = wgpu::Extent3d { width: level.width, height: level.height, depth_or_array_layers: 1 };
    let mip_level_count = size.max_mips(wgpu::TextureDimension::D2);
    let mut texels = level.rgba.clone();
    let mut last = Level { width: level.width, height: level.height, rgba: level.rgba.clone() };
    for _ in 1..mip_level_count {
        last = last.half();
        texels.extend_from_slice(&last.rgba);
    }
    let texture = device.create_texture_with_data(
        queue,
        &wgpu::TextureDescriptor {
            label: Some(label),
            size,
            mip_level_count,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8UnormSrgb,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        },
        wgpu::util::TextureDataOrder::LayerMajor,
        &texels,
    );
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halving_takes_the_mean_and_ends_at_one_texel() {
        let mut level = Level { width: 3, height: 2, rgba: (0..24).map(|i| i * 10).collect() };
        let half = level.half();
        assert_eq!((half.width, half.height), (1, 1));
        assert_eq!(half.rgba[0], 80, "of 0, 40, 120 and 160");
        for _ in 0..3 {
            level = level.half();
        }
        assert_eq!((level.width, level.height, level.rgba.len()), (1, 1, 4));
    }
}
