//! Light from photographs, by scene: made once, and kept from one run of the program to the next.

use super::scene_work::SceneWork;
use crate::document::{photographs_hash, unwrapped};
use crate::error::SessionError;
use crate::kept_files::KeptFiles;
use atlas::{Atlas, UnwrapOptions};
use progress::{Progress, Stage};
use scene::PhotoLookup;
use sha2::Digest;
use slf::{DirectPhotographs, PhotographError, PhotographLight, PhotographOptions};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError, Weak};
use trace::{Radiance, Tracer};

/// Light as it is looked up.
type LookedUp = Arc<dyn Radiance + Send + Sync>;

/// The light of a scene; an error as it is shown.
struct Kept {
    tracer: Weak<Tracer>,
    /// An atlas of the scene, if there is one by the time that it is needed.
    atlas: OnceLock<Arc<Atlas>>,
    has_begun: OnceLock<()>,
    file: OnceLock<Option<PathBuf>>,
    found: OnceLock<Result<Arc<PhotographLight>, String>>,
    /// The same, looked up in the photographs, once that was asked for.
    direct: Mutex<Option<Arc<DirectPhotographs>>>,
    work: Arc<SceneWork>,
}

fn all() -> MutexGuard<'static, Vec<Arc<Kept>>> {
    static ALL: Mutex<Vec<Arc<Kept>>> = Mutex::new(Vec::new());
    ALL.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What is kept of a scene.
fn of(tracer: &Arc<Tracer>) -> Arc<Kept> {
    let mut all = all();
    all.retain(|kept| kept.tracer.strong_count() > 0);
    if let Some(kept) = all.iter().find(|kept| std::ptr::eq(kept.tracer.as_ptr(), Arc::as_ptr(tracer))) {
        return kept.clone();
    }
    let kept = Arc::new(Kept {
        tracer: Arc::downgrade(tracer),
        atlas: OnceLock::new(),
        has_begun: OnceLock::new(),
        file: OnceLock::new(),
        found: OnceLock::new(),
        direct: Mutex::new(None),
        work: Arc::default(),
    });
    all.push(kept.clone());
    kept
}

/// Has the light of a scene that photographs light kept at the texels of an atlas; without one the scene is unwrapped for it.
pub(crate) fn keep_at(tracer: &Arc<Tracer>, atlas: &Arc<Atlas>) {
    if !tracer.scene().views.is_empty() {
        let _ = of(tracer).atlas.set(atlas.clone());
    }
}

/// The light, if the scene has photographs and it is there; nothing is begun.
pub(crate) fn if_known(tracer: &Arc<Tracer>) -> Option<Arc<PhotographLight>> {
    if tracer.scene().views.is_empty() {
        return None;
    }
    of(tracer).found.get()?.as_ref().ok().cloned()
}

/// The light as the scene wants it looked up, if it is there; begun, if not.
pub(super) fn known(tracer: &Arc<Tracer>) -> Option<LookedUp> {
    let kept = begun(tracer);
    let light = kept.found.get()?.as_ref().ok()?.clone();
    match tracer.scene().photo_lookup {
        PhotoLookup::Texels => Some(light),
        PhotoLookup::Direct => Some(kept.direct().clone()?),
    }
}

/// The same as soon as it is there.
pub(super) fn looked_up(tracer: &Arc<Tracer>, progress: &dyn Progress) -> Result<LookedUp, SessionError> {
    let light = wait(tracer, progress)?;
    if tracer.scene().photo_lookup == PhotoLookup::Texels {
        return Ok(light);
    }
    let kept = of(tracer);
    let mut direct = kept.direct();
    if direct.is_none() {
        let made = DirectPhotographs::of(light, &PhotographOptions::default(), progress);
        *direct = Some(Arc::new(made.map_err(|error| match error {
            PhotographError::Cancelled => SessionError::Cancelled,
            other => SessionError::BadInput(other.to_string()),
        })?));
    }
    let found: Option<LookedUp> = direct.clone().map(|direct| -> LookedUp { direct });
    found.ok_or_else(|| SessionError::Internal("photographs were not kept".into()))
}

impl Kept {
    /// Where the light is kept, of the atlas that is known by now.
    fn file(&self, tracer: &Tracer) -> Option<&Path> {
        let of_atlas = || {
            FILES.file(|hash| {
                hash.update(photographs_hash(tracer.scene()));
                let options = PhotographOptions::default();
                hash.update(format!("{options:?} {:?}", self.atlas.get().map(|atlas| &atlas.hash)));
            })
        };
        self.file.get_or_init(of_atlas).as_deref()
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
    let kept = begun(tracer);
    let failed =
        || "light from photographs could not be made: a fault of the program (open the capture again)".into();
    let found = kept.work.wait(progress, || kept.found.get().cloned())?.unwrap_or_else(|| Err(failed()));
    found.map_err(SessionError::BadInput)
}

/// Whether the light, kept at the texels of an atlas that is known, only has to be read.
pub(super) fn is_kept(tracer: &Arc<Tracer>) -> bool {
    let kept = of(tracer);
    kept.atlas.get().is_some() && kept.file(tracer).is_some_and(Path::exists)
}

fn begun(tracer: &Arc<Tracer>) -> Arc<Kept> {
    let kept = of(tracer);
    if kept.has_begun.set(()).is_ok() {
        let work = {
            let kept = kept.clone();
            move |tracer: &Arc<Tracer>, progress: &dyn Progress| {
                let _ = kept.found.set(solve(&kept, tracer, progress));
            }
        };
        kept.work.begin("photographs", tracer, 0, work);
    }
    kept
}

/// Tens of megabytes each: some four bytes a texel and photograph that sees it.
const FILES: KeptFiles = KeptFiles { name: "photographs", budget_bytes: 2 << 30 };

fn solve(kept: &Kept, tracer: &Arc<Tracer>, progress: &dyn Progress) -> Result<Arc<PhotographLight>, String> {
    let scene = tracer.scene();
    let file = kept.file(tracer);
    let found = file.and_then(|file| FILES.read(file));
    if let Some(light) = found.and_then(|bytes| PhotographLight::from_bytes(&bytes, tracer)) {
        return Ok(Arc::new(light));
    }
    // The share of unwrapping, where that is left to do.
    let (atlas, unwrapping) = match kept.atlas.get() {
        Some(atlas) => (atlas.clone(), 0.0),
        None => {
            let share = 0.3;
            let stage = Stage::named(progress, "unwrapping", 0.0, share);
            let made = unwrapped(scene, &UnwrapOptions::default(), &stage);
            (Arc::new(made.map_err(|error| format!("{}: {error}", scene.path.display()))?), share)
        }
    };
    let (options, rest) = (PhotographOptions::default(), Stage::new(progress, unwrapping, 1.0));
    let made = PhotographLight::solve(tracer, &atlas, &scene.views, &options, &rest);
    let light = made.map_err(|error| error.to_string())?;
    if let Some(file) = file {
        FILES.write(file, &light.to_bytes());
    }
    Ok(Arc::new(light))
}
