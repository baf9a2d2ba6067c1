//! Work on a scene on a thread of its own, which goes on whoever stops waiting, as long as the scene is open.

use progress::{Cancelled, Part, Progress};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use trace::Tracer;

/// How far some work is.
#[derive(Default)]
pub(super) struct SceneWork {
    /// Bits of an f32.
    done: AtomicU32,
    /// What it is at.
    part: Mutex<Option<Part>>,
    has_ended: AtomicBool,
}

impl SceneWork {
    /// Begins the work. Its progress says to stop when nobody else has the scene; `own_references` to the tracer are the work's own,
    /// beside the one that it is given.
    pub fn begin(
        self: &Arc<Self>,
        name: &str,
        tracer: &Arc<Tracer>,
        own_references: usize,
        work: impl FnOnce(&Arc<Tracer>, &dyn Progress) + Send + 'static,
    ) {
        let on_thread = {
            let (own, tracer) = (self.clone(), tracer.clone());
            move || {
                let watch = Watch { work: &own, tracer, own_references };
                // A panic ends it like anything else: who waits finds nothing.
                let _ = catch_unwind(AssertUnwindSafe(|| work(&watch.tracer, &watch)));
                own.has_ended.store(true, Ordering::Release);
            }
        };
        if std::thread::Builder::new().name(name.into()).spawn(on_thread).is_err() {
            self.has_ended.store(true, Ordering::Release);
        }
    }

    /// What the work finds, as soon as it is there; `None` if it ended without.
    pub fn wait<T>(
        &self,
        progress: &dyn Progress,
        poll: impl Fn() -> Option<T>,
    ) -> Result<Option<T>, Cancelled> {
        let mut reported_part = None;
        loop {
            // Looked at first: what was found before the end is there by then.
            let has_ended = self.has_ended.load(Ordering::Acquire);
            if let Some(result) = poll() {
                return Ok(Some(result));
            }
            if has_ended {
                return Ok(None);
            }
            progress.check()?;
            let part = *self.part();
            if let Some(part) = part.filter(|_| part != reported_part) {
                progress.begin_part(&part);
                reported_part = Some(part);
            }
            progress.report(f32::from_bits(self.done.load(Ordering::Relaxed)));
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// A poisoned lock only means that a panic passed by: what it guards is replaced as a whole.
    fn part(&self) -> MutexGuard<'_, Option<Part>> {
        self.part.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Goes on as long as anybody else has the scene.
struct Watch<'a> {
    work: &'a SceneWork,
    tracer: Arc<Tracer>,
    own_references: usize,
}

impl Progress for Watch<'_> {
    fn report(&self, fraction: f32) {
        self.work.done.fetch_max(fraction.to_bits(), Ordering::Relaxed);
    }

    fn cancelled(&self) -> bool {
        Arc::strong_count(&self.tracer) <= 1 + self.own_references
    }

    fn begin_part(&self, part: &Part) {
        *self.work.part() = Some(*part);
    }
}
