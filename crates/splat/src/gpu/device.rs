//! A graphics card in use.

use crate::gpu::passes::Passes;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use wgpu::{Adapter, Device, Features, Limits, PollType, Queue, SubmissionIndex};

/// The card is gone, or refuses to work on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lost;

/// A graphics card to sum on. Copies share it.
#[derive(Clone)]
pub struct Gpu(Arc<Card>);

impl std::fmt::Debug for Gpu {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Gpu({})", self.0.name)
    }
}

struct Card {
    device: Device,
    queue: Queue,
    name: String,
    is_lost: Arc<AtomicBool>,
    passes: Passes,
}

impl Gpu {
    /// Takes an adapter into use.
    ///
    /// # Errors
    /// What the driver said.
    pub(super) fn new(adapter: &Adapter) -> Result<Self, String> {
        Self::with(adapter, Self::features(adapter.features()))
    }

    /// The same with no more than these features.
    pub(super) fn with(adapter: &Adapter, required_features: Features) -> Result<Self, String> {
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("splat"),
            required_limits: Self::limits(&adapter.limits()),
            required_features,
            ..wgpu::DeviceDescriptor::default()
        };
        let requested = pollster::block_on(adapter.request_device(&descriptor));
        let (device, queue) = requested.map_err(|error| error.to_string())?;
        Self::of(device, queue, adapter.get_info().name)
    }

    /// What a device must hold that sums, of what its adapter does: portable limits, but large pictures where it holds them.
    pub fn limits(most: &Limits) -> Limits {
        Limits {
            max_storage_buffer_binding_size: most.max_storage_buffer_binding_size,
            max_buffer_size: most.max_buffer_size,
            ..Limits::default()
        }
    }

    /// What such a device may be asked for of what its adapter has: a clock, and sums over subgroups. Nothing depends on them.
    pub fn features(there: Features) -> Features {
        there & (Features::TIMESTAMP_QUERY | Features::SUBGROUP)
    }

    /// Takes a device into use that others use, too, as one that shows pictures does: they need not come back to be shown. Its
    /// errors are taken as its loss from then on.
    ///
    /// # Errors
    /// What the driver said.
    pub fn of(device: Device, queue: Queue, name: String) -> Result<Self, String> {
        let is_lost = Arc::new(AtomicBool::new(false));
        let (by_loss, by_error) = (is_lost.clone(), is_lost.clone());
        device.set_device_lost_callback(move |_, _| by_loss.store(true, Ordering::SeqCst));
        // Whatever it does not do, the processor does.
        device.on_uncaptured_error(Arc::new(move |_| by_error.store(true, Ordering::SeqCst)));
        let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
        let passes = Passes::new(&device);
        if let Some(error) = pollster::block_on(scope.pop()) {
            return Err(error.to_string());
        }
        let gpu = Self(Arc::new(Card { device, queue, name, is_lost, passes }));
        match gpu.rounds_alike() {
            Ok(true) => Ok(gpu),
            Ok(false) => {
                Err("it does not round as IEEE 754 says, and would not draw the same picture".into())
            }
            Err(Lost) => Err("it gives up when it is first asked for something".into()),
        }
    }

    /// What its driver calls it.
    pub fn name(&self) -> &str {
        &self.0.name
    }

    /// Whether both are one device.
    pub fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }

    /// Whether it no longer works.
    pub fn is_lost(&self) -> bool {
        self.0.is_lost.load(Ordering::SeqCst)
    }

    /// Gives the device back at once, as a driver does that crashes: what is summed on it goes on on the processor.
    pub fn destroy(&self) {
        self.0.device.destroy();
    }

    pub(super) fn device(&self) -> &Device {
        &self.0.device
    }

    pub(super) fn queue(&self) -> &Queue {
        &self.0.queue
    }

    pub(super) fn passes(&self) -> &Passes {
        &self.0.passes
    }

    /// The largest buffer that a pass can see whole.
    pub(super) fn largest_binding(&self) -> u64 {
        let limits = self.0.device.limits();
        limits.max_storage_buffer_binding_size.min(limits.max_buffer_size)
    }

    /// Waits until all that was asked for is done.
    pub(super) fn wait(&self) -> Result<(), Lost> {
        self.device().poll(PollType::wait_indefinitely()).map_err(|_| Lost)?;
        self.check()
    }

    /// Waits until this is done, and all before it.
    pub(super) fn wait_for(&self, asked_for: SubmissionIndex) -> Result<(), Lost> {
        let until = PollType::Wait { submission_index: Some(asked_for), timeout: None };
        self.device().poll(until).map_err(|_| Lost)?;
        self.check()
    }

    /// An error if it is lost.
    pub(super) fn check(&self) -> Result<(), Lost> {
        if self.is_lost() { Err(Lost) } else { Ok(()) }
    }
}
