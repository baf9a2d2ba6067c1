//! Irradiance of a scene, cached by world: no camera traces its bounces again.
//!
//! It is solved in the background, which continues when a caller stops waiting: roughly for immediate pictures, and finely as soon as somebody
//! asks for that.

use crate::disk_cache::{CacheEntry, DiskCache};
use crate::irradiance_file;
use crate::options::{LightOptions, LightQuality};
use crate::resources::Resources;
use jobs::{CancelToken, SharedTask};
use progress::{Cancelled, Progress};
use scene::World;
use slf::{Irradiance, IrradianceOptions, Transport, TransportOptions};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use trace::Tracer;

/// Worlds whose irradiance is cached: the one shown, and those that the user may return to.
const MAX_WORLDS: usize = 3;

/// Few patches and rays: solved in a fraction of a second.
const ROUGH_OPTIONS: IrradianceOptions = IrradianceOptions { patches: 3_000, rays: 24 };

/// The irradiance of one scene, by world, whatever its backdrop; the most recently used last.
#[derive(Default)]
pub(crate) struct IrradianceCache {
    worlds: Mutex<Vec<Arc<WorldIrradiance>>>,
}

/// Irradiance that is stored, and once more when its last owner drops it if light was gathered meanwhile.
struct StoredIrradiance {
    irradiance: Arc<Irradiance>,
    /// `None` if nothing is stored.
    file: Option<CacheEntry>,
    /// How much of it had been gathered when it was stored.
    stored_count: usize,
}

impl Drop for StoredIrradiance {
    fn drop(&mut self) {
        if let Some(file) = &self.file
            && self.irradiance.gathered().count() > self.stored_count
        {
            file.write(&irradiance_file::to_bytes(&self.irradiance));
        }
    }
}

/// The irradiance of a scene in a world.
struct WorldIrradiance {
    /// Its [lighting](World::lighting).
    world: World,
    rough: OnceLock<Arc<Irradiance>>,
    fine: OnceLock<Arc<StoredIrradiance>>,
    rough_task: OnceLock<Arc<SharedTask>>,
    fine_task: OnceLock<Arc<SharedTask>>,
}

impl WorldIrradiance {
    /// The task that solves for it, which is started if it was not before.
    fn start(self: &Arc<Self>, quality: LightQuality, inputs: &IrradianceInputs) -> &SharedTask {
        let task = if quality == LightQuality::Rough { &self.rough_task } else { &self.fine_task };
        let mut is_new = false;
        let task = task.get_or_init(|| {
            is_new = true;
            Arc::new(SharedTask::new(inputs.cancel.clone()))
        });
        if is_new {
            let (entry, tracer, options) = (self.clone(), inputs.tracer.clone(), inputs.options);
            let cache = inputs.resources.cache.clone();
            task.start(inputs.resources.background, "light", move |progress| {
                // Cancelled: the task ends without a result, which callers notice.
                let _ = solve_world(&entry, quality, &tracer, options, &cache, progress);
            });
        }
        task
    }

    fn available(&self, quality: LightQuality) -> Option<&Arc<Irradiance>> {
        let rough = || self.rough.get().filter(|_| quality == LightQuality::Rough);
        self.fine.get().map(|fine| &fine.irradiance).or_else(rough)
    }
}

/// What irradiance is solved from, besides the world.
pub(crate) struct IrradianceInputs<'a> {
    pub tracer: &'a Arc<Tracer>,
    pub options: LightOptions,
    pub resources: &'a Resources,
    /// Stops background work.
    pub cancel: &'a CancelToken,
}

impl IrradianceCache {
    /// The irradiance in `world`, of any quality, if it is solved; nothing is started.
    pub fn available(&self, world: &World) -> Option<Arc<Irradiance>> {
        let (worlds, world) = (self.lock(), world.lighting());
        worlds.iter().find(|entry| entry.world == world)?.available(LightQuality::Rough).cloned()
    }

    /// What is solved, for the same scene elsewhere.
    pub fn solved(&self) -> Self {
        let solved = |entry: &Arc<WorldIrradiance>| {
            Arc::new(WorldIrradiance {
                world: entry.world.clone(),
                rough: entry.rough.clone(),
                fine: entry.fine.clone(),
                rough_task: OnceLock::new(),
                fine_task: OnceLock::new(),
            })
        };
        let worlds = self.lock().iter().map(solved).collect();
        Self { worlds: Mutex::new(worlds) }
    }

    /// The memory of all solutions, in bytes.
    pub fn bytes(&self) -> usize {
        let solutions = |entry: &Arc<WorldIrradiance>| -> usize {
            let fine = entry.fine.get().map(|fine| &fine.irradiance);
            entry.rough.get().into_iter().chain(fine).map(|irradiance| irradiance.bytes()).sum()
        };
        self.lock().iter().map(solutions).sum()
    }

    /// Starts solving for the rough irradiance in `world` in the background, if nobody has.
    pub fn start_rough(&self, world: &World, inputs: &IrradianceInputs) {
        self.entry(world).start(LightQuality::Rough, inputs);
    }

    /// Waits for the irradiance in `world`, of at least `quality`, and starts solving it if nobody has.
    ///
    /// # Errors
    /// [`Cancelled`] if `progress` asks to stop.
    pub fn wait(
        &self,
        world: &World,
        quality: LightQuality,
        inputs: &IrradianceInputs,
        progress: &dyn Progress,
    ) -> Result<Arc<Irradiance>, Cancelled> {
        let entry = self.entry(world);
        if let Some(irradiance) = entry.available(quality) {
            return Ok(irradiance.clone());
        }
        let task = entry.start(quality, inputs);
        match task.wait(progress, || entry.available(quality).cloned())? {
            Some(irradiance) => Ok(irradiance),
            // Its thread failed: it is solved here instead.
            None => {
                let is_rough = quality == LightQuality::Rough;
                let options = if is_rough { ROUGH_OPTIONS } else { IrradianceOptions::default() };
                let transport = transport_without_cache(inputs.tracer, world.clone(), inputs.options, 1, 1);
                Irradiance::solve(&transport, options, progress).map(Arc::new)
            }
        }
    }

    /// The entry of a world, from now on the most recently used.
    fn entry(&self, world: &World) -> Arc<WorldIrradiance> {
        let (mut worlds, world) = (self.lock(), world.lighting());
        if let Some(index) = worlds.iter().position(|entry| entry.world == world) {
            let entry = worlds.remove(index);
            worlds.push(entry.clone());
            return entry;
        }
        let entry = Arc::new(WorldIrradiance {
            world,
            rough: OnceLock::new(),
            fine: OnceLock::new(),
            rough_task: OnceLock::new(),
            fine_task: OnceLock::new(),
        });
        if worlds.len() >= MAX_WORLDS {
            worlds.remove(0);
        }
        worlds.push(entry.clone());
        entry
    }

    /// Ignores poisoning: the guarded value is always consistent.
    fn lock(&self) -> MutexGuard<'_, Vec<Arc<WorldIrradiance>>> {
        self.worlds.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn solve_world(
    entry: &WorldIrradiance,
    quality: LightQuality,
    tracer: &Arc<Tracer>,
    light: LightOptions,
    cache: &DiskCache,
    progress: &dyn Progress,
) -> Result<(), Cancelled> {
    let options = IrradianceOptions::default();
    let (scene, world) = (tracer.scene(), &entry.world);
    let file = cache.entry(irradiance_file::SECTION, |hash| {
        irradiance_file::hash_inputs(hash, scene, world, light, options);
    });
    let cached_bytes = file.as_ref().and_then(|file| file.read());
    let from_bytes = |bytes: Vec<u8>| irradiance_file::from_bytes(&bytes, scene, world, options);
    let set_fine = |irradiance: Irradiance| {
        let (irradiance, file) = (Arc::new(irradiance), file.clone());
        let stored_count = irradiance.gathered().count();
        let _ = entry.fine.set(Arc::new(StoredIrradiance { irradiance, file, stored_count }));
    };
    if let Some(cached) = cached_bytes.and_then(from_bytes) {
        set_fine(cached);
        return Ok(());
    }
    let transport = transport_without_cache(tracer, entry.world.clone(), light, 1, 1);
    if quality == LightQuality::Rough {
        let _ = entry.rough.set(Arc::new(Irradiance::solve(&transport, ROUGH_OPTIONS, progress)?));
        return Ok(());
    }
    let fine = Irradiance::solve(&transport, options, progress)?;
    if let Some(file) = &file {
        file.write(&irradiance_file::to_bytes(&fine));
    }
    set_fine(fine);
    Ok(())
}

/// Light of a scene in a world without cached irradiance, with this many paths and light samples per point.
pub(crate) fn transport_without_cache(
    tracer: &Arc<Tracer>,
    world: World,
    options: LightOptions,
    paths: u32,
    light_samples: u32,
) -> Transport {
    let LightOptions { scattering, .. } = options;
    Transport::new(tracer.clone(), world, TransportOptions { paths, light_samples, scattering })
}
