//! Tracks the light field being made for the live picture, so that others who need it can wait for it instead of baking it again.

use document::Stage;
use lens::Camera;
use render::is_baked_for;
use salf::Salf;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError, Weak};
use std::time::Duration;

/// The light field that is being made, or was made last.
#[derive(Default)]
pub(crate) struct FieldWatch {
    latest: Mutex<Option<LatestBake>>,
    changed: Condvar,
}

/// Weak references: nothing is kept alive.
struct LatestBake {
    stage: Weak<Stage>,
    /// The light field, once it is baked.
    baked: Option<Weak<Salf>>,
}

/// The state of a compatible light field.
pub(crate) enum BakeState {
    /// It is baked.
    Baked(Arc<Salf>),
    /// A light field is being made, which may or may not be compatible.
    InProgress,
    /// None is being made.
    Absent,
}

impl FieldWatch {
    /// Notes that a light field for `stage` is being made.
    pub fn begin(&self, stage: &Arc<Stage>) {
        *self.lock() = Some(LatestBake { stage: Arc::downgrade(stage), baked: None });
    }

    /// Notes that the light field is baked.
    pub fn set_baked(&self, salf: &Arc<Salf>) {
        if let Some(latest) = &mut *self.lock() {
            latest.baked = Some(Arc::downgrade(salf));
        }
        self.changed.notify_all();
    }

    /// Notes that work on it has ended, with or without success.
    pub fn end(&self) {
        self.lock().take_if(|latest| latest.baked.is_none());
        self.changed.notify_all();
    }

    /// The state of a light field that is compatible with `camera` in `stage`. Waits up to `timeout` for one that is being made.
    pub fn wait_for(&self, stage: &Arc<Stage>, camera: &Camera, timeout: Duration) -> BakeState {
        let is_underway =
            |latest: &mut Option<LatestBake>| latest.as_ref().is_some_and(|m| m.baked.is_none());
        let waited = self.changed.wait_timeout_while(self.lock(), timeout, is_underway);
        let (latest, _) = waited.unwrap_or_else(PoisonError::into_inner);
        let Some(latest) = &*latest else { return BakeState::Absent };
        let Some(baked) = &latest.baked else { return BakeState::InProgress };
        let is_same_stage =
            latest.stage.upgrade().is_some_and(|baked_stage| Arc::ptr_eq(&baked_stage, stage));
        let baked = baked.upgrade().filter(|salf| is_same_stage && is_baked_for(&salf.camera, camera));
        baked.map_or(BakeState::Absent, BakeState::Baked)
    }

    /// Ignores poisoning: the guarded value is always replaced as a whole.
    fn lock(&self) -> MutexGuard<'_, Option<LatestBake>> {
        self.latest.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use document::Document;
    use light::LightQuality;
    use progress::Unwatched;
    use std::time::Instant;

    #[test]
    fn what_is_under_way_is_waited_for() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("quads.glb");
        crate::tiny_glb::write(&file);
        let open = || {
            Document::create(&file, &Default::default(), &Default::default(), &Default::default(), &Unwatched)
                .unwrap()
        };
        let (document, other) = (open(), open());
        let camera = Camera { width: 24, height: 16, ..document.camera.clone() };
        let watch = FieldWatch::default();
        let now = |stage| watch.wait_for(stage, &camera, Duration::ZERO);
        assert!(matches!(now(&document.stage), BakeState::Absent));
        watch.begin(&document.stage);
        assert!(matches!(now(&document.stage), BakeState::InProgress));
        let tracer = document.stage.tracer();
        let options = salf::BakeOptions::default();
        let light = document.stage.lit.solve(&camera, LightQuality::Fine, &Unwatched).unwrap();
        let salf = Arc::new(salf::bake(tracer, &*light, &camera, &options, &Unwatched).unwrap());
        let long = Duration::from_secs(60);
        let start = Instant::now();
        std::thread::scope(|scope| {
            scope.spawn(|| {
                std::thread::sleep(Duration::from_millis(20));
                watch.set_baked(&salf);
            });
            let state = watch.wait_for(&document.stage, &camera, long);
            assert!(matches!(state, BakeState::Baked(baked) if Arc::ptr_eq(&baked, &salf)));
        });
        assert!(start.elapsed() < long);
        watch.end();
        assert!(matches!(now(&document.stage), BakeState::Baked(_)), "it stays known");
        assert!(matches!(now(&other.stage), BakeState::Absent), "of another scene");
        let wider = Camera { width: 30, ..camera.clone() };
        assert!(matches!(watch.wait_for(&document.stage, &wider, Duration::ZERO), BakeState::Absent));
        drop(salf);
        assert!(matches!(now(&document.stage), BakeState::Absent), "it is gone");
        // One that fails is not waited for.
        watch.begin(&document.stage);
        watch.end();
        assert!(matches!(now(&document.stage), BakeState::Absent));
    }
}
