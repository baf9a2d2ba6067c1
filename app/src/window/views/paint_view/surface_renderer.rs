//! Draws the surface into a texture. The geometry pass runs only if the view changed; the shading pass only
//! where colours changed.

use super::device_errors::{GraphicsError, catch_device_errors};
use super::surface_passes::{COLOR_FORMAT, GBuffer, Passes, target_texture};
use super::{FocusTexture, OrbitCamera, SurfaceMesh};
use crate::window::view_settings::SurfaceAppearance;
use crate::window::widgets::false_colour;
use bytemuck::{Pod, Zeroable};
use lens::Camera;
use std::ops::Range;

/// Inputs of one drawn picture of the surface.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceFrame<'a> {
    /// The camera of the view.
    pub view: &'a OrbitCamera,
    /// The shot camera, whose blur is shown.
    pub shot: &'a Camera,
    /// Appearance of the surface.
    pub appearance: SurfaceAppearance,
    /// Columns and rows, px.
    pub size: [u32; 2],
}

/// Matches `Frame` in surface.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
struct FrameUniform {
    clip_from_scene: [[f32; 4]; 4],
    eye: [f32; 4],
    shot_axis: [f32; 4],
    optics: [f32; 4],
    appearance: [f32; 4],
    stops: [[f32; 4]; 7],
}

/// Render targets: G-buffer and colours.
struct Target {
    gbuffer: GBuffer,
    /// The shaded picture, of the same size.
    color: wgpu::Texture,
    color_view: wgpu::TextureView,
    size: [u32; 2],
}

/// The part of the last picture that is out of date.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub enum Stale {
    /// Nothing.
    #[default]
    Nothing,
    /// The colours of a rectangle, columns and rows of the view, px.
    Colors([Range<u32>; 2]),
    /// All colours.
    AllColors,
    /// Another mesh.
    Everything,
}

impl Stale {
    /// Adds another out-of-date part.
    pub fn join(&mut self, other: Self) {
        *self = match (std::mem::take(self), other) {
            (Self::Everything, _) | (_, Self::Everything) => Self::Everything,
            (Self::AllColors, _) | (_, Self::AllColors) => Self::AllColors,
            (Self::Colors(a), Self::Colors(b)) => Self::Colors(focus::rectangle_union(&a, &b)),
            (Self::Nothing, some) | (some, Self::Nothing) => some,
        }
    }
}

/// Draws a [`SurfaceMesh`] in the false colours of a [`FocusTexture`].
pub struct SurfaceRenderer {
    device: wgpu::Device,
    queue: wgpu::Queue,
    passes: Passes,
    frame_buffer: wgpu::Buffer,
    /// Whether the adapter is a software one.
    is_software: bool,
    target: Option<Target>,
    drawn: Option<FrameUniform>,
}

impl SurfaceRenderer {
    /// Builds the pipelines. Edges are supersampled unless the adapter is a software one.
    ///
    /// # Errors
    /// As [`catch_device_errors`].
    pub fn new(state: &egui_wgpu::RenderState) -> Result<Self, GraphicsError> {
        let (device, queue) = (state.device.clone(), state.queue.clone());
        let is_software = state.adapter.get_info().device_type == wgpu::DeviceType::Cpu;
        let (passes, frame_buffer) = catch_device_errors(&device, || {
            let frame_buffer = device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("surface frame"),
                size: size_of::<FrameUniform>() as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            (Passes::new(&device), frame_buffer)
        })?;
        Ok(Self { device, queue, passes, frame_buffer, is_software, target: None, drawn: None })
    }

    /// Whether the adapter is a software one: what is drawn takes the processor's time.
    pub fn is_software(&self) -> bool {
        self.is_software
    }

    /// Drawn pixels per side of a view pixel: supersampling smooths edges.
    fn pixels_a_side(&self) -> u32 {
        if self.is_software { 1 } else { 2 }
    }

    /// The device and queue to use for meshes and focus textures.
    pub fn device(&self) -> (&wgpu::Device, &wgpu::Queue) {
        (&self.device, &self.queue)
    }

    /// The picture of the last [`Self::draw`].
    pub fn picture(&self) -> Option<&wgpu::Texture> {
        self.target.as_ref().map(|target| &target.color)
    }

    /// Draws `mesh` in the colours of `focus`, updating only what is out of date; `stale` is the part affected
    /// by changes of mesh and focus. Returns whether [`Self::picture`] is a new texture.
    ///
    /// # Errors
    /// As [`catch_device_errors`].
    pub fn draw(
        &mut self,
        mesh: &SurfaceMesh,
        focus: &FocusTexture,
        shown: SurfaceFrame<'_>,
        stale: Stale,
    ) -> Result<bool, GraphicsError> {
        let limit = self.device.limits().max_texture_dimension_2d;
        let size = shown.size.map(|side| (side * self.pixels_a_side()).clamp(1, limit));
        let frame = frame_uniform(mesh, focus, SurfaceFrame { size, ..shown });
        let resized = self.target.as_ref().is_none_or(|target| target.size != size);
        let same_view = |drawn: &FrameUniform| {
            (drawn.clip_from_scene, drawn.eye, drawn.shot_axis)
                == (frame.clip_from_scene, frame.eye, frame.shot_axis)
        };
        let geometry_is_current =
            !resized && stale != Stale::Everything && self.drawn.as_ref().is_some_and(same_view);
        let rectangle = match &stale {
            _ if !geometry_is_current || self.drawn != Some(frame) => size.map(|side| 0..side),
            Stale::Nothing => return Ok(false),
            Stale::Colors(rectangle) => [0, 1].map(|axis| {
                let [start, end] = [rectangle[axis].start, rectangle[axis].end]
                    .map(|side| side.saturating_mul(self.pixels_a_side()).min(size[axis]));
                start..end
            }),
            Stale::AllColors | Stale::Everything => size.map(|side| 0..side),
        };
        if resized {
            self.target = Some(catch_device_errors(&self.device, || Target::new(&self.device, size))?);
        }
        let Some(target) = &self.target else { return Ok(false) };
        self.queue.write_buffer(&self.frame_buffer, 0, bytemuck::bytes_of(&frame));
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        if !geometry_is_current {
            self.passes.draw_geometry(
                &self.device,
                &mut encoder,
                &self.frame_buffer,
                &target.gbuffer,
                |pass| mesh.draw(pass),
            );
        }
        let inputs = (&self.frame_buffer, &focus.view(), &target.gbuffer);
        self.passes.shade(&self.device, &mut encoder, inputs, &target.color_view, &rectangle);
        self.queue.submit([encoder.finish()]);
        self.drawn = Some(frame);
        Ok(resized)
    }
}

impl Target {
    fn new(device: &wgpu::Device, size: [u32; 2]) -> Self {
        let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC;
        let color = target_texture(device, "surface", COLOR_FORMAT, size, usage);
        let color_view = color.create_view(&wgpu::TextureViewDescriptor::default());
        Self { gbuffer: GBuffer::new(device, size), color, color_view, size }
    }
}

fn frame_uniform(mesh: &SurfaceMesh, focus: &FocusTexture, shown: SurfaceFrame<'_>) -> FrameUniform {
    let SurfaceFrame { view, shot, appearance, size, .. } = shown;
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
        appearance: [
            appearance.focus_share,
            if appearance.contours { 1.0 } else { 0.0 },
            width as f32,
            height as f32,
        ],
        stops: false_colour::STOPS.map(stop),
    }
}
