//! The live preview: a thread that owns the light field and keeps its picture up to date.
//!
//! The session posts what is wanted (scene, camera, changed texels) into one mailbox; newer wishes replace or
//! join older ones there, so that the thread, whenever it looks, does the least that leads to the newest state.
//! Two light fields serve it:
//!
//! ```text
//!                  coarse (a quarter of the size)         fine (the preview's size)
//! scene, pose …    baked at once, after a pinhole and,   baked on a helper thread
//!                  if large, a rough one
//! lens             summed at once                        summed on a helper thread, if it takes long
//! paint            updated until the fine one is there   updated
//! ```
//!
//! When nothing has changed for a while, the fine one is summed once more without tolerance ([`crate::refinement`]).
//! So a dab or a turned ring shows at once and sharpens by itself, however large the scene. The thread works on
//! snapshots of the focus map (tiles are shared until one is painted on): neither ever waits for the other. What
//! a newer wish makes useless is stopped. The last good picture is never taken away.

use crate::field_watch::{FieldWatch, Standing};
use crate::job::{JobProgress, Urgency, Waker, own_threads};
use crate::light_field::{BakedField, Changes, LightField};
use crate::light_field_maker::BAKE_SHARE;
use crate::light_field_store::LightFieldStore;
use crate::preview_worker::Worker;
use crate::refinement::Refined;
use crate::screen::Patch;
use crate::{LivePicture, Modelled, SessionError, Stage, Tone};
use focus::FocusMap;
use lens::Camera;
use progress::{Cancelled, Progress};
use salf::Salf;
use splat::{Gpu, Tolerance};
use std::sync::atomic::{AtomicBool, AtomicU8, AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// A picture of the preview.
#[derive(Clone, Debug)]
pub struct Preview {
    /// Counts up: a newer picture has a greater id.
    pub id: u64,
    /// The picture, radiance and coverage.
    pub picture: LivePicture,
    /// How it was made.
    pub kind: PreviewKind,
    /// How good it is.
    pub quality: Quality,
    /// What pictures of its light field cost.
    pub costs: DrawingCosts,
    /// The camera it was made with, at its own size.
    pub camera: Camera,
    /// Seconds that making it took.
    pub seconds: f64,
    /// What the light field holds; nothing for a pinhole picture.
    pub modelled: Modelled,
    /// How many changes of the map it has seen, as [`crate::Session::map_serial`] counts them.
    pub map_serial: u64,
    /// Which of the session's documents it shows.
    pub(crate) generation: u64,
}

/// How a preview was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PreviewKind {
    /// Without blur, while the light field is being baked.
    Pinhole,
    /// From the light field, whole.
    Splat,
    /// From the light field, only what paint moved.
    Update,
}

/// How good a preview is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Quality {
    /// The quick picture of few pixels, or one without blur, that a finer one is about to replace.
    Coarse,
    /// Of full size, summed within the tolerance, at least where it changed since it was exact.
    Viewing,
    /// Summed without tolerance.
    Exact,
}

/// What pictures within the tolerance and exact ones cost, as far as that is known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DrawingCosts {
    /// Seconds to draw all of a picture of [`Quality::Viewing`].
    pub viewing_seconds: Option<f64>,
    /// PSNR, dB, of the last one against the exact picture, for the lens and the tolerance as they are.
    pub viewing_psnr: Option<f64>,
    /// Seconds to draw all of the exact picture.
    pub exact_seconds: Option<f64>,
}

/// What the preview is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PreviewActivity {
    /// Nothing to do.
    Idle,
    /// Making a picture without blur.
    Tracing,
    /// Making a light field of few samples.
    RoughBaking,
    /// Making the light field.
    Baking,
    /// Summing the picture.
    Splatting,
}

impl PreviewActivity {
    /// Whether a light field is being made.
    pub fn is_baking(self) -> bool {
        matches!(self, Self::RoughBaking | Self::Baking)
    }

    fn load(from: &AtomicU8) -> Self {
        match from.load(Ordering::Relaxed) {
            x if x == Self::Tracing as u8 => Self::Tracing,
            x if x == Self::RoughBaking as u8 => Self::RoughBaking,
            x if x == Self::Baking as u8 => Self::Baking,
            x if x == Self::Splatting as u8 => Self::Splatting,
            _ => Self::Idle,
        }
    }
}

/// How often it is looked whether the preview is still at work on a light field that others need.
const LOOK_EVERY: Duration = Duration::from_millis(50);

/// When a finished picture was made.
#[derive(Clone, Copy, Debug)]
pub struct PictureTimes {
    /// How many changes of the map it has seen, as [`crate::Session::map_serial`] counts them.
    pub map_serial: u64,
    /// When work on it began: with all that was wished until then.
    pub begun: Instant,
    /// When its sum was up to date.
    pub summed: Instant,
    /// When its pixels stood ready to be shown.
    pub finished: Instant,
}

/// What the maker of light fields hands over.
pub(crate) struct Delivery {
    /// The light field, summed; or why there is none.
    pub made: Result<LightField, SessionError>,
    /// The epoch in which it was asked for.
    pub epoch: u64,
}

/// Everything that changed since the thread last looked.
#[derive(Default)]
pub(crate) struct Wishes {
    /// Another scene, and which of the session's documents it is.
    pub stage: Option<(Arc<Stage>, u64)>,
    pub camera: Option<Camera>,
    /// A snapshot of the map and how many changes it holds; `changed` is what is new in it.
    pub map: Option<(FocusMap, u64)>,
    pub changed: Changes,
    /// Another way to put pictures on screen.
    pub tone: Option<Tone>,
    /// How coarse pictures may be while one works.
    pub tolerance: Option<Tolerance>,
    /// Nothing was wished for a while.
    pub is_idle: bool,
    /// The light field is to be made anew.
    pub bake: bool,
    /// An edit is complete: room for what takes longer.
    pub settle: bool,
    /// The user wants no more work for now.
    pub hold: bool,
    /// The light field that was made.
    pub delivery: Option<Delivery>,
    /// What became of the exact picture.
    pub refined: Option<Refined>,
    /// Work under way was told to stop when these were posted.
    stops: bool,
    is_posted: bool,
    quit: bool,
}

/// What of the work under way a wish makes useless.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Stops {
    Nothing,
    /// The exact picture.
    Refining,
    Everything,
}

/// What the threads and the session share.
pub(crate) struct Shared {
    wishes: Mutex<Wishes>,
    wake: Condvar,
    /// Of what the thread itself does: short.
    pub quick: JobProgress,
    /// Of what its helper does: long.
    pub progress: JobProgress,
    /// Of the exact picture.
    pub refining: JobProgress,
    is_refining: AtomicBool,
    /// Pictures that are being made for the user, which the exact one on screen waits for.
    exports: AtomicUsize,
    activity: AtomicU8,
    helper: AtomicU8,
    /// The light field that the helper makes.
    pub field: FieldWatch,
    published: Mutex<Published>,
    gpu: Option<Gpu>,
    waker: Waker,
}

#[derive(Default)]
struct Published {
    latest: Option<Preview>,
    news: News,
}

/// What happened since it was taken last.
#[derive(Default)]
pub(crate) struct News {
    /// What is new on screen, oldest first, and of which of the session's documents.
    pub patches: Vec<(u64, Patch)>,
    /// When the pictures were made that were finished, at their full size.
    pub finished: Vec<PictureTimes>,
    /// Another light field of full size, and of which of the session's documents.
    pub field: Option<(u64, BakedField)>,
    pub failures: Vec<String>,
    pub notices: Vec<String>,
}

/// A poisoned lock only means that a panic passed by; what it guards is replaced as a whole.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Shared {
    /// Waits for the next wishes; none when the session goes. When there are none for as long as `patience`, that is told.
    pub fn next(&self, patience: Option<Duration>) -> Option<Wishes> {
        let mut wishes = lock(&self.wishes);
        self.activity.store(PreviewActivity::Idle as u8, Ordering::Relaxed);
        (self.waker)();
        let until = patience.map(|patience| Instant::now() + patience);
        while !wishes.is_posted {
            let left = until.map(|until| until.saturating_duration_since(Instant::now()));
            wishes = match left {
                None => self.wake.wait(wishes).unwrap_or_else(PoisonError::into_inner),
                Some(Duration::ZERO) => return Some(Wishes { is_idle: true, ..Wishes::default() }),
                Some(left) => self.wake.wait_timeout(wishes, left).unwrap_or_else(PoisonError::into_inner).0,
            };
        }
        // What was cancelled is over, and this is new.
        self.quick.reset();
        self.activity.store(PreviewActivity::Splatting as u8, Ordering::Relaxed);
        if wishes.delivery.is_some() {
            self.helper.store(PreviewActivity::Idle as u8, Ordering::Relaxed);
        }
        let wishes = std::mem::take(&mut *wishes);
        (!wishes.quit).then_some(wishes)
    }

    fn post(&self, stops: Stops, change: impl FnOnce(&mut Wishes)) {
        let mut wishes = lock(&self.wishes);
        change(&mut wishes);
        wishes.is_posted = true;
        if stops != Stops::Nothing {
            self.refining.cancel();
        }
        if stops == Stops::Everything {
            wishes.stops = true;
            self.quick.cancel();
            self.progress.cancel();
        }
        self.wake.notify_one();
    }

    /// Notes what the thread does now, unless it was asked to stop.
    pub fn begin(&self, activity: PreviewActivity) -> Result<(), Cancelled> {
        self.quick.check()?;
        self.quick.begin_step("", 0.0, 1.0);
        self.activity.store(activity as u8, Ordering::Relaxed);
        Ok(())
    }

    /// Notes that the helper begins; false if what it would do is already known to be useless.
    pub fn begin_helper(&self) -> bool {
        let wishes = lock(&self.wishes);
        if wishes.stops {
            return false;
        }
        self.progress.reset();
        self.helper.store(PreviewActivity::Baking as u8, Ordering::Relaxed);
        true
    }

    /// Notes that the exact picture is begun; false if something was wished meanwhile.
    pub fn begin_refining(&self) -> bool {
        let wishes = lock(&self.wishes);
        if wishes.is_posted {
            return false;
        }
        self.refining.reset();
        self.is_refining.store(true, Ordering::Relaxed);
        (self.waker)();
        true
    }

    /// The exact picture is done, or given up.
    pub fn refined(&self, refined: Refined) {
        self.is_refining.store(false, Ordering::Relaxed);
        self.post(Stops::Nothing, |wishes| wishes.refined = Some(refined));
    }

    /// Notes that the helper has baked and sums now.
    pub fn helper_sums(&self) {
        self.helper.store(PreviewActivity::Splatting as u8, Ordering::Relaxed);
    }

    /// The helper is done.
    pub fn deliver(&self, delivery: Delivery) {
        self.post(Stops::Nothing, |wishes| wishes.delivery = Some(delivery));
    }

    /// Shows a picture, and what is new on screen by it; its times, if it was made just now.
    pub fn publish(&self, preview: Preview, patch: Option<Patch>, times: Option<PictureTimes>) {
        let mut published = lock(&self.published);
        if preview.quality > Quality::Coarse {
            published.news.finished.extend(times);
        }
        if let Some(patch) = patch {
            let is_whole = patch.is_whole();
            let patches = &mut published.news.patches;
            patches.retain(|_| !is_whole);
            patches.push((preview.generation, patch));
        }
        published.latest = Some(preview);
        drop(published);
        (self.waker)();
    }

    /// What the user is to know of a card that was lost.
    pub fn loss(&self) -> Option<String> {
        let gpu = self.gpu.as_ref()?;
        let why = gpu.why_lost()?.lines().next().unwrap_or_default();
        Some(format!("{} was lost ({why}): the processor sums the picture now", gpu.name()))
    }

    /// What pictures are summed on; none, or none any more: the processor.
    pub fn gpu(&self) -> Option<Gpu> {
        self.gpu.clone().filter(|gpu| !gpu.is_lost())
    }

    /// Shows the light field that pictures are made of.
    pub fn publish_field(&self, generation: u64, field: BakedField) {
        lock(&self.published).news.field = Some((generation, field));
    }

    /// Tells the user of what is no failure.
    pub fn notice(&self, what: String) {
        lock(&self.published).news.notices.push(what);
        (self.waker)();
    }

    /// Tells the user.
    pub fn fail(&self, what: String) {
        lock(&self.published).news.failures.push(what);
        (self.waker)();
    }
}

impl Shared {
    /// The light field that the preview makes now, if it serves `camera` in `stage`: it is waited for. None is another bake's time
    /// to begin: the preview's own is over by then, and has the processors for itself as long as it takes.
    pub fn wait_for_field(
        &self,
        stage: &Arc<Stage>,
        camera: &Camera,
        progress: &dyn Progress,
    ) -> Result<Option<Arc<Salf>>, Cancelled> {
        // What is left of the bake when the wait begins.
        let mut begun = None;
        loop {
            progress.check()?;
            match self.field.look(stage, camera, LOOK_EVERY) {
                Standing::Made(salf) => return Ok(Some(salf)),
                Standing::Underway => {
                    let baked = self.progress.fraction() / BAKE_SHARE;
                    let first = *begun.get_or_insert(baked);
                    progress.report((baked - first) / (1.0 - first).max(f32::EPSILON));
                }
                // What the thread does now may end in making one.
                Standing::Absent if self.is_at_work() => std::thread::sleep(LOOK_EVERY),
                Standing::Absent => return Ok(None),
            }
        }
    }

    /// Whether a picture is being made that the user asked for.
    pub fn is_exporting(&self) -> bool {
        self.exports.load(Ordering::Relaxed) > 0
    }

    /// Whether there is anything to be done.
    pub fn is_at_work(&self) -> bool {
        let wishes = lock(&self.wishes);
        let idle = [&self.activity, &self.helper]
            .into_iter()
            .all(|activity| PreviewActivity::load(activity) == PreviewActivity::Idle);
        wishes.is_posted || !idle
    }
}

/// While there is one, a picture is being made that the user asked for: that comes first, and the exact picture on screen, which
/// nobody asked for, after it.
pub(crate) struct Exporting(Arc<Shared>);

impl Exporting {
    /// Begins.
    pub fn new(shared: &Arc<Shared>) -> Self {
        shared.exports.fetch_add(1, Ordering::Relaxed);
        shared.refining.cancel();
        Self(shared.clone())
    }
}

impl Drop for Exporting {
    fn drop(&mut self) {
        self.0.exports.fetch_sub(1, Ordering::Relaxed);
        // There is time again.
        self.0.post(Stops::Nothing, |_| {});
    }
}

/// The session's end of the preview thread.
pub(crate) struct PreviewThread {
    shared: Arc<Shared>,
    thread: Option<std::thread::JoinHandle<()>>,
}

impl PreviewThread {
    /// Starts the thread. `exact_after`: for how long nothing must change until the exact picture is drawn; none: never.
    /// `store`: where light fields are kept. `gpu`: what pictures are summed on; none: the processor.
    pub fn start(
        waker: Waker,
        exact_after: Option<Duration>,
        store: Option<LightFieldStore>,
        gpu: Option<Gpu>,
    ) -> Result<Self, SessionError> {
        let shared = Arc::new(Shared {
            gpu,
            wishes: Mutex::default(),
            wake: Condvar::new(),
            quick: JobProgress::default(),
            progress: JobProgress::default(),
            refining: JobProgress::default(),
            is_refining: AtomicBool::new(false),
            exports: AtomicUsize::new(0),
            activity: AtomicU8::new(PreviewActivity::Idle as u8),
            helper: AtomicU8::new(PreviewActivity::Idle as u8),
            field: FieldWatch::default(),
            published: Mutex::default(),
            waker,
        });
        let (theirs, pool) = (shared.clone(), own_threads(Urgency::Now)?);
        let thread = std::thread::Builder::new()
            .name("preview".into())
            .stack_size(16 << 20)
            .spawn(move || pool.install(|| Worker::new(theirs, exact_after, store).run()))
            .map_err(|e| SessionError::TryAgain(format!("no preview thread: {e} (try again)")))?;
        Ok(Self { shared, thread: Some(thread) })
    }

    /// Another scene, with its focus.
    pub fn set_stage(&self, stage: (Arc<Stage>, u64), map: (FocusMap, u64), camera: Camera) {
        self.shared.post(Stops::Everything, |wishes| {
            wishes.stage = Some(stage);
            (wishes.camera, wishes.map) = (Some(camera), Some(map));
            wishes.changed = Changes::Everything;
            wishes.hold = false;
        });
    }

    /// Another camera, at the preview's size. `light_field_stays` where the old light field serves it.
    pub fn set_camera(&self, camera: Camera, light_field_stays: bool) {
        let stops = if light_field_stays { Stops::Refining } else { Stops::Everything };
        self.shared.post(stops, |wishes| {
            wishes.camera = Some(camera);
            wishes.settle = true;
            wishes.hold = false;
        });
    }

    /// Another state of the map, with how many changes it holds; `changed` is what is new in it.
    pub fn set_map(&self, map: (FocusMap, u64), changed: &Changes) {
        self.shared.post(Stops::Refining, |wishes| {
            wishes.map = Some(map);
            wishes.changed.join(changed);
        });
    }

    /// A stroke or another edit is complete.
    pub fn settle(&self) {
        self.shared.post(Stops::Nothing, |wishes| wishes.settle = true);
    }

    /// Makes the light field anew.
    pub fn bake(&self) {
        self.shared.post(Stops::Everything, |wishes| {
            wishes.bake = true;
            wishes.hold = false;
        });
    }

    /// Stops what is going on; the last picture stays.
    pub fn cancel(&self) {
        self.shared.post(Stops::Everything, |wishes| wishes.hold = true);
    }

    /// What is going on, and how far it is.
    pub fn activity(&self) -> (PreviewActivity, &JobProgress) {
        match PreviewActivity::load(&self.shared.helper) {
            PreviewActivity::Idle => (PreviewActivity::load(&self.shared.activity), &self.shared.quick),
            helper => (helper, &self.shared.progress),
        }
    }

    /// The newest picture, if there is one newer than `id`, and what happened meanwhile.
    pub fn take(&self, id: u64) -> (Option<Preview>, News) {
        let mut published = lock(&self.shared.published);
        let newer = published.latest.as_ref().filter(|preview| preview.id > id).cloned();
        (newer, std::mem::take(&mut published.news))
    }

    /// Puts pictures on screen in another way.
    pub fn set_tone(&self, tone: Tone) {
        self.shared.post(Stops::Nothing, |wishes| wishes.tone = Some(tone));
    }

    /// What others need of its work.
    pub fn shared(&self) -> Arc<Shared> {
        self.shared.clone()
    }

    /// Sets how coarse pictures may be while one works.
    pub fn set_tolerance(&self, tolerance: Tolerance) {
        self.shared.post(Stops::Refining, |wishes| {
            wishes.tolerance = Some(tolerance);
            wishes.hold = false;
        });
    }

    /// How far the exact picture is, while it is drawn.
    pub fn refining(&self) -> Option<f32> {
        self.shared.is_refining.load(Ordering::Relaxed).then(|| self.shared.refining.fraction())
    }

    /// Whether everything that was posted has been followed, and nothing newer than `id` waits to be taken.
    pub fn is_settled(&self, id: u64) -> bool {
        if self.shared.is_at_work() {
            return false;
        }
        let published = lock(&self.shared.published);
        published.news.failures.is_empty() && published.latest.as_ref().is_none_or(|p| p.id <= id)
    }
}

impl Drop for PreviewThread {
    fn drop(&mut self) {
        self.shared.post(Stops::Everything, |wishes| wishes.quit = true);
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has nothing left to hand over.
            let _ = thread.join();
        }
    }
}
