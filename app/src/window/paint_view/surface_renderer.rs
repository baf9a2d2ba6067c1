//! Draws the surface into a texture that egui shows. Draws again only when something that it shows has changed.

use super::graphics::{GraphicsError, guarded};
use super::{FocusTexture, OrbitCamera, SurfaceMesh};
use crate::window::false_colour;
use bytemuck::{Pod, Zeroable};
use lens::Camera;

/// What the surface looks like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceLook {
    /// Share of the false colour of blur, in [0, 1]; the rest is the scene's own colour.
    pub focus_share: f32,
    /// Lines where the circle of confusion is 1, 4 and 16 px.
    pub contours: bool,
}

impl Default for SurfaceLook {
    fn default() -> Self {
        Self { focus_share: 0.65, contours: false }
    }
}

/// What one picture of the surface shows.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceFrame<'a> {
    /// From where it is looked at.
    pub view: &'a OrbitCamera,
    /// Whose blur is shown.
    pub shot: &'a Camera,
    /// How it looks.
    pub look: SurfaceLook,
    /// Columns and rows, px.
    pub size: [u32; 2],
    /// Counts changes of mesh and focus texture.
    pub revision: u64,
}

/// Twin of `Frame` in surface.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
struct FrameUniform {
    clip_from_scene: [[f32; 4]; 4],
    eye: [f32; 4],
    shot_axis: [f32; 4],
    optics: [f32; 4],
    look: [f32; 4],
    stops: [[f32; 4]; 7],
}

/// Where it is drawn, at the size of the view.
struct Target {
    color: wgpu::TextureView,
    multisampled: Option<wgpu::TextureView>,
    depth: wgpu::TextureView,
    size: [u32; 2],
}

/// Draws a [`SurfaceMesh`] in the false colours of a [`FocusTexture`].
pub struct SurfaceRenderer {
    device: wgpu::Device,
    queue: wgpu::Queue,
    pipeline: wgpu::RenderPipeline,
    frame_layout: wgpu::BindGroupLayout,
    frame_buffer: wgpu::Buffer,
    samples: u32,
    target: Option<Target>,
    drawn: Option<(FrameUniform, u64)>,
}

const COLOR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Encoded grey where no surface is: darker than the panels, so that the scene stands out.
const BACKGROUND: f64 = 0.125;

impl SurfaceRenderer {
    /// Builds the pipeline. Edges are smoothed where the adapter is a real graphics card.
    pub fn new(state: &egui_wgpu::RenderState) -> Result<Self, GraphicsError> {
        let (device, queue) = (state.device.clone(), state.queue.clone());
        let software = state.adapter.get_info().device_type == wgpu::DeviceType::Cpu;
        let samples = if software { 1 } else { 4 };
        let (pipeline, frame_layout, frame_buffer) = guarded(&device, || {
            let frame_layout = frame_layout(&device);
            let frame_buffer = device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("surface frame"),
                size: size_of::<FrameUniform>() as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            (create_pipeline(&device, &frame_layout, samples), frame_layout, frame_buffer)
        })?;
        Ok(Self { device, queue, pipeline, frame_layout, frame_buffer, samples, target: None, drawn: None })
    }

    /// The device that meshes and focus textures must be made for.
    pub fn device(&self) -> (&wgpu::Device, &wgpu::Queue) {
        (&self.device, &self.queue)
    }

    /// The picture of the last [`Self::draw`].
    pub fn view(&self) -> Option<&wgpu::TextureView> {
        self.target.as_ref().map(|target| &target.color)
    }

    /// Draws `mesh` in the colours of `focus`, unless the last picture still holds. Returns whether [`Self::view`] is a new
    /// texture.
    pub fn draw(
        &mut self,
        mesh: &SurfaceMesh,
        focus: &FocusTexture,
        shown: SurfaceFrame<'_>,
    ) -> Result<bool, GraphicsError> {
        let limit = self.device.limits().max_texture_dimension_2d;
        let size = shown.size.map(|side| side.clamp(1, limit));
        let frame = frame_uniform(mesh, focus, SurfaceFrame { size, ..shown });
        let resized = self.target.as_ref().is_none_or(|target| target.size != size);
        if !resized && self.drawn == Some((frame, shown.revision)) {
            return Ok(false);
        }
        if resized {
            self.target = Some(guarded(&self.device, || create_target(&self.device, size, self.samples))?);
        }
        let Some(target) = &self.target else { return Ok(false) };
        self.queue.write_buffer(&self.frame_buffer, 0, bytemuck::bytes_of(&frame));
        let bind_group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("surface frame"),
            layout: &self.frame_layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: self.frame_buffer.as_entire_binding() },
                wgpu::BindGroupEntry {
                    binding: 1,
                    resource: wgpu::BindingResource::TextureView(&focus.view()),
                },
            ],
        });
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let clear = wgpu::Color { r: BACKGROUND, g: BACKGROUND, b: BACKGROUND, a: 1.0 };
            let (attached, resolved) = match &target.multisampled {
                Some(multisampled) => (multisampled, Some(&target.color)),
                None => (&target.color, None),
            };
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("surface"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: attached,
                    depth_slice: None,
                    resolve_target: resolved,
                    ops: wgpu::Operations { load: wgpu::LoadOp::Clear(clear), store: wgpu::StoreOp::Store },
                })],
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &target.depth,
                    // Reverse depth: 0 is at infinity.
                    depth_ops: Some(wgpu::Operations {
                        load: wgpu::LoadOp::Clear(0.0),
                        store: wgpu::StoreOp::Discard,
                    }),
                    stencil_ops: None,
                }),
                ..Default::default()
            });
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &bind_group, &[]);
            mesh.draw(&mut pass);
        }
        self.queue.submit([encoder.finish()]);
        self.drawn = Some((frame, shown.revision));
        Ok(resized)
    }
}

fn frame_uniform(mesh: &SurfaceMesh, focus: &FocusTexture, shown: SurfaceFrame<'_>) -> FrameUniform {
    let SurfaceFrame { view, shot, look, size, .. } = shown;
    let aspect = size[0] as f64 / size[1] as f64;
    let clip = view.clip_from_world(mesh.origin, mesh.extent, aspect).as_mat4();
    let axis = shot.world_direction(glam::DVec3::Z);
    let optics = shot.optics();
    let (width, height) = focus.size();
    let stop = |[r, g, b]: [f32; 3]| [r, g, b, 1.0];
    FrameUniform {
        clip_from_scene: clip.to_cols_array_2d(),
        eye: (view.eye() - mesh.origin).as_vec3().extend(1.0).to_array(),
        shot_axis: axis.as_vec3().extend(axis.dot(mesh.origin - shot.position()) as f32).to_array(),
        optics: [
            optics.inverse_focus_distance as f32,
            (1.0 / optics.image_distance) as f32,
            2.0 * optics.splat_radius_px(1.0) as f32,
            false_colour::LARGEST_CIRCLE_PX.ln_1p() as f32,
        ],
        look: [look.focus_share, if look.contours { 1.0 } else { 0.0 }, width as f32, height as f32],
        stops: false_colour::STOPS.map(stop),
    }
}

fn frame_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("surface frame"),
        entries: &[
            wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
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
                    sample_type: wgpu::TextureSampleType::Float { filterable: false },
                    view_dimension: wgpu::TextureViewDimension::D2,
                    multisampled: false,
                },
                count: None,
            },
        ],
    })
}

fn create_pipeline(
    device: &wgpu::Device,
    frame_layout: &wgpu::BindGroupLayout,
    samples: u32,
) -> wgpu::RenderPipeline {
    let module = device.create_shader_module(wgpu::include_wgsl!("surface.wgsl"));
    let material_layout = SurfaceMesh::material_layout(device);
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("surface"),
        bind_group_layouts: &[Some(frame_layout), Some(&material_layout)],
        immediate_size: 0,
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("surface"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
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
        multisample: wgpu::MultisampleState { count: samples, ..Default::default() },
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("surface_fragment"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(COLOR_FORMAT.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}

fn create_target(device: &wgpu::Device, size: [u32; 2], samples: u32) -> Target {
    let texture = |label, format, sample_count, usage| {
        device
            .create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | usage,
                view_formats: &[],
            })
            .create_view(&wgpu::TextureViewDescriptor::default())
    };
    let shown = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC;
    let none = wgpu::TextureUsages::empty();
    Target {
        color: texture("surface", COLOR_FORMAT, 1, shown),
        multisampled: (samples > 1).then(|| texture("surface samples", COLOR_FORMAT, samples, none)),
        depth: texture("surface depth", DEPTH_FORMAT, samples, none),
        size,
    }
}
