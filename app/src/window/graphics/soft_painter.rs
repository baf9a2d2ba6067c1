//! Draws egui's shapes with a lean shader on software adapters.
//!
//! egui's own shader contains code for manual texture filtering, which a software adapter executes for every
//! pixel even when it is off: two thirds of the cost of a frame. A plugin therefore replaces the finished
//! shapes of a frame by callbacks, each of which draws a run of them. Shapes with other textures than the font
//! atlas, and existing callbacks, are left unchanged.

use egui::epaint::{ClippedShape, ImageData, ImageDelta, Primitive, TextureId};
use egui::{ClippedPrimitive, Context, FullOutput, PaintCallbackInfo, Pos2, Rect, Shape};
use egui_wgpu::{Callback, CallbackResources, CallbackTrait, RenderState};
use std::ops::Range;
use wgpu::util::DeviceExt;

/// Installs the plugin if `state` uses a software adapter.
pub fn install(context: &Context, state: &RenderState) {
    let in_software = state.adapter.get_info().device_type == wgpu::DeviceType::Cpu;
    if in_software && !state.target_format.is_srgb() {
        context.add_plugin(SoftPainter::new(state));
    }
}

/// The plugin.
struct SoftPainter {
    device: wgpu::Device,
    queue: wgpu::Queue,
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
    sampler: wgpu::Sampler,
    font: Option<Font>,
}

/// The font atlas, which also contains the white texel for plain colours.
struct Font {
    texture: wgpu::Texture,
    bound: wgpu::BindGroup,
}

/// A vertex, as the shader reads it.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Corner {
    clip: [f32; 2],
    uv: [f32; 2],
    color: [u8; 4],
}

impl egui::Plugin for SoftPainter {
    fn debug_name(&self) -> &'static str {
        "soft painter"
    }

    fn output_hook(&mut self, context: &Context, output: &mut FullOutput) {
        let deltas = output.textures_delta.set.get(&TextureId::default());
        deltas.into_iter().flatten().for_each(|delta| self.take_font(delta));
        let Some(font) = &self.font else { return };
        let screen = context.viewport_rect();
        let primitives = context.tessellate(std::mem::take(&mut output.shapes), output.pixels_per_point);
        let mut frame = Frame::new(screen);
        primitives.into_iter().for_each(|primitive| frame.add(primitive));
        output.shapes = frame.shapes(self, font);
    }
}

/// The draw list of a frame.
struct Frame {
    screen: Rect,
    corners: Vec<Corner>,
    indices: Vec<u32>,
    parts: Vec<FramePart>,
}

enum FramePart {
    /// Index ranges of triangles, each with its clip rectangle.
    Run(Vec<(Rect, Range<u32>)>),
    /// A shape left to egui.
    Passthrough(ClippedShape),
}

impl Frame {
    fn new(screen: Rect) -> Self {
        Self { screen, corners: Vec::new(), indices: Vec::new(), parts: Vec::new() }
    }

    fn add(&mut self, ClippedPrimitive { clip_rect, primitive }: ClippedPrimitive) {
        let passthrough = |shape| FramePart::Passthrough(ClippedShape::new(clip_rect, shape));
        match primitive {
            Primitive::Mesh(mesh) if mesh.texture_id == TextureId::default() => {
                let (first, start) = (self.corners.len() as u32, self.indices.len() as u32);
                let clip = |at: Pos2| {
                    let share = (at - self.screen.min) / self.screen.size();
                    [2.0 * share.x - 1.0, 1.0 - 2.0 * share.y]
                };
                self.corners.extend(mesh.vertices.iter().map(|vertex| Corner {
                    clip: clip(vertex.pos),
                    uv: vertex.uv.into(),
                    color: vertex.color.to_array(),
                }));
                self.indices.extend(mesh.indices.iter().map(|index| first + index));
                let range = start..self.indices.len() as u32;
                match self.parts.last_mut() {
                    Some(FramePart::Run(run)) => run.push((clip_rect, range)),
                    _ => self.parts.push(FramePart::Run(vec![(clip_rect, range)])),
                }
            }
            Primitive::Mesh(mesh) => self.parts.push(passthrough(Shape::Mesh(mesh.into()))),
            Primitive::Callback(callback) => self.parts.push(passthrough(Shape::Callback(callback))),
        }
    }

    /// The shapes that replace the frame's.
    fn shapes(self, painter: &SoftPainter, font: &Font) -> Vec<ClippedShape> {
        let buffer = |label, contents, usage| {
            let filled = wgpu::util::BufferInitDescriptor { label: Some(label), contents, usage };
            painter.device.create_buffer_init(&filled)
        };
        let corners = buffer("corners", bytemuck::cast_slice(&self.corners), wgpu::BufferUsages::VERTEX);
        let indices = buffer("triangles", bytemuck::cast_slice(&self.indices), wgpu::BufferUsages::INDEX);
        let shape = |part| match part {
            FramePart::Passthrough(shape) => shape,
            FramePart::Run(run) => {
                let call = RunCallback {
                    pipeline: painter.pipeline.clone(),
                    font: font.bound.clone(),
                    corners: corners.clone(),
                    indices: indices.clone(),
                    run,
                };
                let callback = Callback::new_paint_callback(self.screen, call);
                ClippedShape::new(self.screen, callback)
            }
        };
        self.parts.into_iter().map(shape).collect()
    }
}

/// The callback that draws a run of triangles.
struct RunCallback {
    pipeline: wgpu::RenderPipeline,
    font: wgpu::BindGroup,
    corners: wgpu::Buffer,
    indices: wgpu::Buffer,
    run: Vec<(Rect, Range<u32>)>,
}

impl CallbackTrait for RunCallback {
    fn paint(
        &self,
        info: PaintCallbackInfo,
        pass: &mut wgpu::RenderPass<'static>,
        _resources: &CallbackResources,
    ) {
        let [width, height] = info.screen_size_px;
        pass.set_viewport(0.0, 0.0, width as f32, height as f32, 0.0, 1.0);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.font, &[]);
        pass.set_vertex_buffer(0, self.corners.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        for (clip, range) in &self.run {
            // Casts saturate: clip rectangles are clamped to the screen.
            let pixel = |side: f32, count: u32| ((side * info.pixels_per_point).round() as u32).min(count);
            let [left, right] = [clip.min.x, clip.max.x].map(|x| pixel(x, width));
            let [top, bottom] = [clip.min.y, clip.max.y].map(|y| pixel(y, height));
            if left < right && top < bottom {
                pass.set_scissor_rect(left, top, right - left, bottom - top);
                pass.draw_indexed(range.clone(), 0, 0..1);
            }
        }
    }
}

impl SoftPainter {
    fn new(state: &RenderState) -> Self {
        let device = state.device.clone();
        let module = device.create_shader_module(wgpu::include_wgsl!("soft_painter.wgsl"));
        let fragment = wgpu::ShaderStages::FRAGMENT;
        let entry =
            |binding, ty| wgpu::BindGroupLayoutEntry { binding, visibility: fragment, ty, count: None };
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("text"),
            entries: &[
                entry(
                    0,
                    wgpu::BindingType::Texture {
                        sample_type: wgpu::TextureSampleType::Float { filterable: true },
                        view_dimension: wgpu::TextureViewDimension::D2,
                        multisampled: false,
                    },
                ),
                entry(1, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)),
            ],
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("shapes"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let add = |src_factor, dst_factor| wgpu::BlendComponent {
            src_factor,
            dst_factor,
            operation: wgpu::BlendOperation::Add,
        };
        // Premultiplied alpha, as in egui's own shader.
        let blend = wgpu::BlendState {
            color: add(wgpu::BlendFactor::One, wgpu::BlendFactor::OneMinusSrcAlpha),
            alpha: add(wgpu::BlendFactor::OneMinusDstAlpha, wgpu::BlendFactor::One),
        };
        let corner = wgpu::VertexBufferLayout {
            array_stride: size_of::<Corner>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &wgpu::vertex_attr_array![0 => Float32x2, 1 => Float32x2, 2 => Unorm8x4],
        };
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("shapes"),
            layout: Some(&pipeline_layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("shape_vertex"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[Some(corner)],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("shape_color"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(wgpu::ColorTargetState {
                    format: state.target_format,
                    blend: Some(blend),
                    write_mask: wgpu::ColorWrites::ALL,
                })],
            }),
            multiview_mask: None,
            cache: None,
        });
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("text"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        Self { device, queue: state.queue.clone(), layout, pipeline, sampler, font: None }
    }

    /// Replaces or updates the font atlas.
    fn take_font(&mut self, delta: &ImageDelta) {
        let ImageData::Color(image) = &delta.image;
        let [width, height] = image.size.map(|side| side as u32);
        let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
        let origin = match delta.pos {
            Some([x, y]) => wgpu::Origin3d { x: x as u32, y: y as u32, z: 0 },
            None => {
                self.font = Some(self.font(size));
                wgpu::Origin3d::ZERO
            }
        };
        let Some(font) = &self.font else { return };
        let texels: Vec<[u8; 4]> = image.pixels.iter().map(|color| color.to_array()).collect();
        let place = wgpu::TexelCopyTextureInfo {
            texture: &font.texture,
            mip_level: 0,
            origin,
            aspect: wgpu::TextureAspect::All,
        };
        let rows = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(width * size_of::<[u8; 4]>() as u32),
            rows_per_image: None,
        };
        self.queue.write_texture(place, texels.as_flattened(), rows, size);
    }

    fn font(&self, size: wgpu::Extent3d) -> Font {
        let texture = self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("text"),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8Unorm,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let bound = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("text"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&view) },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(&self.sampler) },
            ],
        });
        Font { texture, bound }
    }
}
