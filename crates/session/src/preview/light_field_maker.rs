//! Making the light field of the preview: a thread of its own bakes and sums it.

use crate::error::SessionError;
use crate::light_field::{Changes, FieldOptions, LightField, Relightable, spare_camera};
use crate::preview::activity::PreviewActivity;
use crate::preview::deliveries::{BAKE_SHARE, FieldDelivery, INTERIM_SHARE, InterimField, LIGHT_SHARE};
use crate::preview::helper_thread;
use crate::preview::mailbox::Shared;
use document::Stage;
use focus::Focus;
use jobs::{Urgency, catch_panics, run_in_own_pool};
use lens::Camera;
use light::LightQuality;
use progress::{Progress, Stage as Share, Unwatched};
use render::LightFieldStore;
use salf::{BakedOn, Carried, LightChange};
use splat::Tolerance;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// What is begun with.
pub(crate) enum FieldOrigin {
    /// One that is there, in other light.
    Relit(Relightable, LightChange),
    /// None: it is taken from the store or baked, with a margin of at least this many pixels.
    LoadOrBake { least_margin_px: f64 },
    /// None: it is baked, whatever is in the store.
    Bake,
}

/// What the light field is to show.
pub(crate) struct FieldOrder {
    pub origin: FieldOrigin,
    pub stage: Arc<Stage>,
    pub camera: Camera,
    /// That of a light field of fewer pixels, which is handed over first if there is anything to bake.
    pub interim: Option<Camera>,
    pub focus: Focus,
    pub tolerance: Tolerance,
    /// Comes back with the light field.
    pub epoch: u64,
}

/// At rest or at work on one light field.
pub(crate) struct LightFieldMaker {
    store: Option<LightFieldStore>,
    thread: Option<JoinHandle<()>>,
    /// What it is made for.
    stage: Option<Arc<Stage>>,
    /// What changed since it began.
    pending_changes: Changes,
}

/// What was made, with all that changed meanwhile noted.
pub(crate) struct MadeField {
    pub field: LightField,
    /// What it was made for.
    pub stage: Arc<Stage>,
    /// The epoch in which it was asked for.
    pub epoch: u64,
}

impl LightFieldMaker {
    /// At rest. What is baked is kept in `store`, if there is one.
    pub fn new(store: Option<LightFieldStore>) -> Self {
        Self { store, thread: None, stage: None, pending_changes: Changes::default() }
    }

    /// Whether a stored light field, baked on this, can be read, so that none need be baked.
    pub fn has_stored(&self, stage: &Stage, camera: &Camera, on: BakedOn) -> bool {
        self.store.as_ref().is_some_and(|store| store.has(stage, camera, on))
    }

    /// Where light fields are kept.
    pub fn store(&self) -> Option<LightFieldStore> {
        self.store.clone()
    }

    /// Keeps a light field of refined light, if there is a store.
    pub fn save(&self, stage: &Arc<Stage>, field: &LightField, bake_seconds: f64) {
        if let Some(store) = &self.store {
            let bake = Duration::from_secs_f64(bake_seconds);
            store.save(stage, &field.baked().salf, field.light_passes(), bake);
        }
    }

    /// Whether a light field is being made.
    pub fn is_at_work(&self) -> bool {
        self.thread.is_some()
    }

    /// Begins, unless that is already known to be useless. What is made is delivered to `shared`.
    pub fn start(&mut self, shared: &Arc<Shared>, order: FieldOrder) {
        if !shared.begin_helper(PreviewActivity::Baking) {
            return;
        }
        self.pending_changes = Changes::default();
        self.stage = Some(order.stage.clone());
        let (thread_shared, epoch, store) = (shared.clone(), order.epoch, self.store.clone());
        // Whoever asks from now on waits for it.
        shared.field.begin(&order.stage);
        let work = move || {
            let make = || make(order, &thread_shared, store.as_ref());
            let result = catch_panics("drawing the preview", || run_in_own_pool(Urgency::Background, make));
            thread_shared.field.end();
            thread_shared.deliver(FieldDelivery { result, epoch });
        };
        match helper_thread::spawn("light field", work) {
            Ok(thread) => self.thread = Some(thread),
            Err(error) => {
                shared.field.end();
                shared.deliver(FieldDelivery { result: Err(error), epoch });
            }
        }
    }

    /// Notes changes of the focus map that were made meanwhile.
    pub fn note(&mut self, changes: &Changes) {
        self.pending_changes.join(changes);
    }

    /// What was made first, with all that changed meanwhile noted.
    pub fn take_up_interim(&self, interim: InterimField) -> (LightField, u64) {
        let InterimField { mut field, epoch } = interim;
        field.note(&self.pending_changes);
        (field, epoch)
    }

    /// The light field that was made; `None` if it never began.
    ///
    /// # Errors
    /// The error of the thread.
    pub fn take_up(&mut self, delivery: FieldDelivery) -> Result<Option<MadeField>, SessionError> {
        self.join();
        let pending_changes = std::mem::take(&mut self.pending_changes);
        let (mut field, epoch) = (delivery.result?, delivery.epoch);
        field.note(&pending_changes);
        Ok(self.stage.take().map(|stage| MadeField { field, stage, epoch }))
    }

    /// Waits for the thread, which was told to stop or is done.
    pub fn join(&mut self) {
        if let Some(thread) = self.thread.take() {
            // Its result is delivered; its panics were caught.
            let _ = thread.join();
        }
    }
}

fn make(
    order: FieldOrder,
    shared: &Shared,
    store: Option<&LightFieldStore>,
) -> Result<LightField, SessionError> {
    let FieldOrder { origin, stage, camera, interim, focus, tolerance, epoch } = order;
    let bake = |least_margin_px| {
        let light = LightQuality::Fine;
        let options_with_margin = |least_margin_px| {
            let (gpu, bake_on) = (shared.gpu(), shared.bake_on());
            FieldOptions { least_margin_px, tolerance, gpu, bake_on, light }
        };
        shared.progress.begin_step("", 0.0, BAKE_SHARE);
        // Both light fields are baked in the light that is solved now.
        stage.lit.solve(&camera, light, &Share::named(&shared.progress, "light", 0.0, LIGHT_SHARE))?;
        let mut done_share = LIGHT_SHARE;
        if let Some(interim) = &interim {
            let share = Share::new(&shared.progress, LIGHT_SHARE, INTERIM_SHARE);
            let opened = spare_camera(interim).unwrap_or_else(|| interim.clone());
            let field = LightField::bake(&stage, &opened, &focus, options_with_margin(0.0), &share)?;
            shared.deliver_interim(InterimField { field, epoch });
            done_share = INTERIM_SHARE;
        }
        let start = Instant::now();
        let share = Share::new(&shared.progress, done_share, BAKE_SHARE);
        let field = LightField::bake(&stage, &camera, &focus, options_with_margin(least_margin_px), &share)?;
        shared.count_bake();
        if let Some(store) = store {
            store.save(&stage, &field.baked().salf, 0, start.elapsed());
        }
        Ok::<_, SessionError>(field)
    };
    let field = match origin {
        FieldOrigin::Bake => bake(0.0)?,
        FieldOrigin::Relit(field, light) => match field.in_light(&light, shared.gpu()) {
            // It is shown even if the light changes again: what is dragged is followed.
            Some(field) => return summed(field, &camera, &focus, &Unwatched),
            None => bake(0.0)?,
        },
        FieldOrigin::LoadOrBake { least_margin_px } => {
            let carried = Carried::for_focus(&focus);
            let stored = store
                .and_then(|store| store.find(&stage, &camera, least_margin_px, carried, shared.baked_on()));
            match stored {
                Some((salf, passes)) => {
                    LightField::from_salf(&stage, Arc::new(salf), tolerance, shared.gpu()).refined(passes)
                }
                None => bake(least_margin_px)?,
            }
        }
    };
    // Exports share it; not what was shown in other light, which is rounded otherwise than what is baked in it.
    shared.field.set_baked(&field.baked().salf);
    shared.begin_helper_sum();
    shared.progress.begin_step("", BAKE_SHARE, 1.0);
    summed(field, &camera, &focus, &Share::new(&shared.progress, BAKE_SHARE, 1.0))
}

/// A light field with its sum, ready for dabs.
fn summed(
    mut field: LightField,
    camera: &Camera,
    focus: &Focus,
    progress: &dyn Progress,
) -> Result<LightField, SessionError> {
    field.update_sum(camera, focus, progress)?;
    field.survey(camera, focus);
    field.prepare()(progress);
    Ok(field)
}
