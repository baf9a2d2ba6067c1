//! State shared by the session and the preview's threads: one mailbox for requests, one for results.

use crate::display::Patch;
use crate::light_field::{BakedField, FieldWatch};
use crate::preview::activity::PreviewActivity;
use crate::preview::deliveries::{ExactDelivery, FieldDelivery, InterimField, RefinedLightDelivery};
use crate::preview::events::{PreviewEvents, Published};
use crate::preview::picture::{PictureTimes, Preview, Quality};
use crate::preview::request::{PreviewRequest, StopScope};
use graphics_card::Gpu;
use jobs::{JobProgress, Waker};
use progress::{Cancelled, Progress};
use salf::BakedOn;
use std::sync::atomic::{AtomicBool, AtomicU8, AtomicU32, AtomicUsize, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// State shared by the session and the preview's threads.
pub(crate) struct Shared {
    request: Mutex<PreviewRequest>,
    wake: Condvar,
    /// Progress of the thread's own work: short.
    pub quick: JobProgress,
    /// Whether a request for another camera waits.
    is_camera_waiting: AtomicBool,
    /// Whether the thread makes a picture that is shown even if the camera moves on.
    is_following: AtomicBool,
    /// Progress of its helper's work: long.
    pub progress: JobProgress,
    /// Progress of the exact picture.
    pub refining: JobProgress,
    is_refining: AtomicBool,
    /// Progress of refining light.
    pub light: JobProgress,
    /// Number of passes by which light is being refined; 0: none.
    light_passes: AtomicU32,
    /// Progress of the spare.
    pub spare: JobProgress,
    makes_spare: AtomicBool,
    /// Number of exports that the exact picture on screen waits for.
    exports: AtomicUsize,
    activity: AtomicU8,
    helper: AtomicU8,
    /// Memory of the light fields worked with and prepared, and of their sums, bytes.
    field_bytes: [AtomicUsize; 2],
    /// The light field that the helper makes.
    pub field: FieldWatch,
    /// Number of light fields of full size that were baked.
    bakes: AtomicUsize,
    published: Mutex<Published>,
    gpu: Option<Gpu>,
    bake_on: Option<Gpu>,
    waker: Waker,
}

/// Ignores poisoning: the guarded value is always replaced as a whole.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Shared {
    /// Empty mailboxes. Pictures are summed, and light fields baked, on these graphics cards, or on the processor if `None`.
    pub fn new(waker: Waker, [gpu, bake_on]: [Option<Gpu>; 2]) -> Self {
        Self {
            gpu,
            bake_on,
            request: Mutex::default(),
            wake: Condvar::new(),
            quick: JobProgress::default(),
            is_camera_waiting: AtomicBool::new(false),
            is_following: AtomicBool::new(false),
            progress: JobProgress::default(),
            refining: JobProgress::default(),
            is_refining: AtomicBool::new(false),
            light: JobProgress::default(),
            light_passes: AtomicU32::new(0),
            spare: JobProgress::default(),
            makes_spare: AtomicBool::new(false),
            exports: AtomicUsize::new(0),
            activity: AtomicU8::new(PreviewActivity::Idle as u8),
            helper: AtomicU8::new(PreviewActivity::Idle as u8),
            field_bytes: Default::default(),
            field: FieldWatch::default(),
            bakes: AtomicUsize::new(0),
            published: Mutex::default(),
            waker,
        }
    }

    /// Waits for the next request; `None` when the session is dropped. After `timeout` without one, returns an idle request.
    pub fn next_request(&self, timeout: Option<Duration>) -> Option<PreviewRequest> {
        let mut request = lock(&self.request);
        self.activity.store(PreviewActivity::Idle as u8, Ordering::Relaxed);
        (self.waker)();
        let deadline = timeout.map(|timeout| Instant::now() + timeout);
        while !request.is_posted {
            let left = deadline.map(|deadline| deadline.saturating_duration_since(Instant::now()));
            request = match left {
                None => self.wake.wait(request).unwrap_or_else(PoisonError::into_inner),
                Some(Duration::ZERO) => {
                    return Some(PreviewRequest { is_idle: true, ..PreviewRequest::default() });
                }
                Some(left) => self.wake.wait_timeout(request, left).unwrap_or_else(PoisonError::into_inner).0,
            };
        }
        // What was cancelled is over, and this is new.
        self.quick.reset();
        self.is_camera_waiting.store(false, Ordering::Relaxed);
        self.activity.store(PreviewActivity::Splatting as u8, Ordering::Relaxed);
        if request.delivery.is_some() {
            self.helper.store(PreviewActivity::Idle as u8, Ordering::Relaxed);
        }
        let request = std::mem::take(&mut *request);
        (!request.quit).then_some(request)
    }

    /// Notes the memory of the light fields worked with and prepared, and of their sums, in bytes.
    pub fn note_field_bytes(&self, bytes: [usize; 2]) {
        self.field_bytes.iter().zip(bytes).for_each(|(noted, bytes)| noted.store(bytes, Ordering::Relaxed));
    }

    /// The memory of the light fields worked with and prepared, and of their sums, in bytes.
    pub fn field_bytes(&self) -> [usize; 2] {
        self.field_bytes.each_ref().map(|noted| noted.load(Ordering::Relaxed))
    }

    /// Counts a light field of full size that was baked.
    pub fn count_bake(&self) {
        self.bakes.fetch_add(1, Ordering::Relaxed);
    }

    /// Number of light fields of full size that were baked.
    pub fn bakes(&self) -> usize {
        self.bakes.load(Ordering::Relaxed)
    }

    /// Merges a change into the pending request, and cancels work that it makes useless.
    pub fn post(&self, scope: StopScope, change: impl FnOnce(&mut PreviewRequest)) {
        let mut request = lock(&self.request);
        change(&mut request);
        request.is_posted = true;
        self.is_camera_waiting.store(request.camera.is_some(), Ordering::Relaxed);
        if scope != StopScope::Nothing {
            self.refining.cancel();
        }
        if scope == StopScope::Aperture && PreviewActivity::load(&self.helper) == PreviewActivity::Baking {
            self.progress.cancel();
        }
        if matches!(scope, StopScope::View | StopScope::Everything) {
            request.is_stopping = true;
            self.progress.cancel();
            self.light.cancel();
            self.spare.cancel();
            if scope == StopScope::Everything || !self.is_following.load(Ordering::Relaxed) {
                self.quick.cancel();
            }
        }
        self.wake.notify_one();
    }

    /// Notes what the thread does now.
    ///
    /// # Errors
    /// [`Cancelled`] if it was cancelled.
    pub fn begin(&self, activity: PreviewActivity) -> Result<(), Cancelled> {
        self.quick.check()?;
        self.quick.begin_step("", 0.0, 1.0);
        self.activity.store(activity as u8, Ordering::Relaxed);
        Ok(())
    }

    /// Notes that the thread begins a picture that is shown even if the camera moves on.
    pub fn begin_following(&self) {
        let _request = lock(&self.request);
        self.is_following.store(true, Ordering::Relaxed);
    }

    /// Notes that such a picture is finished, and waits for `pause`; false as soon as there is a new request.
    pub fn end_following(&self, pause: Duration) -> bool {
        let request = lock(&self.request);
        self.is_following.store(false, Ordering::Relaxed);
        let waited = self.wake.wait_timeout_while(request, pause, |request| !request.is_posted);
        !waited.unwrap_or_else(PoisonError::into_inner).0.is_posted
    }

    /// Notes that the helper begins; false if its work is already useless.
    pub fn begin_helper(&self, activity: PreviewActivity) -> bool {
        let request = lock(&self.request);
        if request.is_stopping {
            return false;
        }
        self.progress.reset();
        self.helper.store(activity as u8, Ordering::Relaxed);
        true
    }

    /// Notes that the exact picture is begun; false if there is a new request.
    pub fn begin_refining(&self) -> bool {
        self.begin_if_quiet(|| {
            self.refining.reset();
            self.is_refining.store(true, Ordering::Relaxed);
        })
    }

    /// Notes that refining light by this number of passes begins; false if there is a new request.
    pub fn begin_light(&self, passes: u32) -> bool {
        self.begin_if_quiet(|| {
            self.light.reset();
            self.light_passes.store(passes, Ordering::Relaxed);
        })
    }

    /// Notes that a spare is begun; false if there is a new request.
    pub fn begin_spare(&self) -> bool {
        self.begin_if_quiet(|| {
            self.spare.reset();
            self.makes_spare.store(true, Ordering::Relaxed);
        })
    }

    /// Progress of the spare, while one is made.
    pub fn spare_progress(&self) -> Option<&JobProgress> {
        self.makes_spare.load(Ordering::Relaxed).then_some(&self.spare)
    }

    fn begin_if_quiet(&self, begin: impl FnOnce()) -> bool {
        let request = lock(&self.request);
        if request.is_posted {
            return false;
        }
        begin();
        (self.waker)();
        true
    }

    /// Delivers refined light, or the failure to refine it, to the preview's thread.
    pub fn deliver_refined_light(&self, refined: RefinedLightDelivery) {
        self.light_passes.store(0, Ordering::Relaxed);
        self.post(StopScope::Nothing, |request| request.refined_light = Some(refined));
    }

    /// By how many passes light is being refined, and how far that is.
    pub fn refining_light(&self) -> Option<(u32, &JobProgress)> {
        let passes = self.light_passes.load(Ordering::Relaxed);
        (passes > 0).then_some((passes, &self.light))
    }

    /// Delivers a spare, or the failure to make it, to the preview's thread.
    pub fn deliver_spare(&self, spare: FieldDelivery) {
        self.makes_spare.store(false, Ordering::Relaxed);
        self.post(StopScope::Nothing, |request| request.spare = Some(spare));
    }

    /// Delivers the exact picture, or the failure to draw it, to the preview's thread.
    pub fn deliver_exact(&self, refined: ExactDelivery) {
        self.is_refining.store(false, Ordering::Relaxed);
        self.post(StopScope::Nothing, |request| request.refined = Some(refined));
    }

    /// Notes that the helper has baked and sums now.
    pub fn begin_helper_sum(&self) {
        self.helper.store(PreviewActivity::Splatting as u8, Ordering::Relaxed);
    }

    /// Delivers a light field, or the failure to make it, to the preview's thread.
    pub fn deliver(&self, delivery: FieldDelivery) {
        self.post(StopScope::Nothing, |request| request.delivery = Some(delivery));
    }

    /// Delivers a coarse light field to the preview's thread, while the full one is being made.
    pub fn deliver_interim(&self, interim: InterimField) {
        self.post(StopScope::Nothing, |request| request.interim = Some(interim));
    }

    /// Publishes a picture and the patch that it changes on screen; `times`, if it was made just now.
    pub fn publish(&self, preview: Preview, patch: Option<Patch>, times: Option<PictureTimes>) {
        let mut published = lock(&self.published);
        if preview.quality > Quality::Coarse {
            published.events.finished.extend(times);
        }
        if let Some(patch) = patch {
            let is_whole = patch.is_whole();
            let patches = &mut published.events.patches;
            patches.retain(|_| !is_whole);
            patches.push((preview.generation, patch));
        }
        published.latest = Some(preview);
        drop(published);
        (self.waker)();
    }

    /// The message that a graphics card was lost; `None` if none was.
    pub fn loss_message(&self) -> Option<String> {
        let gpu = self.gpu.as_ref()?;
        let reason = gpu.why_lost()?.lines().next().unwrap_or_default();
        Some(format!("{} was lost ({reason}): the processor sums the picture now", gpu.name()))
    }

    /// What pictures are summed on; none, or none any more: the processor.
    pub fn gpu(&self) -> Option<Gpu> {
        self.gpu.clone().filter(|gpu| !gpu.is_lost())
    }

    /// What light fields are baked on; none, or none any more: the processor.
    pub fn bake_on(&self) -> Option<Gpu> {
        self.bake_on.clone().filter(|gpu| !gpu.is_lost())
    }

    /// What light fields that are kept from before must have been baked on.
    pub fn baked_on(&self) -> BakedOn {
        if self.bake_on().is_some() { BakedOn::Card } else { BakedOn::Processor }
    }

    /// Makes the light field from which pictures are drawn available to others.
    pub fn publish_field(&self, generation: u64, field: BakedField) {
        lock(&self.published).events.field = Some((generation, field));
    }

    /// Reports that a scene must be shown darker by this number of stops.
    pub fn publish_glare(&self, generation: u64, stops: f32) {
        lock(&self.published).events.glare = Some((generation, stops));
    }

    /// Reports a notice to the user.
    pub fn notice(&self, what: String) {
        lock(&self.published).events.notices.push(what);
        (self.waker)();
    }

    /// Reports a failure to the user.
    pub fn report_failure(&self, what: String) {
        lock(&self.published).events.failures.push(what);
        (self.waker)();
    }

    /// Whether a picture is being made that the user asked for.
    pub fn is_exporting(&self) -> bool {
        self.exports.load(Ordering::Relaxed) > 0
    }

    /// Whether there is anything to be done.
    pub fn is_at_work(&self) -> bool {
        let request = lock(&self.request);
        let idle = [&self.activity, &self.helper]
            .into_iter()
            .all(|activity| PreviewActivity::load(activity) == PreviewActivity::Idle);
        request.is_posted || !idle
    }

    /// A picture is being made that the user asked for: the exact one on screen waits.
    pub fn begin_export(&self) {
        self.exports.fetch_add(1, Ordering::Relaxed);
        self.refining.cancel();
        self.light.cancel();
        self.spare.cancel();
    }

    /// It is made: there is time again.
    pub fn end_export(&self) {
        self.exports.fetch_sub(1, Ordering::Relaxed);
        self.post(StopScope::Nothing, |_| {});
    }

    /// Current activity and its progress.
    pub fn activity(&self) -> (PreviewActivity, &JobProgress) {
        match PreviewActivity::load(&self.helper) {
            PreviewActivity::Idle => (PreviewActivity::load(&self.activity), &self.quick),
            helper => (helper, &self.progress),
        }
    }

    /// The share of the exact picture that is done, in [0, 1]; `None` if none is being drawn.
    pub fn refining_fraction(&self) -> Option<f32> {
        self.is_refining.load(Ordering::Relaxed).then(|| self.refining.fraction())
    }

    /// The newest picture, if there is one newer than `id`, and what happened meanwhile.
    pub fn take(&self, id: u64) -> (Option<Preview>, PreviewEvents) {
        let mut published = lock(&self.published);
        let newer = published.latest.as_ref().filter(|preview| preview.id > id).cloned();
        (newer, std::mem::take(&mut published.events))
    }

    /// Whether all requests are processed, and no picture newer than `id` waits to be taken.
    pub fn is_settled(&self, id: u64) -> bool {
        if self.is_at_work() {
            return false;
        }
        let published = lock(&self.published);
        published.events.failures.is_empty() && published.latest.as_ref().is_none_or(|p| p.id <= id)
    }
}

/// The thread's own work on a picture that is of no use once the camera is another.
pub(crate) struct UntilCameraMoves<'a>(pub &'a Shared);

impl Progress for UntilCameraMoves<'_> {
    fn report(&self, fraction: f32) {
        self.0.quick.report(fraction);
    }

    fn cancelled(&self) -> bool {
        self.0.quick.cancelled() || self.0.is_camera_waiting.load(Ordering::Relaxed)
    }
}
