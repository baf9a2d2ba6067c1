//! The graphics device of the window.

use graphics_card::{BackendChoice, Gpu};
use std::sync::Arc;

/// A device with the adapter's own limits of texture and buffer size: atlases and scenes are larger than the
/// defaults.
pub fn wgpu_configuration() -> egui_wgpu::WgpuConfiguration {
    #[cfg(target_os = "linux")]
    if let Some(existing) = low_priority_software_device() {
        return egui_wgpu::WgpuConfiguration { wgpu_setup: existing.into(), ..Default::default() };
    }
    let mut setup = egui_wgpu::WgpuSetupCreateNew::without_display_handle();
    setup.device_descriptor = Arc::new(device_descriptor);
    egui_wgpu::WgpuConfiguration { wgpu_setup: setup.into(), ..Default::default() }
}

/// The window's device for splatting, so that pictures are summed and shown without being copied back. `None`
/// if the processor is to be used, or if the adapter is a software one.
///
/// # Errors
/// Why the device cannot be used, if it was requested explicitly.
pub fn splat_device(state: &egui_wgpu::RenderState, choice: BackendChoice) -> Result<Option<Gpu>, String> {
    let info = state.adapter.get_info();
    let is_suitable = match choice {
        BackendChoice::Auto => info.device_type != wgpu::DeviceType::Cpu && info.backend != wgpu::Backend::Gl,
        BackendChoice::Gpu => true,
        BackendChoice::Cpu => false,
    };
    if !is_suitable {
        return Ok(None);
    }
    match Gpu::from_device(state.device.clone(), state.queue.clone(), info.name.clone()) {
        Ok(gpu) => Ok(Some(gpu)),
        Err(why) if choice == BackendChoice::Gpu => Err(why.replace('\n', " ")),
        Err(_) => Ok(None),
    }
}

fn device_descriptor(adapter: &wgpu::Adapter) -> wgpu::DeviceDescriptor<'static> {
    let mut limits = adapter.limits();
    if adapter.get_info().backend != wgpu::Backend::Gl {
        let max_texture_dimension_2d = limits.max_texture_dimension_2d;
        limits = wgpu::Limits { max_texture_dimension_2d, ..Gpu::limits(&limits) };
    }
    wgpu::DeviceDescriptor {
        label: Some("focus-brush"),
        required_limits: limits,
        required_features: Gpu::features(adapter.features()),
        ..Default::default()
    }
}

/// Niceness of the threads of a software adapter, relative to those that sum pictures: that of background work.
#[cfg(target_os = "linux")]
const NICENESS: i32 = 5;

/// A device of a software adapter, if the machine has no graphics card. Its threads have a lower priority, so
/// that strokes are summed before they are drawn; they inherit it from the thread that creates the device.
#[cfg(target_os = "linux")]
fn low_priority_software_device() -> Option<egui_wgpu::WgpuSetupExisting> {
    if Gpu::may_be_available() {
        return None;
    }
    let make = || {
        let setup = egui_wgpu::WgpuSetupCreateNew::without_display_handle();
        let backends = setup.instance_descriptor.backends;
        let instance = wgpu::Instance::new(setup.instance_descriptor);
        let adapters = pollster::block_on(instance.enumerate_adapters(backends));
        let is_software = |adapter: &wgpu::Adapter| adapter.get_info().device_type == wgpu::DeviceType::Cpu;
        let adapter = adapters.into_iter().find(is_software)?;
        rustix::process::nice(NICENESS).ok()?;
        let (device, queue) =
            pollster::block_on(adapter.request_device(&device_descriptor(&adapter))).ok()?;
        Some(egui_wgpu::WgpuSetupExisting { instance, adapter, device, queue })
    };
    let thread = std::thread::Builder::new().name("graphics".into()).spawn(make);
    thread.ok()?.join().ok()?
}
