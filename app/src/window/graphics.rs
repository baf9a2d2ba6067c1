//! The device that the window is drawn with.

use splat::{BackendChoice, Gpu};
use std::sync::Arc;

/// A device with the adapter's own limits of texture and buffer size: atlases and scenes are larger than the defaults.
pub fn graphics() -> egui_wgpu::WgpuConfiguration {
    #[cfg(target_os = "linux")]
    if let Some(existing) = behind_the_sums() {
        return egui_wgpu::WgpuConfiguration { wgpu_setup: existing.into(), ..Default::default() };
    }
    let mut setup = egui_wgpu::WgpuSetupCreateNew::without_display_handle();
    setup.device_descriptor = Arc::new(descriptor);
    egui_wgpu::WgpuConfiguration { wgpu_setup: setup.into(), ..Default::default() }
}

/// The device that the window is drawn with as one that pictures are summed on and shown from, without coming back; none where
/// the processor is to sum, or is better at it than an adapter in software.
///
/// # Errors
/// Why it cannot be used, where it was asked for.
pub fn summing(state: &egui_wgpu::RenderState, choice: BackendChoice) -> Result<Option<Gpu>, String> {
    let info = state.adapter.get_info();
    let is_wanted = match choice {
        BackendChoice::Auto => info.device_type != wgpu::DeviceType::Cpu && info.backend != wgpu::Backend::Gl,
        BackendChoice::Gpu => true,
        BackendChoice::Cpu => false,
    };
    if !is_wanted {
        return Ok(None);
    }
    match Gpu::of(state.device.clone(), state.queue.clone(), info.name.clone()) {
        Ok(gpu) => Ok(Some(gpu)),
        Err(why) if choice == BackendChoice::Gpu => Err(why.replace('\n', " ")),
        Err(_) => Ok(None),
    }
}

fn descriptor(adapter: &wgpu::Adapter) -> wgpu::DeviceDescriptor<'static> {
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

/// By how much the threads of an adapter in software stand back behind those that sum pictures: as far as work that has time.
#[cfg(target_os = "linux")]
const STANDS_BACK: i32 = 5;

/// A device of an adapter in software, if the machine has no graphics card: its threads stand back, so that what is painted
/// is summed first and drawn then. Threads inherit that from the one that makes the device.
#[cfg(target_os = "linux")]
fn behind_the_sums() -> Option<egui_wgpu::WgpuSetupExisting> {
    if Gpu::may_be_there() {
        return None;
    }
    let make = || {
        let setup = egui_wgpu::WgpuSetupCreateNew::without_display_handle();
        let backends = setup.instance_descriptor.backends;
        let instance = wgpu::Instance::new(setup.instance_descriptor);
        let adapters = pollster::block_on(instance.enumerate_adapters(backends));
        let is_software = |adapter: &wgpu::Adapter| adapter.get_info().device_type == wgpu::DeviceType::Cpu;
        let adapter = adapters.into_iter().find(is_software)?;
        rustix::process::nice(STANDS_BACK).ok()?;
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor(&adapter))).ok()?;
        Some(egui_wgpu::WgpuSetupExisting { instance, adapter, device, queue })
    };
    let thread = std::thread::Builder::new().name("graphics".into()).spawn(make);
    thread.ok()?.join().ok()?
}
