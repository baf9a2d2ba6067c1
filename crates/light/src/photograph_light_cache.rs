//! Light of a scene from its photographs: solved once, and kept from one run of the program to the next.

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

/// Tens of megabytes each: some four bytes a texel and photograph that sees it.
const SECTION: CacheSection = CacheSection { name: "photographs", budget_bytes: 2 << 30 };

/// Light as it is looked up.
type PhotographRadiance = Arc<dyn Radiance + Send + Sync>;

/// The light of one scene from its photographs.
pub(crate) struct PhotographLightCache {
    entry: Arc<Entry>,
    tracer: Arc<Tracer>,
    lookup: PhotoLookup,
    resources: Resources,
}

struct Entry {
    /// An atlas of the scene, if there is one by the time that it is needed.
    atlas: OnceLock<Arc<Atlas>>,
    has_begun: OnceLock<()>,
    file: OnceLock<Option<CacheEntry>>,
    /// An error as it is shown.
    solved: OnceLock<Result<Arc<PhotographLight>, String>>,
    /// The same, looked up in the photographs, once that was requested.
    direct: Mutex<Option<Arc<DirectPhotographs>>>,
    task: Arc<SharedTask>,
}

impl PhotographLightCache {
    /// The light of the scene in `tracer`; nothing is begun. `cancel` stops work in the background.
    pub fn new(
        tracer: &Arc<Tracer>,
        options: LightOptions,
        resources: &Resources,
        cancel: &CancelToken,
    ) -> Self {
        let entry = Entry {
            atlas: OnceLock::new(),
            has_begun: OnceLock::new(),
            file: OnceLock::new(),
            solved: OnceLock::new(),
            direct: Mutex::new(None),
            task: Arc::new(SharedTask::new(cancel.clone())),
        };
        let (entry, tracer) = (Arc::new(entry), tracer.clone());
        Self { entry, tracer, lookup: options.photo_lookup, resources: resources.clone() }
    }

    /// Has the light kept at the texels of an atlas; without one the scene is unwrapped for it.
    pub fn set_atlas(&self, atlas: &Arc<Atlas>) {
        let _ = self.entry.atlas.set(atlas.clone());
    }

    /// The light, if it is there; nothing is begun.
    pub fn if_solved(&self) -> Option<Arc<PhotographLight>> {
        self.entry.solved.get()?.as_ref().ok().cloned()
    }

    /// The light as it is to be looked up, if it is there; begun, if not.
    pub fn available_lookup(&self) -> Option<PhotographRadiance> {
        self.start();
        let light = self.entry.solved.get()?.as_ref().ok()?.clone();
        match self.lookup {
            PhotoLookup::Texels => Some(light),
            PhotoLookup::Direct => Some(self.entry.direct().clone()?),
        }
    }

    /// The light as it is to be looked up, as soon as it is there.
    pub fn wait_for_lookup(&self, progress: &dyn Progress) -> Result<PhotographRadiance, LightError> {
        let light = self.wait(progress)?;
        match self.lookup {
            PhotoLookup::Texels => Ok(light),
            PhotoLookup::Direct => {
                let mut direct = self.entry.direct();
                if let Some(direct) = &*direct {
                    return Ok(direct.clone());
                }
                let loaded = DirectPhotographs::load(light, &PhotographOptions::default(), progress)?;
                Ok(direct.insert(Arc::new(loaded)).clone())
            }
        }
    }

    /// The light as soon as it is there.
    pub fn wait(&self, progress: &dyn Progress) -> Result<Arc<PhotographLight>, LightError> {
        self.start();
        let entry = &self.entry;
        let failed = || {
            "light from photographs could not be made: a fault of the program (open the capture again)".into()
        };
        let solved = entry.task.wait(progress, || entry.solved.get().cloned())?;
        solved.unwrap_or_else(|| Err(failed())).map_err(LightError::BadInput)
    }

    /// Whether the light, kept at the texels of an atlas that is known, only has to be read.
    pub fn is_on_disk(&self) -> bool {
        self.entry.atlas.get().is_some()
            && self.entry.file(&self.tracer, &self.resources.cache).is_some_and(CacheEntry::exists)
    }

    fn start(&self) {
        if self.entry.has_begun.set(()).is_ok() {
            let (entry, tracer, cache) =
                (self.entry.clone(), self.tracer.clone(), self.resources.cache.clone());
            let work = move |progress: &dyn Progress| {
                let _ = entry.solved.set(entry.solve(&tracer, &cache, progress));
            };
            self.entry.task.start(self.resources.background, "photographs", work);
        }
    }
}

impl Entry {
    /// Where the light is kept, of the atlas that is known by now.
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

    /// A poisoned lock only means that a panic passed by: what it guards is replaced as a whole.
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
        // The share of unwrapping, where that is left to do.
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
