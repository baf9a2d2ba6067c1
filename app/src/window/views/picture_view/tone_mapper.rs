//! Shows the live picture of a graphics card without copying it back.

use crate::window::graphics::blit::{Blitter, Drawable};
use lens::Exposure;
use render::{Tone, ToneCurve};
use splat::PictureOnCard;
use std::ops::Range;

/// Exposes, tone maps and encodes pictures on the device that shows them.
pub struct ToneMapper {
    device: wgpu::Device,
    queue: wgpu::Queue,
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
}

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

impl ToneMapper {
    /// For pictures drawn by `blitter`.
    pub fn new(blitter: &Blitter) -> Self {
        let (device, queue) = (blitter.device().clone(), blitter.queue().clone());
        let module = device.create_shader_module(wgpu::include_wgsl!("develop.wgsl"));
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
            count: None,
        };
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("develop"),
            entries: &[
                entry(0, wgpu::BufferBindingType::Storage { read_only: true }),
                entry(1, wgpu::BufferBindingType::Uniform),
            ],
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("develop"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("develop"),
            layout: Some(&pipeline_layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("develop_vertex"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("develop"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(FORMAT.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        Self { device, queue, layout, pipeline }
    }

    /// A black picture to render into.
    pub fn picture(&self, blitter: &Blitter, [width, height]: [u32; 2]) -> Drawable {
        let texture = self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("developed picture"),
            size: wgpu::Extent3d { width: width.max(1), height: height.max(1), depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        });
        blitter.drawable(texture)
    }

    /// Tone maps columns and rows of a picture into `to`, made by [`Self::picture`] with the same size.
    pub fn tone_map(
        &self,
        from: &PictureOnCard,
        tone: Tone,
        to: &Drawable,
        [columns, rows]: &[Range<u32>; 2],
    ) {
        if columns.is_empty() || rows.is_empty() || from.size() != to.size() {
            return;
        }
        let curve = ToneCurve::ALL.iter().position(|curve| *curve == tone.display.curve).unwrap_or(0);
        let normalises = tone.exposure == Exposure::Normalise;
        let gain = tone.display.stops.exp2();
        let uniform_words = [from.size()[0], normalises.into(), curve as u32, gain.to_bits()];
        let uniform = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("tone"),
            size: size_of_val(&uniform_words) as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        self.queue.write_buffer(&uniform, 0, bytemuck::cast_slice(&uniform_words));
        let bind_group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("develop"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: from.pixels().as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: uniform.as_entire_binding() },
            ],
        });
        let view = to.texture().create_view(&wgpu::TextureViewDescriptor::default());
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("develop"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store },
                })],
                ..wgpu::RenderPassDescriptor::default()
            });
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &bind_group, &[]);
            pass.set_scissor_rect(columns.start, rows.start, columns.len() as u32, rows.len() as u32);
            pass.draw(0..3, 0..1);
        }
        self.queue.submit([encoder.finish()]);
    }
}
