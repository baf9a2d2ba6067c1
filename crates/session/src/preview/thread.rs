//! The session's handle to the preview thread: posts requests and takes results.

use crate::error::SessionError;
use crate::light_field::{ApertureFit, Changes};
use crate::preview::activity::PreviewActivity;
use crate::preview::events::PreviewEvents;
use crate::preview::helper_thread::STACK_BYTES;
use crate::preview::mailbox::Shared;
use crate::preview::picture::Preview;
use crate::preview::request::StopScope;
use crate::preview::worker::Worker;
use document::Stage;
use focus::FocusMap;
use graphics_card::Gpu;
use jobs::{JobProgress, Urgency, Waker, build_thread_pool};
use lens::Camera;
use render::{LightFieldStore, Tone};
use splat::Tolerance;
use std::sync::Arc;
use std::time::Duration;

/// The session's handle to the preview thread.
pub(crate) struct PreviewThread {
    shared: Arc<Shared>,
    thread: Option<std::thread::JoinHandle<()>>,
}

impl PreviewThread {
    /// Starts the thread. After nothing has changed for `exact_after` (`None`: never) the exact picture is drawn, and then light is refined
    /// by at most `light_passes`. Light fields are stored in `store`. Pictures are summed, and light
    /// fields baked, on these graphics cards, or on the processor if `None`.
    ///
    /// # Errors
    /// The system refused a thread.
    pub fn start(
        waker: Waker,
        exact_after: Option<Duration>,
        light_passes: u32,
        store: Option<LightFieldStore>,
        cards: [Option<Gpu>; 2],
    ) -> Result<Self, SessionError> {
        let shared = Arc::new(Shared::new(waker, cards));
        let (thread_shared, pool) = (shared.clone(), build_thread_pool(Urgency::Interactive)?);
        let thread = std::thread::Builder::new()
            .name("preview".into())
            .stack_size(STACK_BYTES)
            .spawn(move || {
                pool.install(|| Worker::new(thread_shared, exact_after, light_passes, store).run())
            })
            .map_err(|e| SessionError::TryAgain(format!("no preview thread: {e} (try again)")))?;
        Ok(Self { shared, thread: Some(thread) })
    }

    /// Shows another scene, with its focus and camera; the numbers are the generation of the stage and the serial of
    /// the map.
    pub fn set_stage(&self, stage: (Arc<Stage>, u64), map: (FocusMap, u64), camera: Camera) {
        self.shared.post(StopScope::Everything, |request| {
            request.stage = Some(stage);
            (request.camera, request.map) = (Some(camera), Some(map));
            request.changed = Changes::Everything;
            request.pause = false;
        });
    }

    /// Another camera, at the preview's size. `fit`: how well a light field of the camera before fits it.
    pub fn set_camera(&self, camera: Camera, fit: Option<ApertureFit>) {
        let scope = match fit {
            Some(fit) if fit.is_covering() => StopScope::Refining,
            Some(_) => StopScope::Aperture,
            None => StopScope::View,
        };
        self.shared.post(scope, |request| {
            request.camera = Some(camera);
            request.edit_done = true;
            request.pause = false;
        });
    }

    /// A new state of the map with its number of changes; `changed` says what is new in it.
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

    /// Bakes the light field again.
    pub fn bake(&self) {
        self.shared.post(StopScope::Everything, |request| {
            request.bake = true;
            request.pause = false;
        });
    }

    /// Draws what is shown again: the card that had it is lost.
    pub fn replace_lost_picture(&self) {
        self.shared.post(StopScope::Nothing, |request| request.is_card_lost = true);
    }

    /// Cancels current work; the last picture stays.
    pub fn cancel(&self) {
        self.shared.post(StopScope::Everything, |request| request.pause = true);
    }

    /// Pauses what is done while nothing changes, until scene or camera change.
    pub fn pause_background(&self) {
        self.shared.post(StopScope::Nothing, |request| request.pause_background = true);
        self.shared.light.cancel();
        self.shared.spare.cancel();
    }

    /// Progress of the light field for a wider aperture, while it is baked.
    pub fn spare_progress(&self) -> Option<&JobProgress> {
        self.shared.spare_progress()
    }

    /// The number of passes by which light is being refined, and the progress; `None` if it is not being refined.
    pub fn refining_light(&self) -> Option<(u32, &JobProgress)> {
        self.shared.refining_light()
    }

    /// What the preview's thread does now, and its progress.
    pub fn activity(&self) -> (PreviewActivity, &JobProgress) {
        self.shared.activity()
    }

    /// The newest picture, if there is one newer than `id`, and what happened meanwhile.
    pub fn take(&self, id: u64) -> (Option<Preview>, PreviewEvents) {
        self.shared.take(id)
    }

    /// The memory of the light fields that are worked with, and of their sums, in bytes.
    pub fn field_bytes(&self) -> [usize; 2] {
        self.shared.field_bytes()
    }

    /// Number of light fields of full size that were baked.
    pub fn bakes(&self) -> usize {
        self.shared.bakes()
    }

    /// Sets how linear light is shown on the screen.
    pub fn set_tone(&self, tone: Tone) {
        self.shared.post(StopScope::Nothing, |request| request.tone = Some(tone));
    }

    /// The state shared with the thread.
    pub fn shared(&self) -> Arc<Shared> {
        self.shared.clone()
    }

    /// Sets how coarse pictures may be while the user works.
    pub fn set_tolerance(&self, tolerance: Tolerance) {
        self.shared.post(StopScope::Refining, |request| {
            request.tolerance = Some(tolerance);
            request.pause = false;
        });
    }

    /// The share of the exact picture that is done, in [0, 1]; `None` if none is being drawn.
    pub fn refining(&self) -> Option<f32> {
        self.shared.refining_fraction()
    }

    /// Whether all requests are processed, and no picture newer than `id` waits to be taken.
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
