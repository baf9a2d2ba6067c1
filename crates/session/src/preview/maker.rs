//! Making the light field of the preview: a thread of its own bakes and sums it.

use super::deliveries::{BAKE_SHARE, BETWEEN_SHARE, Between, Delivery};
use super::mailbox::Shared;
use crate::document::Stage;
use crate::error::SessionError;
use crate::jobs::{Urgency, among_others, guarded};
use crate::light_field::{Changes, FieldOptions, LightField, LightFieldStore, LightQuality};
use focus::Focus;
use lens::Camera;
use progress::Stage as Share;
use salf::Carried;
use splat::Tolerance;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// What is begun with.
pub(crate) enum Begin {
    /// A light field that is there.
    Sum(Box<LightField>),
    /// None: it is taken from the store or baked, with a margin of at least this many pixels.
    Find { least_margin_px: f64 },
    /// None: it is baked, whatever is in the store.
    Bake,
}

/// What the light field is to show.
pub(crate) struct Order {
    pub begin: Begin,
    pub stage: Arc<Stage>,
    pub camera: Camera,
    /// That of a light field of fewer pixels, which is handed over first if there is anything to bake.
    pub between: Option<Camera>,
    pub focus: Focus,
    pub tolerance: Tolerance,
    /// Comes back with the light field.
    pub epoch: u64,
}

/// At rest or at work on one light field.
pub(crate) struct LightFieldMaker {
    store: Option<LightFieldStore>,
    thread: Option<JoinHandle<()>>,
    /// What changed since it began.
    since: Changes,
}

impl LightFieldMaker {
    /// At rest. What is baked is kept in `store`, if there is one.
    pub fn new(store: Option<LightFieldStore>) -> Self {
        Self { store, thread: None, since: Changes::default() }
    }

    /// Whether the light field need not be baked.
    pub fn has_stored(&self, stage: &Stage, camera: &Camera) -> bool {
        self.store.as_ref().is_some_and(|store| store.has(stage, camera))
    }

    /// Keeps a light field of refined light, if there is a store.
    pub fn keep(&self, stage: &Arc<Stage>, field: &LightField, bake_seconds: f64) {
        if let Some(store) = &self.store {
            let bake = Duration::from_secs_f64(bake_seconds);
            store.keep(stage, &field.baked().salf, field.light_passes(), bake);
        }
    }

    /// Whether a light field is being made.
    pub fn is_at_work(&self) -> bool {
        self.thread.is_some()
    }

    /// Begins, unless that is already known to be useless. What is made is delivered to `shared`.
    pub fn start(&mut self, shared: &Arc<Shared>, order: Order) {
        if !shared.begin_helper() {
            return;
        }
        self.since = Changes::default();
        let (theirs, epoch, store) = (shared.clone(), order.epoch, self.store.clone());
        let is_there = matches!(order.begin, Begin::Sum(_));
        if !is_there {
            // Whoever asks from now on waits for it.
            shared.field.begin(&order.stage);
        }
        // One that is there has only to be summed for another lens that somebody turns.
        let urgency = if is_there { Urgency::Now } else { Urgency::Later };
        let work = move || {
            let make = || make(order, &theirs, store.as_ref());
            let made = guarded("drawing the preview", || among_others(urgency, make));
            theirs.field.end();
            theirs.deliver(Delivery { made, epoch });
        };
        let thread = std::thread::Builder::new().name("light field".into()).stack_size(16 << 20).spawn(work);
        match thread {
            Ok(thread) => self.thread = Some(thread),
            Err(error) => {
                let made = Err(SessionError::TryAgain(format!("no thread: {error} (try again)")));
                shared.field.end();
                shared.deliver(Delivery { made, epoch });
            }
        }
    }

    /// Notes changes of the focus map.
    pub fn note(&mut self, changes: &Changes) {
        self.since.join(changes);
    }

    /// What was made first, with all that changed meanwhile noted.
    pub fn take_up_between(&self, between: Between) -> (LightField, u64) {
        let Between { mut field, epoch } = between;
        field.note(&self.since);
        (field, epoch)
    }

    /// What was made, with all that changed meanwhile noted.
    pub fn take_up(&mut self, delivery: Delivery) -> Result<(LightField, u64), SessionError> {
        self.join();
        let since = std::mem::take(&mut self.since);
        let mut field = delivery.made?;
        field.note(&since);
        Ok((field, delivery.epoch))
    }

    /// Waits for the thread, which was told to stop or is done.
    pub fn join(&mut self) {
        if let Some(thread) = self.thread.take() {
            // Its result is delivered; its panics were caught.
            let _ = thread.join();
        }
    }
}

fn make(order: Order, shared: &Shared, store: Option<&LightFieldStore>) -> Result<LightField, SessionError> {
    let Order { begin, stage, camera, between, focus, tolerance, epoch } = order;
    let bake = |least_margin_px| {
        let how = |least_margin_px| FieldOptions {
            least_margin_px,
            tolerance,
            gpu: shared.gpu(),
            light: LightQuality::Fine,
        };
        shared.progress.begin_step("", 0.0, BAKE_SHARE);
        let mut done = 0.0;
        if let Some(between) = &between {
            let share = Share::new(&shared.progress, 0.0, BETWEEN_SHARE);
            let field = LightField::bake(&stage, between, &focus, how(0.0), &share)?;
            shared.deliver_between(Between { field, epoch });
            done = BETWEEN_SHARE;
        }
        let start = Instant::now();
        let share = Share::new(&shared.progress, done, BAKE_SHARE);
        let field = LightField::bake(&stage, &camera, &focus, how(least_margin_px), &share)?;
        if let Some(store) = store {
            store.keep(&stage, &field.baked().salf, 0, start.elapsed());
        }
        Ok::<_, SessionError>(field)
    };
    // One that is there has another lens to show, and no time.
    let is_begun = matches!(begin, Begin::Sum(_));
    let mut field = match begin {
        Begin::Sum(field) => *field,
        Begin::Bake => bake(0.0)?,
        Begin::Find { least_margin_px } => {
            let carried = Carried::of(&focus);
            let stored = store.and_then(|store| store.find(&stage, &camera, least_margin_px, carried));
            match stored {
                Some((salf, passes)) => {
                    LightField::of(&stage, Arc::new(salf), tolerance, shared.gpu()).refined(passes)
                }
                None => bake(least_margin_px)?,
            }
        }
    };
    shared.field.made(&field.baked().salf);
    shared.helper_sums();
    shared.progress.begin_step("", BAKE_SHARE, 1.0);
    field.bring_up(&camera, &focus, &Share::new(&shared.progress, BAKE_SHARE, 1.0))?;
    field.survey(&camera, &focus);
    if !is_begun {
        field.prepare()(&shared.progress);
    }
    Ok(field)
}
