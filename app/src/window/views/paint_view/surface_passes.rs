//! The two passes of the paint view: geometry (the visible surface), and shading (its colours).

use super::SurfaceMesh;
use std::ops::Range;

/// Format of the picture: encoded for the screen.
pub const COLOR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
/// Atlas positions need the precision of f32.
const ATLAS_POSITION_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;
const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// The visible surface at every pixel: colour, atlas position and depth.
pub struct GBuffer {
    color: wgpu::TextureView,
    atlas_position: wgpu::TextureView,
    depth: wgpu::TextureView,
}

impl GBuffer {
    /// Empty buffers of this size, px.
    pub fn new(device: &wgpu::Device, size: [u32; 2]) -> Self {
        let view = |label, format, usage| {
            let texture = target_texture(device, label, format, size, usage);
            texture.create_view(&wgpu::TextureViewDescriptor::default())
        };
        let read = wgpu::TextureUsages::TEXTURE_BINDING;
        Self {
            color: view("surface colour", COLOR_FORMAT, read),
            atlas_position: view("surface place", ATLAS_POSITION_FORMAT, read),
            depth: view("surface depth", DEPTH_FORMAT, wgpu::TextureUsages::empty()),
        }
    }
}

/// A texture used as a render target.
pub fn target_texture(
    device: &wgpu::Device,
    label: &str,
    format: wgpu::TextureFormat,
    [width, height]: [u32; 2],
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | usage,
        view_formats: &[],
    })
}

/// The pipelines of the passes.
pub struct Passes {
    frame_layout: wgpu::BindGroupLayout,
    color_layout: wgpu::BindGroupLayout,
    geometry_pipeline: wgpu::RenderPipeline,
    color_pipeline: wgpu::RenderPipeline,
}

impl Passes {
    /// Builds the pipelines.
    pub fn new(device: &wgpu::Device) -> Self {
        let module = device.create_shader_module(wgpu::include_wgsl!("surface.wgsl"));
        let uniform = wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Uniform,
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        };
        let texture = |binding| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty: wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Float { filterable: false },
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: false,
            },
            count: None,
        };
        let layout = |label, entries: &[wgpu::BindGroupLayoutEntry]| {
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries })
        };
        let frame_layout = layout("surface frame", &[uniform]);
        let color_layout = layout("surface colours", &[uniform, texture(1), texture(2), texture(3)]);
        let geometry_pipeline = create_geometry_pipeline(device, &module, &frame_layout);
        let color_pipeline = create_shading_pipeline(device, &module, &color_layout);
        Self { frame_layout, color_layout, geometry_pipeline, color_pipeline }
    }

    /// First pass: `mesh` draws the visible surface into the G-buffer.
    pub fn draw_geometry(
        &self,
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
        frame: &wgpu::Buffer,
        gbuffer: &GBuffer,
        mesh: impl FnOnce(&mut wgpu::RenderPass<'_>),
    ) {
        let bound = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("surface frame"),
            layout: &self.frame_layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: frame.as_entire_binding() }],
        });
        let cleared = |view| {
            Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("surface"),
            color_attachments: &[cleared(&gbuffer.color), cleared(&gbuffer.atlas_position)],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &gbuffer.depth,
                // Reversed depth: 0 is at infinity.
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&self.geometry_pipeline);
        pass.set_bind_group(0, &bound, &[]);
        mesh(&mut pass);
    }

    /// Second pass: shades a rectangle from frame, focus map and G-buffer.
    pub fn shade(
        &self,
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
        (frame, focus, gbuffer): (&wgpu::Buffer, &wgpu::TextureView, &GBuffer),
        color: &wgpu::TextureView,
        [columns, rows]: &[Range<u32>; 2],
    ) {
        if columns.is_empty() || rows.is_empty() {
            return;
        }
        let view = |binding, view| wgpu::BindGroupEntry {
            binding,
            resource: wgpu::BindingResource::TextureView(view),
        };
        let bound = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("surface colours"),
            layout: &self.color_layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: frame.as_entire_binding() },
                view(1, focus),
                view(2, &gbuffer.color),
                view(3, &gbuffer.atlas_position),
            ],
        });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("surface colours"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: color,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store },
            })],
            ..Default::default()
        });
        pass.set_pipeline(&self.color_pipeline);
        pass.set_bind_group(0, &bound, &[]);
        pass.set_scissor_rect(columns.start, rows.start, columns.len() as u32, rows.len() as u32);
        pass.draw(0..3, 0..1);
    }
}

fn create_geometry_pipeline(
    device: &wgpu::Device,
    module: &wgpu::ShaderModule,
    frame_layout: &wgpu::BindGroupLayout,
) -> wgpu::RenderPipeline {
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("surface"),
        bind_group_layouts: &[Some(frame_layout), Some(&SurfaceMesh::material_layout(device))],
        immediate_size: 0,
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("surface"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some("surface_vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[Some(SurfaceMesh::corner_layout())],
        },
        // Both sides are drawn: both can be painted.
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Greater),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some("geometry_fragment"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(COLOR_FORMAT.into()), Some(ATLAS_POSITION_FORMAT.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}

fn create_shading_pipeline(
    device: &wgpu::Device,
    module: &wgpu::ShaderModule,
    color_layout: &wgpu::BindGroupLayout,
) -> wgpu::RenderPipeline {
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("surface colours"),
        bind_group_layouts: &[Some(color_layout)],
        immediate_size: 0,
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("surface colours"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some("screen_vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some("color_fragment"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(COLOR_FORMAT.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}
