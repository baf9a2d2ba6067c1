//! A spare light field, baked once nothing has changed for a while, for a wider aperture than the lens's: when it is opened, or focus is
//! racked at a constant f-number, the spare shows at once what the light field that is worked with does not hold.

use crate::error::SessionError;
use crate::light_field::{Changes, FieldOptions, LightField};
use crate::preview::deliveries::FieldDelivery;
use crate::preview::helper_thread;
use crate::preview::mailbox::Shared;
use document::Stage;
use focus::Focus;
use graphics_card::Gpu;
use jobs::{Urgency, catch_panics, run_in_own_pool};
use lens::Camera;
use light::LightQuality;
use render::LightFieldStore;
use salf::Carried;
use splat::Tolerance;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Instant;

/// The spare, at rest or being made.
#[derive(Default)]
pub(crate) struct SpareField {
    field: Option<LightField>,
    thread: Option<JoinHandle<()>>,
    /// What changed since it was begun.
    pending_changes: Changes,
}

/// What a spare is to show.
pub(crate) struct SpareTask {
    pub stage: Arc<Stage>,
    /// What is baked.
    pub baked_camera: Camera,
    pub focus: Focus,
    pub tolerance: Tolerance,
    /// Comes back with the light field.
    pub epoch: u64,
}

impl SpareField {
    /// Whether a spare is being made.
    pub fn is_at_work(&self) -> bool {
        self.thread.is_some()
    }

    /// The spare.
    pub fn field(&self) -> Option<&LightField> {
        self.field.as_ref()
    }

    /// The spare, to work with it.
    pub fn field_mut(&mut self) -> Option<&mut LightField> {
        self.field.as_mut()
    }

    /// Whether there is a spare for what `camera` sees.
    pub fn is_ready_for(&self, camera: &Camera) -> bool {
        self.field.as_ref().is_some_and(|field| field.is_spare_for(camera))
    }

    /// Notes changes of the focus map.
    pub fn note(&mut self, changes: &Changes) {
        self.pending_changes.join(changes);
        if let Some(field) = &mut self.field {
            field.note(changes);
        }
    }

    /// Begins to make a spare, unless something else was requested meanwhile. What is baked is kept in `store`, if there is one.
    pub fn start(&mut self, shared: &Arc<Shared>, store: Option<LightFieldStore>, task: SpareTask) {
        if self.is_at_work() || !shared.begin_spare() {
            return;
        }
        self.pending_changes = Changes::default();
        let (thread_shared, epoch) = (shared.clone(), task.epoch);
        let work = move || {
            let make = || make(task, store.as_ref(), &thread_shared);
            let result =
                catch_panics("baking a spare light field", || run_in_own_pool(Urgency::Background, make));
            thread_shared.deliver_spare(FieldDelivery { result, epoch });
        };
        match helper_thread::spawn("spare light field", work) {
            Ok(thread) => self.thread = Some(thread),
            Err(error) => {
                shared.deliver_spare(FieldDelivery { result: Err(error), epoch });
            }
        }
    }

    /// Takes up what was made, with all that changed meanwhile noted.
    ///
    /// # Errors
    /// The error of the thread.
    pub fn take_up(&mut self, delivery: FieldDelivery, epoch: u64) -> Result<(), SessionError> {
        self.join();
        let pending_changes = std::mem::take(&mut self.pending_changes);
        match delivery.result {
            Ok(mut field) if delivery.epoch == epoch => {
                field.note(&pending_changes);
                self.field = Some(field);
                Ok(())
            }
            Ok(_) | Err(SessionError::Cancelled) => Ok(()),
            Err(error) => Err(error),
        }
    }

    /// Exchanges the spare with the light field that is worked with, if the spare shows what `camera` sees better. Returns whether it does. What
    /// is not worked with keeps no sum.
    pub fn exchange(&mut self, current: &mut Option<LightField>, camera: &Camera, gpu: Option<Gpu>) -> bool {
        let fit = |field: &Option<LightField>| field.as_ref()?.aperture_fit(camera);
        let is_better = match (fit(&self.field), fit(current)) {
            (Some(spare), Some(current)) => spare.is_better_than(current),
            (spare, _) => spare.is_some(),
        };
        if is_better {
            std::mem::swap(&mut self.field, current);
            if let (Some(replaced), Some(current)) = (self.field.take(), current) {
                current.expect_pace_of(&replaced);
                self.field = Some(replaced.at_rest_for(current, gpu));
            }
        }
        is_better
    }

    /// Keeps a light field that is not worked with any more, if it is a spare for what `camera` sees and there is none.
    pub fn offer(&mut self, replaced: LightField, camera: &Camera, gpu: Option<Gpu>) {
        if replaced.is_spare_for(camera) && !self.is_ready_for(camera) {
            self.field = Some(replaced.at_rest(gpu));
        }
    }

    /// Gives up a spare that cannot show what `camera` sees.
    pub fn tidy(&mut self, camera: &Camera) {
        self.field.take_if(|field| field.aperture_fit(camera).is_none());
    }

    /// Gives up the spare: its scene is gone.
    pub fn forget(&mut self) {
        self.field = None;
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
    task: SpareTask,
    store: Option<&LightFieldStore>,
    shared: &Shared,
) -> Result<LightField, SessionError> {
    let SpareTask { stage, baked_camera, focus, tolerance, .. } = task;
    let carried = Carried::for_focus(&focus);
    let stored = store.and_then(|store| store.find(&stage, &baked_camera, 0.0, carried, shared.baked_on()));
    let mut field = match stored {
        Some((salf, passes)) => {
            LightField::from_salf(&stage, Arc::new(salf), tolerance, shared.gpu()).refined(passes)
        }
        None => {
            let (gpu, bake_on, light) = (shared.gpu(), shared.bake_on(), LightQuality::Fine);
            let options = FieldOptions { least_margin_px: 0.0, tolerance, gpu, bake_on, light };
            let start = Instant::now();
            let field = LightField::bake(&stage, &baked_camera, &focus, options, &shared.spare)?;
            shared.count_bake();
            if let Some(store) = store {
                store.save(&stage, &field.baked().salf, 0, start.elapsed());
            }
            field
        }
    };
    field.look_up_paint(&focus);
    Ok(field)
}
