//! Light that is refined, once nothing has changed for a while.
//!
//! The light at once is what is kept for every camera, and a little off. Here light fields are baked whose light is found by paths
//! ([`LightQuality::Refined`]), on a thread of its own, each by four times as many as the one before. How far two that follow each other are apart tells the
//! noise of the later one; how far it is from the picture that stands, what that one is off. From when on it is the nearer one to the
//! truth, it stands. Paint and lenses do not stop it: they are of no concern to light.

use super::deliveries::{Finer, RefinedLight};
use super::mailbox::Shared;
use super::refinement::square_between;
use crate::document::Stage;
use crate::error::SessionError;
use crate::jobs::{Urgency, among_others, guarded};
use crate::light_field::{Changes, FieldOptions, LIGHT_PASSES, LightErrors, LightField, LightQuality};
use focus::Focus;
use lens::{Camera, Exposure, Picture};
use progress::Stage as Share;
use splat::Tolerance;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Instant;

/// The share of a pass that the bake is; the rest is the sum.
const BAKE_SHARE: f32 = 0.9;

/// At rest or at work on one light field.
#[derive(Default)]
pub(crate) struct LightRefinement {
    /// What was made last and is not better yet than what stands.
    last: Option<LightField>,
    thread: Option<JoinHandle<()>>,
    /// What was made, until there is time to take it up.
    made: Option<RefinedLight>,
    /// What changed since it began.
    since: Changes,
}

/// What is refined.
pub(crate) struct Task {
    pub stage: Arc<Stage>,
    pub camera: Camera,
    pub focus: Focus,
    pub tolerance: Tolerance,
    /// The picture that stands, of this lens and focus.
    pub standing: Arc<Picture>,
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
        self.thread.is_some() || self.made.is_some()
    }

    /// By how many passes the light of what `camera` sees is to be refined next that stands by so many, if `most` allows it.
    pub fn next_passes(&self, camera: &Camera, standing: u32, most: u32) -> Option<u32> {
        let last = self.last.as_ref().filter(|last| last.serves(camera));
        let made = last.map_or(0, LightField::light_passes).max(standing);
        LIGHT_PASSES.into_iter().find(|&passes| passes > made).filter(|&passes| passes <= most)
    }

    /// Notes changes of the focus map.
    pub fn note(&mut self, changes: &Changes) {
        self.since.join(changes);
        if let Some(last) = &mut self.last {
            last.note(changes);
        }
    }

    /// Begins, unless something was wished meanwhile.
    pub fn start(&mut self, shared: &Arc<Shared>, task: Task) {
        if self.is_at_work() || !shared.begin_light(task.passes) {
            return;
        }
        self.since = Changes::default();
        let last = self.last.take().filter(|last| last.serves(&task.camera));
        let (theirs, epoch) = (shared.clone(), task.epoch);
        let work = move || {
            let made =
                guarded("refining the light", || among_others(Urgency::Later, || make(task, last, &theirs)));
            theirs.refined_light(RefinedLight { made, epoch });
        };
        match std::thread::Builder::new().name("refined light".into()).stack_size(16 << 20).spawn(work) {
            Ok(thread) => self.thread = Some(thread),
            Err(error) => {
                let made = Err(SessionError::TryAgain(format!("no thread: {error} (try again)")));
                shared.refined_light(RefinedLight { made, epoch });
            }
        }
    }

    /// Takes back what was made.
    pub fn take_back(&mut self, made: RefinedLight) {
        self.join();
        self.made = Some(made);
    }

    /// What was made, with all that changed meanwhile noted, if it is better than what stands, which was refined by so many passes; else it
    /// is kept, to be compared with. `None` if there is nothing to take up.
    pub fn take_up(&mut self, epoch: u64, standing: u32) -> Result<Option<Finer>, SessionError> {
        let Some(RefinedLight { made, epoch: of_epoch }) = self.made.take() else { return Ok(None) };
        let mut finer = match made {
            Ok(finer) if of_epoch == epoch => finer,
            Ok(_) | Err(SessionError::Cancelled) => return Ok(None),
            Err(error) => return Err(error),
        };
        finer.field.note(&std::mem::take(&mut self.since));
        let is_better = match finer.errors {
            Some(errors) => errors.refined < errors.standing,
            None => false,
        };
        if is_better || standing > 0 {
            return Ok(Some(finer));
        }
        self.last = Some(finer.field);
        Ok(None)
    }

    /// Gives up what was made: its scene or camera is gone.
    pub fn forget(&mut self) {
        self.last = None;
    }

    /// Waits for the thread, which was told to stop or is done.
    pub fn join(&mut self) {
        if let Some(thread) = self.thread.take() {
            // Its result is delivered; its panics were caught.
            let _ = thread.join();
        }
    }
}

fn make(task: Task, last: Option<LightField>, shared: &Shared) -> Result<Finer, SessionError> {
    let Task { stage, camera, focus, tolerance, standing, exposure, margin_px, passes, .. } = task;
    let light = LightQuality::Refined { passes };
    let how = FieldOptions { least_margin_px: margin_px, tolerance, gpu: shared.gpu(), light };
    let start = Instant::now();
    let mut field =
        LightField::bake(&stage, &camera, &focus, how, &Share::new(&shared.light, 0.0, BAKE_SHARE))?;
    let seconds = start.elapsed().as_secs_f64();
    let summing = Share::new(&shared.light, BAKE_SHARE, 1.0);
    field.bring_up(&camera, &focus, &summing)?;
    field.survey(&camera, &focus);
    let mut errors = None;
    if let Some(mut last) = last {
        last.set_tolerance(tolerance);
        last.bring_up(&camera, &focus, &summing)?;
        let refined = field.brought()?;
        let apart = square_between(last.brought()?, refined, exposure);
        errors = Some(LightErrors::told(apart, square_between(&standing, refined, exposure)));
    }
    field.prepare()(&shared.light);
    Ok(Finer { field, errors, seconds })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_are_four_times_as_many_until_there_are_enough() {
        let refinement = LightRefinement::default();
        let camera = Camera::default();
        let next = |standing| refinement.next_passes(&camera, standing, 256);
        assert_eq!([next(0), next(4), next(64), next(256)], [Some(4), Some(16), Some(256), None]);
        assert_eq!(refinement.next_passes(&camera, 0, 0), None, "it is never refined");
    }
}
