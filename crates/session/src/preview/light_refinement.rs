//! Light that is refined, once nothing has changed for a while.
//!
//! The light at once is what is kept for every camera, and a little off. Here light fields are baked whose light is found by paths
//! ([`LightQuality::Refined`]), on a thread of its own, each by four times as many as the one before. How far two that follow each other are apart tells the
//! noise of the later one; how far it is from the picture that stands, what that one is off. From when on it is the nearer one to the
//! truth, it stands. Paint and lenses do not stop it: they are of no concern to light.

use crate::error::SessionError;
use crate::light_field::{Changes, FieldOptions, LightField};
use crate::preview::deliveries::{FinerField, RefinedLightDelivery};
use crate::preview::exact_refinement::mean_square_difference;
use crate::preview::helper_thread;
use crate::preview::mailbox::Shared;
use document::Stage;
use focus::Focus;
use graphics_card::Gpu;
use jobs::{Urgency, catch_panics, run_in_own_pool};
use lens::{Camera, Exposure, Picture};
use light::{LightErrors, LightQuality};
use progress::Stage as Share;
use render::LightFieldStore;
use splat::Tolerance;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Instant;

/// The share of a pass that has gone by when the picture of the one before is summed, and when the light field is baked.
const COMPARED_SHARE: f32 = 0.05;
const BAKED_SHARE: f32 = 0.95;

/// At rest or at work on one light field.
#[derive(Default)]
pub(crate) struct LightRefinement {
    /// What was made last and is not better yet than what stands: its samples alone, to compare the next one with.
    last: Option<LightField>,
    thread: Option<JoinHandle<()>>,
    /// What was made, until there is time to take it up.
    finished: Option<RefinedLightDelivery>,
    /// What changed since it began.
    pending_changes: Changes,
}

/// What is refined.
pub(crate) struct LightTask {
    pub stage: Arc<Stage>,
    pub camera: Camera,
    pub focus: Focus,
    pub tolerance: Tolerance,
    /// The picture that stands, of this lens and focus.
    pub displayed: Arc<Picture>,
    /// How pictures are compared.
    pub exposure: Exposure,
    /// The margin that the light field is to have at least, px.
    pub margin_px: f64,
    /// By how many passes.
    pub passes: u32,
    /// Comes back with the light field.
    pub epoch: u64,
}

impl LightRefinement {
    /// Whether light is being refined, or was and is not taken up.
    pub fn is_at_work(&self) -> bool {
        self.thread.is_some() || self.finished.is_some()
    }

    /// By how many passes the light of what `camera` sees is to be refined next that stands by so many, if `most` allows it.
    pub fn next_passes(&self, camera: &Camera, displayed_passes: u32, max_passes: u32) -> Option<u32> {
        let last = self.last.as_ref().filter(|last| last.can_show(camera));
        let done_passes = last.map_or(0, LightField::light_passes).max(displayed_passes);
        LightFieldStore::LIGHT_PASSES
            .into_iter()
            .find(|&passes| passes > done_passes)
            .filter(|&passes| passes <= max_passes)
    }

    /// Notes changes of the focus map that were made meanwhile.
    pub fn note(&mut self, changes: &Changes) {
        self.pending_changes.join(changes);
        if let Some(last) = &mut self.last {
            last.note(changes);
        }
    }

    /// Starts to refine light, unless something else was requested meanwhile.
    pub fn start(&mut self, shared: &Arc<Shared>, task: LightTask) {
        if self.is_at_work() || !shared.begin_light(task.passes) {
            return;
        }
        self.pending_changes = Changes::default();
        let last = self.last.take().filter(|last| last.can_show(&task.camera));
        let (thread_shared, epoch) = (shared.clone(), task.epoch);
        let work = move || {
            let result = catch_panics("refining the light", || {
                run_in_own_pool(Urgency::Background, || make(task, last, &thread_shared))
            });
            thread_shared.deliver_refined_light(RefinedLightDelivery { result, epoch });
        };
        match helper_thread::spawn("refined light", work) {
            Ok(thread) => self.thread = Some(thread),
            Err(error) => {
                shared.deliver_refined_light(RefinedLightDelivery { result: Err(error), epoch });
            }
        }
    }

    /// Takes back what the thread has made.
    pub fn take_back(&mut self, delivery: RefinedLightDelivery) {
        self.join();
        self.finished = Some(delivery);
    }

    /// What was made, with all that changed meanwhile noted, if it is better than what stands, which was refined by so many passes; else it
    /// is kept, to be compared with. `None` if there is nothing to take up.
    ///
    /// # Errors
    /// The error of the thread.
    pub fn take_up(
        &mut self,
        epoch: u64,
        displayed_passes: u32,
        gpu: Option<Gpu>,
    ) -> Result<Option<FinerField>, SessionError> {
        let Some(RefinedLightDelivery { result, epoch: of_epoch }) = self.finished.take() else {
            return Ok(None);
        };
        let mut finer = match result {
            Ok(finer) if of_epoch == epoch => finer,
            Ok(_) | Err(SessionError::Cancelled) => return Ok(None),
            Err(error) => return Err(error),
        };
        finer.field.note(&std::mem::take(&mut self.pending_changes));
        let is_improvement = match finer.errors {
            Some(errors) => errors.refined < errors.displayed,
            None => false,
        };
        if is_improvement || displayed_passes > 0 {
            return Ok(Some(finer));
        }
        self.last = Some(finer.field.at_rest(gpu));
        Ok(None)
    }

    /// Gives up what was made: its scene or camera is gone.
    pub fn forget(&mut self) {
        self.last = None;
    }

    /// What waits to be compared, between two passes.
    pub fn field(&self) -> Option<&LightField> {
        self.last.as_ref()
    }

    /// Waits for the thread, which was told to stop or is done.
    pub fn join(&mut self) {
        if let Some(thread) = self.thread.take() {
            // Its result is delivered; its panics were caught.
            let _ = thread.join();
        }
    }
}

fn make(task: LightTask, last: Option<LightField>, shared: &Shared) -> Result<FinerField, SessionError> {
    let LightTask { stage, camera, focus, tolerance, displayed, exposure, margin_px, passes, .. } = task;
    // Summed first and given up: while the next one is baked its picture is enough.
    let mut summed_last = None;
    if let Some(mut last) = last {
        last.set_tolerance(tolerance);
        last.update_sum(&camera, &focus, &Share::new(&shared.light, 0.0, COMPARED_SHARE))?;
        summed_last = Some(last.fetch_picture()?.clone());
    }
    let light = LightQuality::Refined { passes };
    let (gpu, bake_on) = (shared.gpu(), shared.bake_on());
    let options = FieldOptions { least_margin_px: margin_px, tolerance, gpu, bake_on, light };
    let start = Instant::now();
    let baking = Share::new(&shared.light, COMPARED_SHARE, BAKED_SHARE);
    let mut field = LightField::bake(&stage, &camera, &focus, options, &baking)?;
    let seconds = start.elapsed().as_secs_f64();
    let summing = Share::new(&shared.light, BAKED_SHARE, 1.0);
    field.update_sum(&camera, &focus, &summing)?;
    field.release_room();
    field.survey(&camera, &focus);
    let mut errors = None;
    if let Some(last) = summed_last {
        let refined = field.fetch_picture()?;
        errors = Some(LightErrors::from_mean_squares(
            mean_square_difference(&last, refined, exposure),
            mean_square_difference(&displayed, refined, exposure),
        ));
    }
    field.prepare()(&shared.light);
    Ok(FinerField { field, errors, seconds })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_are_four_times_as_many_until_there_are_enough() {
        let refinement = LightRefinement::default();
        let camera = Camera::default();
        let next = |displayed_passes| refinement.next_passes(&camera, displayed_passes, 256);
        assert_eq!([next(0), next(4), next(64), next(256)], [Some(4), Some(16), Some(256), None]);
        assert_eq!(refinement.next_passes(&camera, 0, 0), None, "it is never refined");
    }
}
