//! Light from photographs, by scene: made once on a thread of its own, which goes on whoever stops waiting, as long as the scene is open.

use crate::error::SessionError;
use atlas::{Atlas, UnwrapOptions};
use progress::Progress;
use slf::{PhotographError, PhotographLight, PhotographOptions};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError, Weak};
use std::time::Duration;
use trace::Tracer;

/// The light of a scene; an error as it is shown.
struct Kept {
    tracer: Weak<Tracer>,
    /// An atlas of the scene, if there is one by the time that it is needed.
    atlas: OnceLock<Arc<Atlas>>,
    has_begun: OnceLock<()>,
    found: OnceLock<Result<Arc<PhotographLight>, String>>,
    /// Bits of an f32.
    done: AtomicU32,
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
        found: OnceLock::new(),
        done: AtomicU32::new(0),
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

/// The light, if it is there; begun, if not.
pub(super) fn known(tracer: &Arc<Tracer>) -> Option<Arc<PhotographLight>> {
    begun(tracer).found.get()?.as_ref().ok().cloned()
}

/// The light as soon as it is there.
pub(crate) fn wait(
    tracer: &Arc<Tracer>,
    progress: &dyn Progress,
) -> Result<Arc<PhotographLight>, SessionError> {
    let kept = begun(tracer);
    loop {
        match kept.found.get() {
            Some(Ok(light)) => return Ok(light.clone()),
            Some(Err(what)) => return Err(SessionError::BadInput(what.clone())),
            None => {}
        }
        progress.check()?;
        progress.report(f32::from_bits(kept.done.load(Ordering::Relaxed)));
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn begun(tracer: &Arc<Tracer>) -> Arc<Kept> {
    let kept = of(tracer);
    if kept.has_begun.set(()).is_ok() {
        let work = {
            let (kept, tracer) = (kept.clone(), tracer.clone());
            move || {
                let made = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| solve(&kept, tracer)));
                let _ = kept.found.set(made.unwrap_or_else(|_| Err(failed())));
            }
        };
        if std::thread::Builder::new().name("photographs".into()).spawn(work).is_err() {
            let _ = kept.found.set(Err(failed()));
        }
    }
    kept
}

fn failed() -> String {
    "light from photographs could not be made: a fault of the program (open the capture again)".into()
}

fn solve(kept: &Kept, tracer: Arc<Tracer>) -> Result<Arc<PhotographLight>, String> {
    let watch = Watch { kept, tracer: tracer.clone() };
    let scene = tracer.scene();
    let atlas = match kept.atlas.get() {
        Some(atlas) => atlas.clone(),
        None => {
            let made = Atlas::unwrap(scene, &UnwrapOptions::default(), &watch);
            Arc::new(made.map_err(|error| format!("{}: {error}", scene.path.display()))?)
        }
    };
    let made = PhotographLight::solve(&tracer, &atlas, &scene.views, &PhotographOptions::default(), &watch);
    made.map(Arc::new).map_err(|error: PhotographError| error.to_string())
}

/// Goes on as long as anybody else has the scene.
struct Watch<'a> {
    kept: &'a Kept,
    tracer: Arc<Tracer>,
}

/// References to the tracer that the work itself holds: its own and the watch's.
const OWN_REFERENCES: usize = 2;

impl Progress for Watch<'_> {
    fn report(&self, fraction: f32) {
        self.kept.done.fetch_max(fraction.to_bits(), Ordering::Relaxed);
    }

    fn cancelled(&self) -> bool {
        Arc::strong_count(&self.tracer) <= OWN_REFERENCES
    }
}
