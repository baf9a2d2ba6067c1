//! Irradiance that was solved for, by scene and world: no camera traces its bounces again.
//!
//! It is solved for on a thread of its own, which goes on whoever stops waiting, as long as the scene is open: roughly first, for the
//! pictures that come at once, then well.

use super::light_file;
use super::scene_work::SceneWork;
use progress::{Cancelled, Progress, Stage};
use scene::World;
use slf::{Irradiance, IrradianceOptions, Scattering, Transport, TransportOptions};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError, Weak};
use trace::Tracer;

/// The irradiance of a scene in a world.
struct CacheEntry {
    tracer: Weak<Tracer>,
    world: World,
    rough: OnceLock<Arc<Irradiance>>,
    irradiance: OnceLock<Arc<Irradiance>>,
    work: Arc<SceneWork>,
}

/// Worlds that are kept of one scene: that one looks at, and that one turns back to.
const MAX_WORLDS_PER_SCENE: usize = 3;

fn lock_cache() -> MutexGuard<'static, Vec<Arc<CacheEntry>>> {
    static CACHE: Mutex<Vec<Arc<CacheEntry>>> = Mutex::new(Vec::new());
    CACHE.lock().unwrap_or_else(PoisonError::into_inner)
}

impl CacheEntry {
    fn is_for(&self, tracer: &Arc<Tracer>, world: &World) -> bool {
        std::ptr::eq(self.tracer.as_ptr(), Arc::as_ptr(tracer)) && self.world == *world
    }
}

/// How well light is to be solved for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightQuality {
    /// Well enough for a picture that is soon replaced; better, if that is known.
    Rough,
    /// As well as what is kept for every camera tells it: at once, and off by what that is off.
    #[default]
    Fine,
    /// By paths that check what is kept: off by their noise alone, which falls with the root of their number.
    Refined {
        /// Each is a path for a point of surface that is asked alone, four a pixel.
        passes: u32,
    },
}

/// Light of few patches and rays: in a fraction of a second.
const ROUGH_OPTIONS: IrradianceOptions = IrradianceOptions { patches: 6_000, rays: 32 };

impl CacheEntry {
    fn available(&self, quality: LightQuality) -> Option<&Arc<Irradiance>> {
        let rough = || self.rough.get().filter(|_| quality == LightQuality::Rough);
        self.irradiance.get().or_else(rough)
    }
}

/// The irradiance, if it is there.
pub(super) fn available(tracer: &Arc<Tracer>, world: &World) -> Option<Arc<Irradiance>> {
    lock_cache().iter().find(|entry| entry.is_for(tracer, world))?.available(LightQuality::Rough).cloned()
}

/// The irradiance as soon as it is there.
pub(super) fn wait(
    tracer: &Arc<Tracer>,
    world: &World,
    quality: LightQuality,
    progress: &dyn Progress,
) -> Result<Arc<Irradiance>, Cancelled> {
    let entry = get_or_start(tracer, world);
    match entry.work.wait(progress, || entry.available(quality).cloned())? {
        Some(irradiance) => Ok(irradiance),
        // Its thread is gone: here it is solved for once more.
        None => {
            let options =
                if quality == LightQuality::Rough { ROUGH_OPTIONS } else { IrradianceOptions::default() };
            Irradiance::solve(&transport_without_cache(tracer, world.clone(), 1, 1), options, progress)
                .map(Arc::new)
        }
    }
}

/// The irradiance that is solved for, from now on if it was not before.
fn get_or_start(tracer: &Arc<Tracer>, world: &World) -> Arc<CacheEntry> {
    let mut cache = lock_cache();
    cache.retain(|entry| entry.tracer.strong_count() > 0);
    if let Some(index) = cache.iter().position(|entry| entry.is_for(tracer, world)) {
        let entry = cache.remove(index);
        cache.push(entry.clone());
        return entry;
    }
    let entry = Arc::new(CacheEntry {
        tracer: Arc::downgrade(tracer),
        world: world.clone(),
        rough: OnceLock::new(),
        irradiance: OnceLock::new(),
        work: Arc::default(),
    });
    let scene_count = cache.iter().filter(|other| Weak::ptr_eq(&other.tracer, &entry.tracer)).count();
    if scene_count >= MAX_WORLDS_PER_SCENE
        && let Some(oldest) = cache.iter().position(|other| Weak::ptr_eq(&other.tracer, &entry.tracer))
    {
        cache.remove(oldest);
    }
    cache.push(entry.clone());
    let work = {
        let entry = entry.clone();
        move |tracer: &Arc<Tracer>, progress: &dyn Progress| {
            // Whoever waits learns that it ended without.
            let _ = solve(&entry, tracer, progress);
        }
    };
    entry.work.begin("light", tracer, OWN_REFERENCES, work);
    entry
}

/// References to the tracer that solving holds: the transport's.
const OWN_REFERENCES: usize = 1;

fn solve(entry: &CacheEntry, tracer: &Arc<Tracer>, progress: &dyn Progress) -> Result<(), Cancelled> {
    let options = IrradianceOptions::default();
    let (scene, world) = (tracer.scene(), &entry.world);
    let file = light_file::DISK_CACHE.entry_path(|hash| light_file::hash_inputs(hash, scene, world, options));
    let cached_bytes = file.as_ref().and_then(|file| light_file::DISK_CACHE.read(file));
    if let Some(cached) = cached_bytes.and_then(|bytes| light_file::from_bytes(&bytes, scene, world, options))
    {
        let _ = entry.irradiance.set(Arc::new(cached));
        return Ok(());
    }
    let transport = transport_without_cache(tracer, entry.world.clone(), 1, 1);
    // The rough light comes first and is soon there.
    let rough = Irradiance::solve(&transport, ROUGH_OPTIONS, &Stage::new(progress, 0.0, 0.0))?;
    let _ = entry.rough.set(Arc::new(rough));
    if !scene.views.is_empty() {
        // Photographs light it as soon as theirs is there: the bare surface is not looked at for long.
        return Ok(());
    }
    let fine = Irradiance::solve(&transport, options, progress)?;
    if let Some(file) = &file {
        light_file::DISK_CACHE.write(file, &light_file::to_bytes(&fine));
    }
    let _ = entry.irradiance.set(Arc::new(fine));
    Ok(())
}

/// Light of a scene in a world of which nothing is known yet: this many paths and lights a point.
pub(super) fn transport_without_cache(
    tracer: &Arc<Tracer>,
    world: World,
    paths: u32,
    light_samples: u32,
) -> Transport {
    let single = tracer.scene().single_scattering;
    let scattering = if single { Scattering::Single } else { Scattering::Multiple };
    Transport::new(tracer.clone(), world, TransportOptions { paths, light_samples, scattering })
}
