//! The session's end of the preview's thread: wishes are posted, what was made is taken.

use crate::error::SessionError;
use crate::light_field::Changes;
use crate::preview::activity::PreviewActivity;
use crate::preview::events::PreviewEvents;
use crate::preview::mailbox::Shared;
use crate::preview::picture::Preview;
use crate::preview::request::StopScope;
use crate::preview::worker::Worker;
use document::Stage;
use focus::FocusMap;
use jobs::{JobProgress, Urgency, Waker, build_thread_pool};
use lens::Camera;
use render::{LightFieldStore, Tone};
use splat::{Gpu, Tolerance};
use std::sync::Arc;
use std::time::Duration;

/// The session's end of the preview thread.
pub(crate) struct PreviewThread {
    shared: Arc<Shared>,
    thread: Option<std::thread::JoinHandle<()>>,
}

impl PreviewThread {
    /// Starts the thread. `exact_after`: for how long nothing must change until the exact picture is drawn; none: never.
    /// Then light is refined, by at most `light_passes`. `store`: where light fields are kept. `gpu`: what pictures are summed on; none: the processor.
    pub fn start(
        waker: Waker,
        exact_after: Option<Duration>,
        light_passes: u32,
        store: Option<LightFieldStore>,
        gpu: Option<Gpu>,
    ) -> Result<Self, SessionError> {
        let shared = Arc::new(Shared::new(waker, gpu));
        let (thread_shared, pool) = (shared.clone(), build_thread_pool(Urgency::Interactive)?);
        let thread = std::thread::Builder::new()
            .name("preview".into())
            .stack_size(16 << 20)
            .spawn(move || {
                pool.install(|| Worker::new(thread_shared, exact_after, light_passes, store).run())
            })
            .map_err(|e| SessionError::TryAgain(format!("no preview thread: {e} (try again)")))?;
        Ok(Self { shared, thread: Some(thread) })
    }

    /// Another scene, with its focus.
    pub fn set_stage(&self, stage: (Arc<Stage>, u64), map: (FocusMap, u64), camera: Camera) {
        self.shared.post(StopScope::Everything, |request| {
            request.stage = Some(stage);
            (request.camera, request.map) = (Some(camera), Some(map));
            request.changed = Changes::Everything;
            request.pause = false;
        });
    }

    /// Another camera, at the preview's size. `light_field_stays` where the old light field serves it.
    pub fn set_camera(&self, camera: Camera, keeps_light_field: bool) {
        let scope = if keeps_light_field { StopScope::Refining } else { StopScope::Everything };
        self.shared.post(scope, |request| {
            request.camera = Some(camera);
            request.edit_done = true;
            request.pause = false;
        });
    }

    /// Another state of the map, with how many changes it holds; `changed` is what is new in it.
    pub fn set_map(&self, map: (FocusMap, u64), changed: &Changes) {
        self.shared.post(StopScope::Refining, |request| {
            request.map = Some(map);
            request.changed.join(changed);
        });
    }

    /// A stroke or another edit is complete.
    pub fn edit_done(&self) {
        self.shared.post(StopScope::Nothing, |request| request.edit_done = true);
    }

    /// Makes the light field anew.
    pub fn bake(&self) {
        self.shared.post(StopScope::Everything, |request| {
            request.bake = true;
            request.pause = false;
        });
    }

    /// Stops what is going on; the last picture stays.
    pub fn cancel(&self) {
        self.shared.post(StopScope::Everything, |request| request.pause = true);
    }

    /// Refines no light until another scene or camera is looked at.
    pub fn pause_light(&self) {
        self.shared.post(StopScope::Nothing, |request| request.pause_light = true);
        self.shared.light.cancel();
    }

    /// By how many passes light is being refined, and how far that is.
    pub fn refining_light(&self) -> Option<(u32, &JobProgress)> {
        self.shared.refining_light()
    }

    /// What is going on, and how far it is.
    pub fn activity(&self) -> (PreviewActivity, &JobProgress) {
        self.shared.activity()
    }

    /// The newest picture, if there is one newer than `id`, and what happened meanwhile.
    pub fn take(&self, id: u64) -> (Option<Preview>, PreviewEvents) {
        self.shared.take(id)
    }

    /// Puts pictures on screen in another way.
    pub fn set_tone(&self, tone: Tone) {
        self.shared.post(StopScope::Nothing, |request| request.tone = Some(tone));
    }

    /// What others need of its work.
    pub fn shared(&self) -> Arc<Shared> {
        self.shared.clone()
    }

    /// Sets how coarse pictures may be while one works.
    pub fn set_tolerance(&self, tolerance: Tolerance) {
        self.shared.post(StopScope::Refining, |request| {
            request.tolerance = Some(tolerance);
            request.pause = false;
        });
    }

    /// How far the exact picture is, while it is drawn.
    pub fn refining(&self) -> Option<f32> {
        self.shared.refining_fraction()
    }

    /// Whether everything that was posted has been followed, and nothing newer than `id` waits to be taken.
    pub fn is_settled(&self, id: u64) -> bool {
        self.shared.is_settled(id)
    }
}

impl Drop for PreviewThread {
    fn drop(&mut self) {
        self.shared.post(StopScope::Everything, |request| request.quit = true);
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has nothing left to hand over.
            let _ = thread.join();
        }
    }
}
