//! Irradiance of a scene, by world: no camera traces its bounces again.
//!
//! It is solved in the background and goes on whoever stops waiting: roughly first, for the pictures that come at once, then well.

use crate::disk_cache::DiskCache;
use crate::irradiance_file;
use crate::options::{LightOptions, LightQuality};
use crate::resources::Resources;
use jobs::{CancelToken, SharedTask};
use progress::{Cancelled, Progress, Stage};
use scene::World;
use slf::{Irradiance, IrradianceOptions, Transport, TransportOptions};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use trace::Tracer;

/// Worlds whose irradiance is kept: the one that is shown, and those that one turns back to.
const MAX_WORLDS: usize = 3;

/// Light of few patches and rays: in a fraction of a second.
const ROUGH_OPTIONS: IrradianceOptions = IrradianceOptions { patches: 6_000, rays: 32 };

/// The irradiance of one scene, by world; the world that was used last stands last.
#[derive(Default)]
pub(crate) struct IrradianceCache {
    worlds: Mutex<Vec<Arc<WorldIrradiance>>>,
}

/// The irradiance of a scene in a world.
struct WorldIrradiance {
    world: World,
    rough: OnceLock<Arc<Irradiance>>,
    fine: OnceLock<Arc<Irradiance>>,
    task: Arc<SharedTask>,
}

impl WorldIrradiance {
    fn available(&self, quality: LightQuality) -> Option<&Arc<Irradiance>> {
        let rough = || self.rough.get().filter(|_| quality == LightQuality::Rough);
        self.fine.get().or_else(rough)
    }
}

/// What irradiance is solved from beside the world.
pub(crate) struct IrradianceInputs<'a> {
    pub tracer: &'a Arc<Tracer>,
    pub options: LightOptions,
    pub resources: &'a Resources,
    /// Stops work in the background.
    pub cancel: &'a CancelToken,
}

impl IrradianceCache {
    /// The irradiance in `world`, if it is there.
    pub fn available(&self, world: &World) -> Option<Arc<Irradiance>> {
        let worlds = self.lock();
        worlds.iter().find(|entry| entry.world == *world)?.available(LightQuality::Rough).cloned()
    }

    /// The irradiance in `world` as soon as it is there, of at least `quality`.
    pub fn wait(
        &self,
        world: &World,
        quality: LightQuality,
        inputs: &IrradianceInputs,
        progress: &dyn Progress,
    ) -> Result<Arc<Irradiance>, Cancelled> {
        let entry = self.get_or_start(world, inputs);
        match entry.task.wait(progress, || entry.available(quality).cloned())? {
            Some(irradiance) => Ok(irradiance),
            // Its thread is gone: here it is solved once more.
            None => {
                let is_rough = quality == LightQuality::Rough;
                let options = if is_rough { ROUGH_OPTIONS } else { IrradianceOptions::default() };
                let transport = transport_without_cache(inputs.tracer, world.clone(), inputs.options, 1, 1);
                Irradiance::solve(&transport, options, progress).map(Arc::new)
            }
        }
    }

    /// The irradiance in `world`, which is solved from now on if it was not before.
    fn get_or_start(&self, world: &World, inputs: &IrradianceInputs) -> Arc<WorldIrradiance> {
        let mut worlds = self.lock();
        if let Some(index) = worlds.iter().position(|entry| entry.world == *world) {
            let entry = worlds.remove(index);
            worlds.push(entry.clone());
            return entry;
        }
        let entry = Arc::new(WorldIrradiance {
            world: world.clone(),
            rough: OnceLock::new(),
            fine: OnceLock::new(),
            task: Arc::new(SharedTask::new(inputs.cancel.clone())),
        });
        if worlds.len() >= MAX_WORLDS {
            worlds.remove(0);
        }
        worlds.push(entry.clone());
        drop(worlds);
        let work = {
            let (entry, tracer, options) = (entry.clone(), inputs.tracer.clone(), inputs.options);
            let cache = inputs.resources.cache.clone();
            move |progress: &dyn Progress| {
                // Whoever waits learns that it ended without.
                let _ = solve(&entry, &tracer, options, &cache, progress);
            }
        };
        entry.task.start(inputs.resources.background, "light", work);
        entry
    }

    /// A poisoned lock only means that a panic passed by: what it guards is always whole.
    fn lock(&self) -> MutexGuard<'_, Vec<Arc<WorldIrradiance>>> {
        self.worlds.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn solve(
    entry: &WorldIrradiance,
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
    if let Some(cached) = cached_bytes.and_then(from_bytes) {
        let _ = entry.fine.set(Arc::new(cached));
        return Ok(());
    }
    let transport = transport_without_cache(tracer, entry.world.clone(), light, 1, 1);
    // The rough light comes first and is soon there.
    let rough = Irradiance::solve(&transport, ROUGH_OPTIONS, &Stage::new(progress, 0.0, 0.0))?;
    let _ = entry.rough.set(Arc::new(rough));
    if !scene.views.is_empty() {
        // Photographs light it as soon as theirs is there: the bare surface is not looked at for long.
        return Ok(());
    }
    let fine = Irradiance::solve(&transport, options, progress)?;
    if let Some(file) = &file {
        file.write(&irradiance_file::to_bytes(&fine));
    }
    let _ = entry.fine.set(Arc::new(fine));
    Ok(())
}

/// Light of a scene in a world whose irradiance is not used: this many paths and light samples a point.
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
