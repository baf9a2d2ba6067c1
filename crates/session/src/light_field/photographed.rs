//! Light from photographs, by scene: made once, and kept from one run of the program to the next.

use super::scene_work::SceneWork;
use crate::document::{load_or_unwrap_atlas, photographs_hash};
use crate::error::SessionError;
use crate::kept_files::DiskCache;
use atlas::{Atlas, UnwrapOptions};
use progress::{Progress, Stage};
use scene::PhotoLookup;
use sha2::Digest;
use slf::{DirectPhotographs, PhotographError, PhotographLight, PhotographOptions};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError, Weak};
use trace::{Radiance, Tracer};

/// Light as it is looked up.
type PhotographRadiance = Arc<dyn Radiance + Send + Sync>;

/// The light of a scene; an error as it is shown.
struct CacheEntry {
    tracer: Weak<Tracer>,
    /// An atlas of the scene, if there is one by the time that it is needed.
    atlas: OnceLock<Arc<Atlas>>,
    has_begun: OnceLock<()>,
    file: OnceLock<Option<PathBuf>>,
    solved: OnceLock<Result<Arc<PhotographLight>, String>>,
    /// The same, looked up in the photographs, once that was asked for.
    direct: Mutex<Option<Arc<DirectPhotographs>>>,
    work: Arc<SceneWork>,
}

fn lock_cache() -> MutexGuard<'static, Vec<Arc<CacheEntry>>> {
    static CACHE: Mutex<Vec<Arc<CacheEntry>>> = Mutex::new(Vec::new());
    CACHE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What is kept of a scene.
fn entry_of(tracer: &Arc<Tracer>) -> Arc<CacheEntry> {
    let mut cache = lock_cache();
    cache.retain(|entry| entry.tracer.strong_count() > 0);
    if let Some(entry) = cache.iter().find(|kept| std::ptr::eq(kept.tracer.as_ptr(), Arc::as_ptr(tracer))) {
        return entry.clone();
    }
    let entry = Arc::new(CacheEntry {
        tracer: Arc::downgrade(tracer),
        atlas: OnceLock::new(),
        has_begun: OnceLock::new(),
        file: OnceLock::new(),
        solved: OnceLock::new(),
        direct: Mutex::new(None),
        work: Arc::default(),
    });
    cache.push(entry.clone());
    entry
}

/// Has the light of a scene that photographs light kept at the texels of an atlas; without one the scene is unwrapped for it.
pub(crate) fn set_atlas(tracer: &Arc<Tracer>, atlas: &Arc<Atlas>) {
    if !tracer.scene().views.is_empty() {
        let _ = entry_of(tracer).atlas.set(atlas.clone());
    }
}

/// The light, if the scene has photographs and it is there; nothing is begun.
pub(crate) fn if_solved(tracer: &Arc<Tracer>) -> Option<Arc<PhotographLight>> {
    if tracer.scene().views.is_empty() {
        return None;
    }
    entry_of(tracer).solved.get()?.as_ref().ok().cloned()
}

/// The light as the scene wants it looked up, if it is there; begun, if not.
pub(super) fn available_lookup(tracer: &Arc<Tracer>) -> Option<PhotographRadiance> {
    let entry = get_or_start(tracer);
    let light = entry.solved.get()?.as_ref().ok()?.clone();
    match tracer.scene().photo_lookup {
        PhotoLookup::Texels => Some(light),
        PhotoLookup::Direct => Some(entry.direct().clone()?),
    }
}

/// The same as soon as it is there.
pub(super) fn wait_for_lookup(
    tracer: &Arc<Tracer>,
    progress: &dyn Progress,
) -> Result<PhotographRadiance, SessionError> {
    let light = wait(tracer, progress)?;
    if tracer.scene().photo_lookup == PhotoLookup::Texels {
        return Ok(light);
    }
    let entry = entry_of(tracer);
    let mut direct = entry.direct();
    if direct.is_none() {
        let made = DirectPhotographs::load(light, &PhotographOptions::default(), progress);
        *direct = Some(Arc::new(made.map_err(|error| match error {
            PhotographError::Cancelled => SessionError::Cancelled,
            other => SessionError::BadInput(other.to_string()),
        })?));
    }
    let lookup: Option<PhotographRadiance> = direct.clone().map(|direct| -> PhotographRadiance { direct });
    lookup.ok_or_else(|| SessionError::Internal("photographs were not kept".into()))
}

impl CacheEntry {
    /// Where the light is kept, of the atlas that is known by now.
    fn file(&self, tracer: &Tracer) -> Option<&Path> {
        let cache_path = || {
            DISK_CACHE.entry_path(|hash| {
                hash.update(photographs_hash(tracer.scene()));
                let options = PhotographOptions::default();
                hash.update(format!("{options:?} {:?}", self.atlas.get().map(|atlas| &atlas.hash)));
            })
        };
        self.file.get_or_init(cache_path).as_deref()
    }

    fn direct(&self) -> MutexGuard<'_, Option<Arc<DirectPhotographs>>> {
        self.direct.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The light as soon as it is there.
pub(crate) fn wait(
    tracer: &Arc<Tracer>,
    progress: &dyn Progress,
) -> Result<Arc<PhotographLight>, SessionError> {
    let entry = get_or_start(tracer);
    let failed =
        || "light from photographs could not be made: a fault of the program (open the capture again)".into();
    let solved = entry.work.wait(progress, || entry.solved.get().cloned())?.unwrap_or_else(|| Err(failed()));
    solved.map_err(SessionError::BadInput)
}

/// Whether the light, kept at the texels of an atlas that is known, only has to be read.
pub(super) fn is_on_disk(tracer: &Arc<Tracer>) -> bool {
    let entry = entry_of(tracer);
    entry.atlas.get().is_some() && entry.file(tracer).is_some_and(Path::exists)
}

fn get_or_start(tracer: &Arc<Tracer>) -> Arc<CacheEntry> {
    let entry = entry_of(tracer);
    if entry.has_begun.set(()).is_ok() {
        let work = {
            let entry = entry.clone();
            move |tracer: &Arc<Tracer>, progress: &dyn Progress| {
                let _ = entry.solved.set(solve(&entry, tracer, progress));
            }
        };
        entry.work.begin("photographs", tracer, 0, work);
    }
    entry
}

/// Tens of megabytes each: some four bytes a texel and photograph that sees it.
const DISK_CACHE: DiskCache = DiskCache { name: "photographs", budget_bytes: 2 << 30 };

fn solve(
    entry: &CacheEntry,
    tracer: &Arc<Tracer>,
    progress: &dyn Progress,
) -> Result<Arc<PhotographLight>, String> {
    let scene = tracer.scene();
    let file = entry.file(tracer);
    let cached_bytes = file.and_then(|file| DISK_CACHE.read(file));
    if let Some(light) = cached_bytes.and_then(|bytes| PhotographLight::from_bytes(&bytes, tracer)) {
        return Ok(Arc::new(light));
    }
    // The share of unwrapping, where that is left to do.
    let (atlas, unwrapping) = match entry.atlas.get() {
        Some(atlas) => (atlas.clone(), 0.0),
        None => {
            let share = 0.3;
            let stage = Stage::named(progress, "unwrapping", 0.0, share);
            let made = load_or_unwrap_atlas(scene, &UnwrapOptions::default(), &stage);
            (Arc::new(made.map_err(|error| format!("{}: {error}", scene.path.display()))?), share)
        }
    };
    let (options, rest) = (PhotographOptions::default(), Stage::new(progress, unwrapping, 1.0));
    let made = PhotographLight::solve(tracer, &atlas, &scene.views, &options, &rest);
    let light = made.map_err(|error| error.to_string())?;
    if let Some(file) = file {
        DISK_CACHE.write(file, &light.to_bytes());
    }
    Ok(Arc::new(light))
}
