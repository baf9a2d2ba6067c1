//! Which light field is being made for the live picture: whoever needs the same one waits for it instead of baking it again.

use super::serves::serves;
use crate::document::Stage;
use lens::Camera;
use salf::Salf;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError, Weak};
use std::time::Duration;

/// The light field that is being made, or was made last.
#[derive(Default)]
pub(crate) struct FieldWatch {
    making: Mutex<Option<Making>>,
    changed: Condvar,
}

/// None of it is kept alive.
struct Making {
    stage: Weak<Stage>,
    /// Once it is baked.
    made: Option<Weak<Salf>>,
}

/// How a light field stands that would serve.
pub(crate) enum Standing {
    /// It is there.
    Made(Arc<Salf>),
    /// One is being made, whether or not it will serve.
    Underway,
    /// None is, that the watch knows of.
    Absent,
}

impl FieldWatch {
    /// One is being made from now on.
    pub fn begin(&self, stage: &Arc<Stage>) {
        *self.lock() = Some(Making { stage: Arc::downgrade(stage), made: None });
    }

    /// It is baked.
    pub fn made(&self, salf: &Arc<Salf>) {
        if let Some(making) = &mut *self.lock() {
            making.made = Some(Arc::downgrade(salf));
        }
        self.changed.notify_all();
    }

    /// No more is done on it, whether or not it was made.
    pub fn end(&self) {
        self.lock().take_if(|making| making.made.is_none());
        self.changed.notify_all();
    }

    /// How one stands that serves `camera` in `stage`. What is under way is waited for, as long as `patience`.
    pub fn look(&self, stage: &Arc<Stage>, camera: &Camera, patience: Duration) -> Standing {
        let is_underway = |making: &mut Option<Making>| making.as_ref().is_some_and(|m| m.made.is_none());
        let waited = self.changed.wait_timeout_while(self.lock(), patience, is_underway);
        let (making, _) = waited.unwrap_or_else(PoisonError::into_inner);
        let Some(making) = &*making else { return Standing::Absent };
        let Some(made) = &making.made else { return Standing::Underway };
        let is_here = making.stage.upgrade().is_some_and(|of| Arc::ptr_eq(&of, stage));
        let made = made.upgrade().filter(|salf| is_here && serves(&salf.camera, camera));
        made.map_or(Standing::Absent, Standing::Made)
    }

    /// A poisoned lock only means that a panic passed by: what it guards is replaced as a whole.
    fn lock(&self) -> MutexGuard<'_, Option<Making>> {
        self.making.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::super::kept_light::LightQuality;
    use super::*;
    use crate::document::Document;
    use crate::light_field::light;
    use progress::Unwatched;
    use std::time::Instant;

    #[test]
    fn what_is_under_way_is_waited_for() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("quads.glb");
        crate::tiny_glb::write(&file);
        let open = || Document::begin(&file, &Default::default(), &Default::default(), &Unwatched).unwrap();
        let (document, other) = (open(), open());
        let camera = Camera { width: 24, height: 16, ..document.camera.clone() };
        let watch = FieldWatch::default();
        let now = |stage| watch.look(stage, &camera, Duration::ZERO);
        assert!(matches!(now(&document.stage), Standing::Absent));
        watch.begin(&document.stage);
        assert!(matches!(now(&document.stage), Standing::Underway));
        let tracer = &document.stage.tracer;
        let options = salf::BakeOptions::default();
        let light = light(tracer, &camera, LightQuality::Fine, &Unwatched).unwrap();
        let salf = Arc::new(salf::bake(tracer, &*light, &camera, &options, &Unwatched).unwrap());
        let long = Duration::from_secs(60);
        let start = Instant::now();
        std::thread::scope(|scope| {
            scope.spawn(|| {
                std::thread::sleep(Duration::from_millis(20));
                watch.made(&salf);
            });
            let found = watch.look(&document.stage, &camera, long);
            assert!(matches!(found, Standing::Made(made) if Arc::ptr_eq(&made, &salf)));
        });
        assert!(start.elapsed() < long);
        watch.end();
        assert!(matches!(now(&document.stage), Standing::Made(_)), "it stays known");
        assert!(matches!(now(&other.stage), Standing::Absent), "of another scene");
        let wider = Camera { width: 30, ..camera.clone() };
        assert!(matches!(watch.look(&document.stage, &wider, Duration::ZERO), Standing::Absent));
        drop(salf);
        assert!(matches!(now(&document.stage), Standing::Absent), "it is gone");
        // One that fails is not waited for.
        watch.begin(&document.stage);
        watch.end();
        assert!(matches!(now(&document.stage), Standing::Absent));
    }
}
