//! Light of a scene from its photographs: solved once, and cached on disk.

use crate::atlas_cache::load_or_unwrap_atlas;
use crate::disk_cache::{CacheEntry, CacheSection, DiskCache};
use crate::error::LightError;
use crate::options::{LightOptions, PhotoLookup};
use crate::resources::Resources;
use crate::scene_hashes::photographs_hash;
use atlas::{Atlas, UnwrapOptions};
use jobs::{CancelToken, SharedTask};
use progress::{Progress, Stage};
use sha2::Digest;
use slf::{DirectPhotographs, PhotographLight, PhotographOptions};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use trace::{Radiance, Tracer};

/// A file takes tens of megabytes: about four bytes per texel and photograph in which the texel is visible.
const SECTION: CacheSection = CacheSection { name: "photographs", budget_bytes: 2 << 30 };

/// Light from photographs, as it is looked up.
type PhotographRadiance = Arc<dyn Radiance + Send + Sync>;

/// The light of one scene from its photographs.
pub(crate) struct PhotographLightCache {
    shared: Arc<SharedState>,
    tracer: Arc<Tracer>,
    lookup: PhotoLookup,
    resources: Resources,
}

/// State shared by the cache and its background task.
struct SharedState {
    /// An atlas of the scene, if one was set before it is needed.
    atlas: OnceLock<Arc<Atlas>>,
    has_begun: OnceLock<()>,
    file: OnceLock<Option<CacheEntry>>,
    /// The light, or the error message to show.
    solved: OnceLock<Result<Arc<PhotographLight>, String>>,
    /// The light looked up in the photographs, once it was requested.
    direct: Mutex<Option<Arc<DirectPhotographs>>>,
    task: Arc<SharedTask>,
}

impl PhotographLightCache {
    /// The light of the scene in `tracer`; nothing is started yet. `cancel` stops background work.
    pub fn new(
        tracer: &Arc<Tracer>,
        options: LightOptions,
        resources: &Resources,
        cancel: &CancelToken,
    ) -> Self {
        let shared = SharedState {
            atlas: OnceLock::new(),
            has_begun: OnceLock::new(),
            file: OnceLock::new(),
            solved: OnceLock::new(),
            direct: Mutex::new(None),
            task: Arc::new(SharedTask::new(cancel.clone())),
        };
        let (shared, tracer) = (Arc::new(shared), tracer.clone());
        Self { shared, tracer, lookup: options.photo_lookup, resources: resources.clone() }
    }

    /// Sets the atlas at whose texels the light is stored; without one, the scene is unwrapped.
    pub fn set_atlas(&self, atlas: &Arc<Atlas>) {
        let _ = self.shared.atlas.set(atlas.clone());
    }

    /// The light, if it is solved; nothing is started.
    pub fn if_solved(&self) -> Option<Arc<PhotographLight>> {
        self.shared.solved.get()?.as_ref().ok().cloned()
    }

    /// The light as it is to be looked up, if it is solved; otherwise the solution is started.
    pub fn available_lookup(&self) -> Option<PhotographRadiance> {
        self.start();
        let light = self.shared.solved.get()?.as_ref().ok()?.clone();
        match self.lookup {
            PhotoLookup::Texels => Some(light),
            PhotoLookup::Direct => Some(self.shared.direct().clone()?),
        }
    }

    /// Waits for the light in the form in which it is to be looked up.
    ///
    /// # Errors
    /// The photographs cannot be read or their light cannot be solved, or `progress` asks to stop.
    pub fn wait_for_lookup(&self, progress: &dyn Progress) -> Result<PhotographRadiance, LightError> {
        let light = self.wait(progress)?;
        match self.lookup {
            PhotoLookup::Texels => Ok(light),
            PhotoLookup::Direct => {
                let mut direct = self.shared.direct();
                if let Some(direct) = &*direct {
                    return Ok(direct.clone());
                }
                let loaded = DirectPhotographs::load(light, &PhotographOptions::default(), progress)?;
                Ok(direct.insert(Arc::new(loaded)).clone())
            }
        }
    }

    /// Starts solving the light, unless that has been done, and waits for it.
    ///
    /// # Errors
    /// The photographs cannot be read or their light cannot be solved, or `progress` asks to stop.
    pub fn wait(&self, progress: &dyn Progress) -> Result<Arc<PhotographLight>, LightError> {
        self.start();
        let shared = &self.shared;
        let failed = || {
            "light from photographs could not be computed: a fault of the program (open the capture again)"
                .into()
        };
        let solved = shared.task.wait(progress, || shared.solved.get().cloned())?;
        solved.unwrap_or_else(|| Err(failed())).map_err(LightError::BadInput)
    }

    /// Whether the atlas is set and the light at its texels only has to be read from disk.
    pub fn is_on_disk(&self) -> bool {
        self.shared.atlas.get().is_some()
            && self.shared.file(&self.tracer, &self.resources.cache).is_some_and(CacheEntry::exists)
    }

    fn start(&self) {
        if self.shared.has_begun.set(()).is_ok() {
            let (shared, tracer, cache) =
                (self.shared.clone(), self.tracer.clone(), self.resources.cache.clone());
            let work = move |progress: &dyn Progress| {
                let _ = shared.solved.set(shared.solve(&tracer, &cache, progress));
            };
            self.shared.task.start(self.resources.background, "photographs", work);
        }
    }
}

impl SharedState {
    /// The cache entry of the light at the texels of the atlas, as far as one is set.
    fn file(&self, tracer: &Tracer, cache: &DiskCache) -> Option<&CacheEntry> {
        let entry = || {
            cache.entry(SECTION, |hash| {
                hash.update(photographs_hash(tracer.scene()));
                let options = PhotographOptions::default();
                hash.update(format!("{options:?} {:?}", self.atlas.get().map(|atlas| &atlas.hash)));
            })
        };
        self.file.get_or_init(entry).as_ref()
    }

    /// Ignores poisoning: the guarded value is only ever replaced as a whole.
    fn direct(&self) -> MutexGuard<'_, Option<Arc<DirectPhotographs>>> {
        self.direct.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn solve(
        &self,
        tracer: &Arc<Tracer>,
        cache: &DiskCache,
        progress: &dyn Progress,
    ) -> Result<Arc<PhotographLight>, String> {
        let scene = tracer.scene();
        let file = self.file(tracer, cache);
        let cached_bytes = file.and_then(CacheEntry::read);
        if let Some(light) = cached_bytes.and_then(|bytes| PhotographLight::from_bytes(&bytes, tracer)) {
            return Ok(Arc::new(light));
        }
        // The share of the progress that unwrapping takes, if it is still to be done.
        let (atlas, unwrapping) = match self.atlas.get() {
            Some(atlas) => (atlas.clone(), 0.0),
            None => {
                let share = 0.3;
                let stage = Stage::named(progress, "unwrapping", 0.0, share);
                let atlas = load_or_unwrap_atlas(scene, &UnwrapOptions::default(), cache, &stage);
                (Arc::new(atlas.map_err(|error| format!("{}: {error}", scene.path.display()))?), share)
            }
        };
        let (options, rest) = (PhotographOptions::default(), Stage::new(progress, unwrapping, 1.0));
        let solved = PhotographLight::solve(tracer, &atlas, &scene.views, &options, &rest);
        let light = solved.map_err(|error| error.to_string())?;
        if let Some(file) = file {
            file.write(&light.to_bytes());
        }
        Ok(Arc::new(light))
    }
}
