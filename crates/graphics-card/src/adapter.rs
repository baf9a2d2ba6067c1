//! Choosing the graphics card.

use crate::Gpu;
use wgpu::{Adapter, Backends, DeviceType, Instance};

/// What is to be computed on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BackendChoice {
    /// A hardware graphics card if there is one, else the processor.
    #[default]
    Auto,
    /// The processor.
    Cpu,
    /// Any adapter, also one in software.
    Gpu,
}

/// An adapter, in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AdapterDescription {
    /// What its driver calls it.
    pub name: String,
    /// Discrete, integrated, virtual or CPU.
    pub kind: String,
    /// The interface it is reached by.
    pub interface: String,
    /// Whether [`BackendChoice::Auto`] would use it.
    pub is_used: bool,
}

/// How a machine without a driver gets one.
const DRIVER_ADVICE: &str = if cfg!(target_os = "linux") {
    "install a Vulkan driver; the package mesa-vulkan-drivers has one in software"
} else {
    "install the driver of the graphics card's maker"
};

/// Why nothing can be computed on a graphics card.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GpuAbsent {
    /// There is none.
    #[error("no GPU was found ({})", DRIVER_ADVICE)]
    NoAdapter,
    /// None of that name.
    #[error("no GPU's name contains \"{0}\" (focus-brush doctor lists what there is)")]
    NoMatchingName(String),
    /// It does not work.
    #[error("the GPU {name} cannot be used: {why} (use --backend cpu)")]
    Unusable {
        /// What its driver calls it.
        name: String,
        /// The driver's message.
        why: String,
    },
}

/// All adapters, in order of preference: the first would be used.
pub fn adapters() -> Vec<AdapterDescription> {
    let candidates = ranked(&instance(), None);
    let described = candidates.iter().enumerate().map(|(rank, adapter)| {
        let info = adapter.get_info();
        AdapterDescription {
            kind: kind(info.device_type).to_owned(),
            interface: info.backend.to_string(),
            is_used: rank == 0 && info.device_type != DeviceType::Cpu,
            name: info.name,
        }
    });
    described.collect()
}

impl Gpu {
    /// Whether the machine may have a card at all. Where it has none, drivers need not be woken, which takes a while and lets
    /// some of them complain on stderr.
    pub fn may_be_available() -> bool {
        let devices = ["/dev/dri", "/dev/nvidiactl", "/dev/kfd", "/dev/dxg"];
        !cfg!(target_os = "linux") || devices.iter().any(|device| std::path::Path::new(device).exists())
    }

    /// The card that `choice` wants; none where that is the processor. With `named` only adapters count whose name
    /// contains it, and then also those in software.
    ///
    /// # Errors
    /// If a card was requested, by choice or by name, and none can be used.
    pub fn open(choice: BackendChoice, named: Option<&str>) -> Result<Option<Self>, GpuAbsent> {
        if choice == BackendChoice::Cpu {
            return Ok(None);
        }
        let is_requested = choice == BackendChoice::Gpu || named.is_some();
        if !is_requested && !Self::may_be_available() {
            return Ok(None);
        }
        let Some(adapter) = ranked(&instance(), named).into_iter().next() else {
            return match (is_requested, named) {
                (false, _) => Ok(None),
                (true, Some(name)) => Err(GpuAbsent::NoMatchingName(name.to_owned())),
                (true, None) => Err(GpuAbsent::NoAdapter),
            };
        };
        if !is_requested && adapter.get_info().device_type == DeviceType::Cpu {
            return Ok(None);
        }
        match Self::new(&adapter) {
            Ok(gpu) => Ok(Some(gpu)),
            Err(why) if is_requested => Err(GpuAbsent::Unusable { name: adapter.get_info().name, why }),
            Err(_) => Ok(None),
        }
    }

    /// Another device of the card with this name, of which no more than these features are used; `None` if there is none. Results must not
    /// depend on them.
    pub fn with_features(name: &str, features: wgpu::Features) -> Option<Self> {
        ranked(&instance(), Some(name)).first().and_then(|adapter| Self::with(adapter, features).ok())
    }
}

/// Without OpenGL: asking for it makes drivers chatter on stderr.
fn instance() -> Instance {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = Backends::PRIMARY;
    Instance::new(descriptor)
}

/// Adapters whose name contains `named`, the fastest kind first.
fn ranked(instance: &Instance, named: Option<&str>) -> Vec<Adapter> {
    let mut candidates = pollster::block_on(instance.enumerate_adapters(Backends::PRIMARY));
    candidates.retain(|adapter| {
        named.is_none_or(|named| adapter.get_info().name.to_lowercase().contains(&named.to_lowercase()))
    });
    candidates.sort_by_key(|adapter| match adapter.get_info().device_type {
        DeviceType::DiscreteGpu => 0,
        DeviceType::IntegratedGpu => 1,
        DeviceType::VirtualGpu => 2,
        DeviceType::Other => 3,
        DeviceType::Cpu => 4,
    });
    candidates
}

fn kind(of: DeviceType) -> &'static str {
    match of {
        DeviceType::DiscreteGpu => "discrete",
        DeviceType::IntegratedGpu => "integrated",
        DeviceType::VirtualGpu => "virtual",
        DeviceType::Other => "other",
        DeviceType::Cpu => "cpu",
    }
}
