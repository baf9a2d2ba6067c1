//! Compute passes and what they are bound to.

use std::sync::OnceLock;
use wgpu::{BindGroupLayout, BufferBindingType, ComputePipeline, Device, ShaderModule};

/// One pass, compiled when it is first needed.
pub struct Pass {
    module: ShaderModule,
    layout: BindGroupLayout,
    entry: &'static str,
    constants: Vec<(&'static str, f64)>,
    pipeline: OnceLock<ComputePipeline>,
}

impl Pass {
    /// The pass of a module that begins at the function `entry`, with these values of the module's overridable constants.
    pub fn new(
        module: &ShaderModule,
        layout: &BindGroupLayout,
        entry: &'static str,
        constants: &[(&'static str, f64)],
    ) -> Self {
        let (module, layout, constants) = (module.clone(), layout.clone(), constants.to_vec());
        Self { module, layout, entry, constants, pipeline: OnceLock::new() }
    }

    /// The compiled pipeline of the pass; it is compiled on first use.
    pub fn pipeline(&self, device: &Device) -> &ComputePipeline {
        self.pipeline.get_or_init(|| {
            let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(self.entry),
                bind_group_layouts: &[Some(&self.layout)],
                ..wgpu::PipelineLayoutDescriptor::default()
            });
            device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(self.entry),
                layout: Some(&layout),
                module: &self.module,
                entry_point: Some(self.entry),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants: &self.constants,
                    ..wgpu::PipelineCompilationOptions::default()
                },
                cache: None,
            })
        })
    }
}

/// What a binding is.
#[derive(Clone, Copy)]
pub enum Bound {
    /// A storage buffer that is read.
    Read,
    /// A storage buffer that is written.
    Write,
    /// A uniform buffer.
    Uniform,
}

/// A module of a shader's WGSL.
pub fn shader_module(device: &Device, name: &'static str, source: String) -> ShaderModule {
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(name),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    })
}

/// The layout of a compute pass's buffers, by binding.
pub fn bind_group_layout(device: &Device, bound: impl IntoIterator<Item = (u32, Bound)>) -> BindGroupLayout {
    let entry = |(binding, bound)| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer {
            ty: match bound {
                Bound::Read => BufferBindingType::Storage { read_only: true },
                Bound::Write => BufferBindingType::Storage { read_only: false },
                Bound::Uniform => BufferBindingType::Uniform,
            },
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    };
    let entries: Vec<_> = bound.into_iter().map(entry).collect();
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries })
}
