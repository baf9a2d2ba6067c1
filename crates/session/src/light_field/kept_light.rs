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
struct Kept {
    tracer: Weak<Tracer>,
    world: World,
    rough: OnceLock<Arc<Irradiance>>,
    irradiance: OnceLock<Arc<Irradiance>>,
    work: Arc<SceneWork>,
}

/// Worlds that are kept of one scene: that one looks at, and that one turns back to.
const WORLDS: usize = 3;

fn all() -> MutexGuard<'static, Vec<Arc<Kept>>> {
    static ALL: Mutex<Vec<Arc<Kept>>> = Mutex::new(Vec::new());
    ALL.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Kept {
    fn is_of(&self, tracer: &Arc<Tracer>, world: &World) -> bool {
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
const ROUGH: IrradianceOptions = IrradianceOptions { patches: 6_000, rays: 32 };

impl Kept {
    fn known(&self, quality: LightQuality) -> Option<&Arc<Irradiance>> {
        let rough = || self.rough.get().filter(|_| quality == LightQuality::Rough);
        self.irradiance.get().or_else(rough)
    }
}

/// The irradiance, if it is there.
pub(super) fn known(tracer: &Arc<Tracer>, world: &World) -> Option<Arc<Irradiance>> {
    all().iter().find(|kept| kept.is_of(tracer, world))?.known(LightQuality::Rough).cloned()
}

/// The irradiance as soon as it is there.
pub(super) fn wait(
    tracer: &Arc<Tracer>,
    world: &World,
    quality: LightQuality,
    progress: &dyn Progress,
) -> Result<Arc<Irradiance>, Cancelled> {
    let kept = begun(tracer, world);
    match kept.work.wait(progress, || kept.known(quality).cloned())? {
        Some(irradiance) => Ok(irradiance),
        // Its thread is gone: here it is solved for once more.
        None => {
            let options = if quality == LightQuality::Rough { ROUGH } else { IrradianceOptions::default() };
            Irradiance::solve(&unknown(tracer, world.clone(), 1, 1), options, progress).map(Arc::new)
        }
    }
}

/// The irradiance that is solved for, from now on if it was not before.
fn begun(tracer: &Arc<Tracer>, world: &World) -> Arc<Kept> {
    let mut all = all();
    all.retain(|kept| kept.tracer.strong_count() > 0);
    if let Some(at) = all.iter().position(|kept| kept.is_of(tracer, world)) {
        let kept = all.remove(at);
        all.push(kept.clone());
        return kept;
    }
    let kept = Arc::new(Kept {
        tracer: Arc::downgrade(tracer),
        world: world.clone(),
        rough: OnceLock::new(),
        irradiance: OnceLock::new(),
        work: Arc::default(),
    });
    let of_scene = all.iter().filter(|other| Weak::ptr_eq(&other.tracer, &kept.tracer)).count();
    if of_scene >= WORLDS
        && let Some(oldest) = all.iter().position(|other| Weak::ptr_eq(&other.tracer, &kept.tracer))
    {
        all.remove(oldest);
    }
    all.push(kept.clone());
    let work = {
        let kept = kept.clone();
        move |tracer: &Arc<Tracer>, progress: &dyn Progress| {
            // Whoever waits learns that it ended without.
            let _ = solve(&kept, tracer, progress);
        }
    };
    kept.work.begin("light", tracer, OWN_REFERENCES, work);
    kept
}

/// References to the tracer that solving holds: the transport's.
const OWN_REFERENCES: usize = 1;

fn solve(kept: &Kept, tracer: &Arc<Tracer>, progress: &dyn Progress) -> Result<(), Cancelled> {
    let options = IrradianceOptions::default();
    let (scene, world) = (tracer.scene(), &kept.world);
    let file = light_file::FILES.file(|hash| light_file::add_origin(hash, scene, world, options));
    let found = file.as_ref().and_then(|file| light_file::FILES.read(file));
    if let Some(found) = found.and_then(|bytes| light_file::of_bytes(&bytes, scene, world, options)) {
        let _ = kept.irradiance.set(Arc::new(found));
        return Ok(());
    }
    let transport = unknown(tracer, kept.world.clone(), 1, 1);
    // The rough light comes first and is soon there.
    let rough = Irradiance::solve(&transport, ROUGH, &Stage::new(progress, 0.0, 0.0))?;
    let _ = kept.rough.set(Arc::new(rough));
    if !scene.views.is_empty() {
        // Photographs light it as soon as theirs is there: the bare surface is not looked at for long.
        return Ok(());
    }
    let fine = Irradiance::solve(&transport, options, progress)?;
    if let Some(file) = &file {
        light_file::FILES.write(file, &light_file::to_bytes(&fine));
    }
    let _ = kept.irradiance.set(Arc::new(fine));
    Ok(())
}

/// Light of a scene in a world of which nothing is known yet: this many paths and lights a point.
pub(super) fn unknown(tracer: &Arc<Tracer>, world: World, paths: u32, light_samples: u32) -> Transport {
    let single = tracer.scene().single_scattering;
    let scattering = if single { Scattering::Single } else { Scattering::Multiple };
    Transport::new(tracer.clone(), world, TransportOptions { paths, light_samples, scattering })
}
