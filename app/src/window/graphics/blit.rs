//! Draws pictures on the screen from textures whose rectangles can be updated.

use egui::{Painter, Rect};
use egui_wgpu::{Callback, CallbackResources, CallbackTrait, RenderState, ScreenDescriptor};
use render::ScreenPixel;
use std::ops::Range;

/// How the pixels of a picture are sampled on the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filter {
    /// Bilinear.
    Linear,
    /// Nearest neighbour: pixels appear as squares.
    Nearest,
}

/// Draws pictures.
#[derive(Clone)]
pub struct Blitter {
    device: wgpu::Device,
    queue: wgpu::Queue,
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
    /// Linear, nearest.
    samplers: [wgpu::Sampler; 2],
}

/// A picture that can be drawn once per frame.
pub struct Drawable {
    size: [u32; 2],
    texture: wgpu::Texture,
    place: wgpu::Buffer,
    /// Indexed by [`Filter`].
    bind_groups: [wgpu::BindGroup; 2],
}

impl Drawable {
    /// Columns and rows, px.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The texture it is drawn from.
    pub fn texture(&self) -> &wgpu::Texture {
        &self.texture
    }
}

impl Blitter {
    /// For the render target of egui.
    pub fn new(state: &RenderState) -> Self {
        let device = state.device.clone();
        let module = device.create_shader_module(wgpu::include_wgsl!("blit.wgsl"));
        let layout = layout(&device);
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("picture"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let fragment = if state.target_format.is_srgb() { "blit_linear" } else { "blit_encoded" };
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("picture"),
            layout: Some(&pipeline_layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("blit_vertex"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState {
                topology: wgpu::PrimitiveTopology::TriangleStrip,
                ..Default::default()
            },
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some(fragment),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(state.target_format.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        let samplers = [wgpu::FilterMode::Linear, wgpu::FilterMode::Nearest].map(|filter| {
            device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("picture"),
                mag_filter: filter,
                min_filter: filter,
                ..Default::default()
            })
        });
        Self { device, queue: state.queue.clone(), layout, pipeline, samplers }
    }

    /// The device it draws with.
    pub fn device(&self) -> &wgpu::Device {
        &self.device
    }

    /// The queue of that device.
    pub fn queue(&self) -> &wgpu::Queue {
        &self.queue
    }

    /// A black picture.
    pub fn picture(&self, [width, height]: [u32; 2]) -> Drawable {
        let texture = self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("picture"),
            size: wgpu::Extent3d { width: width.max(1), height: height.max(1), depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8Unorm,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        self.drawable(texture)
    }

    /// A picture that shows `texture`, into which other code draws, encoded for the screen.
    pub fn drawable(&self, texture: wgpu::Texture) -> Drawable {
        let place = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("picture's place"),
            size: size_of::<[f32; 4]>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let bind_groups = [0, 1].map(|filter| {
            self.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("picture"),
                layout: &self.layout,
                entries: &[
                    wgpu::BindGroupEntry { binding: 0, resource: place.as_entire_binding() },
                    wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(&view) },
                    wgpu::BindGroupEntry {
                        binding: 2,
                        resource: wgpu::BindingResource::Sampler(&self.samplers[filter]),
                    },
                ],
            })
        });
        Drawable { size: [texture.width(), texture.height()], texture, place, bind_groups }
    }

    /// Updates a rectangle of a picture. `pixels` are those of the whole picture, row by row.
    pub fn write(&self, to: &Drawable, pixels: &[ScreenPixel], [columns, rows]: &[Range<u32>; 2]) {
        let [width, height] = to.size.map(|side| side as usize);
        if columns.is_empty() || rows.is_empty() || pixels.len() != width * height {
            return;
        }
        let first = rows.start as usize * width + columns.start as usize;
        let last = (rows.end as usize - 1) * width + columns.end as usize;
        self.queue.write_texture(
            wgpu::TexelCopyTextureInfo {
                texture: &to.texture,
                mip_level: 0,
                origin: wgpu::Origin3d { x: columns.start, y: rows.start, z: 0 },
                aspect: wgpu::TextureAspect::All,
            },
            pixels[first..last].as_flattened(),
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some((width * size_of::<ScreenPixel>()) as u32),
                rows_per_image: None,
            },
            wgpu::Extent3d {
                width: columns.len() as u32,
                height: rows.len() as u32,
                depth_or_array_layers: 1,
            },
        );
    }

    /// Draws the part of a picture at `image` that lies within the painter's clip rectangle.
    pub fn paint(&self, painter: &Painter, drawn: &Drawable, image: Rect, filter: Filter) {
        // Snapped to whole screen pixels, as the viewport is.
        let scale = painter.ctx().pixels_per_point();
        let visible = snapped_to_pixels(image.intersect(painter.clip_rect()), scale);
        if !visible.is_positive() || !image.is_positive() {
            return;
        }
        let share = |at: egui::Pos2| (at - image.min) / image.size();
        let (min, max) = (share(visible.min), share(visible.max));
        let call = DrawCallback {
            pipeline: self.pipeline.clone(),
            bind_group: drawn.bind_groups[filter as usize].clone(),
            place: drawn.place.clone(),
            corners: [min.x, min.y, max.x, max.y],
        };
        painter.add(Callback::new_paint_callback(visible, call));
    }
}

/// A rectangle, in points, with its edges snapped to pixel boundaries of a screen with `scale` pixels per
/// point.
pub fn snapped_to_pixels(rect: Rect, scale: f32) -> Rect {
    let rounded = |at: egui::Pos2| ((at.to_vec2() * scale).round() / scale).to_pos2();
    Rect::from_min_max(rounded(rect.min), rounded(rect.max))
}

/// The callback that draws one picture at one position.
struct DrawCallback {
    pipeline: wgpu::RenderPipeline,
    bind_group: wgpu::BindGroup,
    place: wgpu::Buffer,
    corners: [f32; 4],
}

impl CallbackTrait for DrawCallback {
    fn prepare(
        &self,
        _device: &wgpu::Device,
        queue: &wgpu::Queue,
        _screen: &ScreenDescriptor,
        _encoder: &mut wgpu::CommandEncoder,
        _resources: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        queue.write_buffer(&self.place, 0, bytemuck::bytes_of(&self.corners));
        Vec::new()
    }

    fn paint(
        &self,
        _info: egui::PaintCallbackInfo,
        pass: &mut wgpu::RenderPass<'static>,
        _resources: &CallbackResources,
    ) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.bind_group, &[]);
        pass.draw(0..4, 0..1);
    }
}

fn layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("picture"),
        entries: &[
            wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::VERTEX,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            },
            wgpu::BindGroupLayoutEntry {
                binding: 1,
                visibility: wgpu::ShaderStages::FRAGMENT,
                ty: wgpu::BindingType::Texture {
                    sample_type: wgpu::TextureSampleType::Float { filterable: true },
                    view_dimension: wgpu::TextureViewDimension::D2,
                    multisampled: false,
                },
                count: None,
            },
            wgpu::BindGroupLayoutEntry {
                binding: 2,
                visibility: wgpu::ShaderStages::FRAGMENT,
                ty: wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
                count: None,
            },
        ],
    })
}
