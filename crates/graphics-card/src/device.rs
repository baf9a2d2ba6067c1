//! A graphics card in use.

use crate::cache::Cache;
use std::any::Any;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::sync::{Arc, OnceLock};
use std::time::Duration;
use wgpu::{Adapter, Device, Features, Limits, PollError, PollType, Queue, SubmissionIndex};

/// The longest single wait for a device: others who show pictures on it wait as long.
const MOMENT: Duration = Duration::from_millis(1);

/// A device that does not answer for this many moments, ten seconds, is lost.
const MAX_MOMENTS: usize = 10_000;

/// The card is gone, or refuses to work on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lost;

/// A graphics card to compute on. Copies share it.
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
    /// Why it no longer works, once it does not.
    lost: Arc<OnceLock<String>>,
    cache: Cache,
}

impl Gpu {
    /// Takes an adapter into use.
    ///
    /// # Errors
    /// The driver's message.
    pub(crate) fn new(adapter: &Adapter) -> Result<Self, String> {
        Self::with(adapter, Self::features(adapter.features()))
    }

    /// The same with no more than these features.
    pub(crate) fn with(adapter: &Adapter, required_features: Features) -> Result<Self, String> {
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("compute"),
            required_limits: Self::limits(&adapter.limits()),
            required_features,
            ..wgpu::DeviceDescriptor::default()
        };
        let requested = pollster::block_on(adapter.request_device(&descriptor));
        let (device, queue) = requested.map_err(|error| error.to_string())?;
        Self::from_device(device, queue, adapter.get_info().name)
    }

    /// What a device must hold that computes, of what its adapter does: portable limits, but large pictures where it holds them.
    pub fn limits(most: &Limits) -> Limits {
        Limits {
            max_storage_buffer_binding_size: most.max_storage_buffer_binding_size,
            max_buffer_size: most.max_buffer_size,
            ..Limits::default()
        }
    }

    /// Optional features to request from an adapter: a clock, and sums over subgroups. Results do not depend on them.
    pub fn features(available: Features) -> Features {
        available & (Features::TIMESTAMP_QUERY | Features::SUBGROUP)
    }

    /// Takes a device into use that others use, too, as one that shows pictures does: they need not come back to be shown. Its
    /// errors are taken as its loss from then on.
    ///
    /// # Errors
    /// The driver's message.
    pub fn from_device(device: Device, queue: Queue, name: String) -> Result<Self, String> {
        let lost = Arc::new(OnceLock::new());
        let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
        let gpu = Self(Arc::new(Card { device, queue, name, lost: lost.clone(), cache: Cache::default() }));
        let rounds_alike = gpu.rounds_alike();
        if let Some(error) = pollster::block_on(scope.pop()) {
            return Err(error.to_string());
        }
        match rounds_alike {
            Ok(true) => {}
            Ok(false) => {
                return Err("it does not round as IEEE 754 says, and would not draw the same picture".into());
            }
            Err(Lost) => return Err("it fails at its first task".into()),
        }
        // Whatever it does not do, the processor does. The first reason counts.
        let by_error = lost.clone();
        gpu.device().set_device_lost_callback(move |_, message| {
            let _ = lost.set(message);
        });
        gpu.device().on_uncaptured_error(Arc::new(move |error| {
            let _ = by_error.set(error.to_string());
        }));
        Ok(gpu)
    }

    /// The card's name, as its driver calls it.
    pub fn name(&self) -> &str {
        &self.0.name
    }

    /// Whether it is the processor that computes, in the name of a card.
    pub fn is_in_software(&self) -> bool {
        self.0.device.adapter_info().device_type == wgpu::DeviceType::Cpu
    }

    /// Whether both are the same device.
    pub fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }

    /// Whether the card no longer works.
    pub fn is_lost(&self) -> bool {
        self.why_lost().is_some()
    }

    /// Why the card no longer works, in its driver's words; `None` while it does.
    pub fn why_lost(&self) -> Option<&str> {
        // A driver that is asked for nothing does not tell. What the poll itself returns, waiting work finds out.
        let _ = self.device().poll(PollType::Poll);
        self.0.lost.get().map(String::as_str)
    }

    /// Destroys the device at once, as a driver crash would: work continues on the processor.
    pub fn destroy(&self) {
        self.0.device.destroy();
        // Its callback waits until what was submitted is done.
        let _ = self.0.lost.set("it was destroyed".into());
    }

    /// The device.
    pub fn device(&self) -> &Device {
        &self.0.device
    }

    /// Where work is submitted.
    pub fn queue(&self) -> &Queue {
        &self.0.queue
    }

    /// The card's value of this type, made when it is first asked for: compute passes are, so that they are compiled once.
    pub fn cached<T: Any + Send + Sync>(&self, make: impl FnOnce(&Device) -> T) -> Arc<T> {
        self.0.cache.get(|| make(&self.0.device))
    }

    /// The largest buffer that a pass can bind.
    pub fn largest_binding(&self) -> u64 {
        let limits = self.0.device.limits();
        limits.max_storage_buffer_binding_size.min(limits.max_buffer_size)
    }

    /// Waits until this is done, and all before it: a moment at a time, for nobody else can show anything meanwhile.
    ///
    /// # Errors
    /// The card is lost.
    pub fn wait_for(&self, submission: SubmissionIndex) -> Result<(), Lost> {
        loop {
            self.check()?;
            let until = PollType::Wait { submission_index: Some(submission.clone()), timeout: Some(MOMENT) };
            match self.device().poll(until) {
                Ok(_) => return self.check(),
                Err(PollError::Timeout) => std::thread::yield_now(),
                Err(PollError::WrongSubmissionIndex(..)) => return Err(Lost),
            }
        }
    }

    /// What a callback of the device sends about work that is done; another thread may be told that it is, first. A device
    /// that stays silent is lost.
    pub(crate) fn receive<T>(&self, receiver: &Receiver<T>) -> Result<T, Lost> {
        for _ in 0..MAX_MOMENTS {
            match receiver.recv_timeout(MOMENT) {
                Ok(answer) => return Ok(answer),
                Err(RecvTimeoutError::Disconnected) => return Err(Lost),
                Err(RecvTimeoutError::Timeout) => self.check()?,
            }
            self.device().poll(PollType::Poll).map_err(|_| Lost)?;
        }
        let _ = self.0.lost.set("it no longer answers".into());
        Err(Lost)
    }

    /// Whether it still works.
    ///
    /// # Errors
    /// The card is lost.
    pub fn check(&self) -> Result<(), Lost> {
        if self.is_lost() { Err(Lost) } else { Ok(()) }
    }
}
