//! The live preview: a thread that owns the light field and keeps its picture up to date.
//!
//! The session posts what is wanted (scene, camera, changed texels) into one mailbox; newer wishes replace or
//! join older ones there, so that the thread, whenever it looks, does the least that leads to the newest state:
//!
//! ```text
//! scene, pose, size, background, wider aperture ──▶ pinhole picture, bake ─┐
//! focus distance, smaller aperture, shape ──────────────────────────────▶ full splat ─┐
//! paint ────────────────────────────────────▶ samples of the changed texels: update ──┴─▶ publish
//! ```
//!
//! It works on a snapshot of the focus map (tiles are shared until one is painted on): neither ever waits for the
//! other. A bake is stopped when a newer wish makes it useless; a splat is short and always
//! finished, so that a dragged slider shows pictures on its way. The last good picture is never taken away.

use crate::job::{JobProgress, Waker};
use crate::preview_worker::Worker;
use crate::{SessionError, Stage};
use focus::FocusMap;
use lens::{Camera, Picture};
use progress::{Cancelled, Progress};
use salf::SalfStatistics;
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard};

/// A picture of the preview.
#[derive(Clone, Debug)]
pub struct Preview {
    /// Counts up: a newer picture has a greater id.
    pub id: u64,
    /// The picture, radiance and coverage.
    pub picture: Arc<Picture>,
    /// How it was made.
    pub kind: PreviewKind,
    /// The camera it was made with, at the preview's size.
    pub camera: Camera,
    /// Seconds that making it took.
    pub seconds: f64,
    /// Samples of the light field; none for a pinhole picture.
    pub statistics: SalfStatistics,
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

/// What the preview thread is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PreviewActivity {
    /// Nothing to do.
    Idle,
    /// Making the light field.
    Baking,
    /// Summing the picture.
    Splatting,
}

/// Everything that changed since the thread last looked.
#[derive(Default)]
pub(crate) struct Wishes {
    /// Another scene, and which of the session's documents it is.
    pub stage: Option<(Arc<Stage>, u64)>,
    pub camera: Option<Camera>,
    /// A snapshot of the map, and the texels that changed since the one before.
    pub map: Option<FocusMap>,
    pub changed: Changes,
    pub bake: bool,
    /// Nothing more is to come for now: room for things that take longer.
    pub settle: bool,
    quit: bool,
}

/// What of the map changed.
#[derive(Clone, Debug)]
pub(crate) enum Changes {
    /// These texels.
    Texels(Vec<[u32; 2]>),
    /// All of it, or the background.
    Everything,
}

impl Default for Changes {
    fn default() -> Self {
        Self::Texels(Vec::new())
    }
}

impl Changes {
    fn join(&mut self, newer: Changes) {
        match (&mut *self, newer) {
            (Self::Texels(texels), Self::Texels(more)) => texels.extend(more),
            _ => *self = Self::Everything,
        }
    }
}

impl Wishes {
    fn any(&self) -> bool {
        self.stage.is_some()
            || self.camera.is_some()
            || self.map.is_some()
            || self.bake
            || self.settle
            || self.quit
    }
}

/// What the thread and the session share.
pub(crate) struct Shared {
    wishes: Mutex<Wishes>,
    wake: Condvar,
    pub progress: JobProgress,
    /// Whether what the thread does is to be given up for any newer wish.
    pub yields: AtomicBool,
    activity: AtomicU8,
    published: Mutex<Published>,
    waker: Waker,
}

impl Shared {
    /// Waits for the next wishes; none when the session goes.
    pub fn next(&self) -> Option<Wishes> {
        let mut wishes = lock(&self.wishes);
        self.activity.store(PreviewActivity::Idle as u8, Ordering::Relaxed);
        (self.waker)();
        while !wishes.any() {
            wishes = self.wake.wait(wishes).unwrap_or_else(std::sync::PoisonError::into_inner);
        }
        // What was cancelled is over, and this is new.
        self.progress.reset();
        self.activity.store(PreviewActivity::Splatting as u8, Ordering::Relaxed);
        let wishes = std::mem::take(&mut *wishes);
        (!wishes.quit).then_some(wishes)
    }

    /// Whether nothing is wished for.
    pub fn is_quiet(&self) -> bool {
        !lock(&self.wishes).any()
    }

    /// Notes what the thread does now, unless it was asked to stop.
    pub fn begin(&self, activity: PreviewActivity) -> Result<(), Cancelled> {
        self.progress.check()?;
        self.activity.store(activity as u8, Ordering::Relaxed);
        Ok(())
    }

    /// Shows a picture.
    pub fn publish(&self, preview: Preview) {
        lock(&self.published).latest = Some(preview);
        (self.waker)();
    }

    /// Tells the user.
    pub fn fail(&self, what: String) {
        lock(&self.published).failures.push(what);
        (self.waker)();
    }
}

#[derive(Default)]
pub(crate) struct Published {
    latest: Option<Preview>,
    failures: Vec<String>,
}

/// A poisoned lock only means that a panic passed by; what it guards is replaced as a whole.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// The session's end of the preview thread.
pub(crate) struct PreviewThread {
    shared: Arc<Shared>,
    thread: Option<std::thread::JoinHandle<()>>,
}

impl PreviewThread {
    pub fn start(waker: Waker) -> Result<Self, SessionError> {
        let shared = Arc::new(Shared {
            wishes: Mutex::default(),
            wake: Condvar::new(),
            progress: JobProgress::default(),
            yields: AtomicBool::new(false),
            activity: AtomicU8::new(0),
            published: Mutex::default(),
            waker,
        });
        let theirs = shared.clone();
        let thread = std::thread::Builder::new()
            .name("preview".into())
            .stack_size(16 << 20)
            .spawn(move || Worker::new(theirs).run())
            .map_err(|e| SessionError::TryAgain(format!("no preview thread: {e} (try again)")))?;
        Ok(Self { shared, thread: Some(thread) })
    }

    fn post(&self, stops_bake: bool, change: impl FnOnce(&mut Wishes)) {
        let mut wishes = lock(&self.shared.wishes);
        change(&mut wishes);
        if stops_bake || self.shared.yields.load(Ordering::Relaxed) {
            self.shared.progress.cancel();
        }
        self.shared.wake.notify_one();
    }

    /// Another scene, with its focus.
    pub fn set_stage(&self, stage: (Arc<Stage>, u64), map: FocusMap, camera: Camera) {
        self.post(true, |wishes| {
            let (stage, camera, map) = (Some(stage), Some(camera), Some(map));
            *wishes = Wishes {
                stage,
                camera,
                map,
                changed: Changes::Everything,
                quit: wishes.quit,
                ..Wishes::default()
            };
        });
    }

    /// Another camera, at the preview's size. `light_field_stays` where the old light field serves it.
    pub fn set_camera(&self, camera: Camera, light_field_stays: bool) {
        self.post(!light_field_stays, |wishes| {
            wishes.camera = Some(camera);
            wishes.settle = true;
        });
    }

    /// A stroke or another edit is complete.
    pub fn settle(&self) {
        self.post(false, |wishes| wishes.settle = true);
    }

    /// Another state of the map; `changed` is what is new in it.
    pub fn set_map(&self, map: FocusMap, changed: Changes) {
        self.post(false, |wishes| {
            wishes.map = Some(map);
            wishes.changed.join(changed);
        });
    }

    pub fn bake(&self) {
        self.post(true, |wishes| wishes.bake = true);
    }

    /// Stops the bake that is going on; the last picture stays.
    pub fn cancel(&self) {
        self.shared.progress.cancel();
    }

    pub fn activity(&self) -> (PreviewActivity, f32) {
        let activity = match self.shared.activity.load(Ordering::Relaxed) {
            x if x == PreviewActivity::Baking as u8 => PreviewActivity::Baking,
            x if x == PreviewActivity::Splatting as u8 => PreviewActivity::Splatting,
            _ => PreviewActivity::Idle,
        };
        (activity, self.shared.progress.fraction())
    }

    /// The newest picture, if there is one newer than `id`, and what failed meanwhile.
    pub fn take(&self, id: u64) -> (Option<Preview>, Vec<String>) {
        let mut published = lock(&self.shared.published);
        let newer = published.latest.as_ref().filter(|preview| preview.id > id).cloned();
        (newer, std::mem::take(&mut published.failures))
    }

    /// Whether everything that was posted has been followed, and nothing newer than `id` waits to be taken.
    pub fn is_settled(&self, id: u64) -> bool {
        let wishes = lock(&self.shared.wishes);
        let idle = self.shared.activity.load(Ordering::Relaxed) == PreviewActivity::Idle as u8;
        let published = lock(&self.shared.published);
        let seen = published.failures.is_empty() && published.latest.as_ref().is_none_or(|p| p.id <= id);
        !wishes.any() && idle && seen
    }
}

impl Drop for PreviewThread {
    fn drop(&mut self) {
        self.post(true, |wishes| wishes.quit = true);
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has nothing left to hand over.
            let _ = thread.join();
        }
    }
}

/// The camera of a light field serves `camera` too.
pub(crate) fn serves(baked: &Camera, camera: &Camera) -> bool {
    let like = Camera {
        focus_distance: baked.focus_distance,
        aperture: baked.aperture.clone(),
        aperture_radius: baked.aperture_radius,
        ..camera.clone()
    };
    like == *baked && camera.aperture_radius <= baked.aperture_radius
}
