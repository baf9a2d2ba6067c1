//! The exact picture, drawn once nothing has changed for a while.
//!
//! While one paints, the picture is summed within a tolerance. A second sum of the same light field, without one, is made
//! on a thread of its own as soon as there is time; any change stops it. It is kept, so that after the next strokes only
//! what they moved is summed again.

use crate::error::SessionError;
use crate::light_field::{Changes, LightField};
use crate::preview::deliveries::{ExactDelivery, ExactPicture};
use crate::preview::helper_thread;
use crate::preview::mailbox::Shared;
use focus::Focus;
use jobs::{Urgency, catch_panics, run_in_own_pool};
use lens::{Camera, Exposure, Picture};
use progress::Stage as Share;
use rayon::prelude::*;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Instant;

/// The second sum is kept while it takes no more bytes than these: a picture of 1920 × 1080 takes two fifths of it.
const MAX_RETAINED_BYTES: usize = 1 << 29;

/// The exact sum, at rest or at work.
#[derive(Default)]
pub(crate) struct ExactRefinement {
    /// Between two pictures.
    field: Option<LightField>,
    thread: Option<JoinHandle<()>>,
    /// What changed while the thread has it.
    pending_changes: Changes,
}

/// What is drawn exactly.
pub(crate) struct ExactTask {
    pub camera: Camera,
    pub focus: Focus,
    /// The picture that was worked with, to be compared.
    pub viewing: Arc<Picture>,
    /// How the two are compared.
    pub exposure: Exposure,
    /// Changes that the map holds.
    pub map_serial: u64,
}

impl ExactRefinement {
    /// Whether a picture is being drawn.
    pub fn is_at_work(&self) -> bool {
        self.thread.is_some()
    }

    /// Notes changes of the focus map that were made meanwhile.
    pub fn note(&mut self, changes: &Changes) {
        match &mut self.field {
            Some(field) => field.note(changes),
            None => self.pending_changes.join(changes),
        }
    }

    /// Draws the exact picture of `viewed`'s light field in the background.
    pub fn start(&mut self, shared: &Arc<Shared>, viewed: &LightField, task: ExactTask) {
        if self.is_at_work() || !shared.begin_refining() {
            return;
        }
        let retained = self.field.take().filter(|field| field.is_twin_of(viewed));
        let mut field = retained.unwrap_or_else(|| viewed.exact());
        self.pending_changes = Changes::default();
        let thread_shared = shared.clone();
        let work = move || {
            let drawn = catch_panics("drawing the exact picture", || {
                run_in_own_pool(Urgency::Background, || {
                    let outcome = draw(&mut field, task, &thread_shared);
                    Ok((field, outcome))
                })
            });
            thread_shared.deliver_exact(match drawn {
                Ok((field, outcome)) => ExactDelivery { field: Some(field), outcome },
                Err(error) => ExactDelivery { field: None, outcome: Err(error) },
            });
        };
        match helper_thread::spawn("exact picture", work) {
            Ok(thread) => self.thread = Some(thread),
            Err(error) => {
                shared.deliver_exact(ExactDelivery { field: None, outcome: Err(error) });
            }
        }
    }

    /// Takes the sum back from the thread, with the picture that it made.
    ///
    /// # Errors
    /// The error of the thread.
    pub fn take_up(
        &mut self,
        refined: ExactDelivery,
    ) -> Result<(ExactPicture, Option<&LightField>), SessionError> {
        self.join();
        self.field = refined.field;
        let pending_changes = std::mem::take(&mut self.pending_changes);
        if let Some(field) = &mut self.field {
            field.note(&pending_changes);
        }
        Ok((refined.outcome?, self.field.as_ref()))
    }

    /// Gives up a sum that is of another light field than the one `viewed`, or takes too much memory.
    pub fn tidy(&mut self, viewed: Option<&LightField>) {
        self.field.take_if(|field| {
            let is_another = viewed.is_some_and(|viewed| !field.is_twin_of(viewed));
            is_another || field.summing_bytes() > MAX_RETAINED_BYTES
        });
    }

    /// The memory of the sum between two pictures, bytes; all else is shared with the light field worked with.
    pub fn bytes(&self) -> usize {
        self.field.as_ref().map_or(0, LightField::summing_bytes)
    }

    /// Gives up the sum: its light field is gone.
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

fn draw(field: &mut LightField, task: ExactTask, shared: &Shared) -> Result<ExactPicture, SessionError> {
    let ExactTask { camera, focus, viewing, exposure, map_serial } = task;
    field.prepare()(&shared.refining);
    let start = Instant::now();
    field.update_sum(&camera, &focus, &Share::new(&shared.refining, 0.0, 1.0))?;
    field.release_room();
    let seconds = start.elapsed().as_secs_f64();
    let viewing_psnr = psnr_between(&viewing, field.fetch_picture()?, exposure);
    Ok(ExactPicture { map_serial, camera, seconds, viewing_psnr })
}

/// How far `picture` is from `exact`, of the same size: PSNR in dB of linear values clipped to [0, 1].
fn psnr_between(picture: &Picture, exact: &Picture, exposure: Exposure) -> f64 {
    numerics::psnr(mean_square_difference(picture, exact, exposure))
}

/// The mean square of how far two pictures of one size are apart, of linear values clipped to [0, 1].
pub(super) fn mean_square_difference(picture: &Picture, exact: &Picture, exposure: Exposure) -> f64 {
    let [a, b] = [picture, exact].map(|picture| picture.exposed(exposure));
    let square = |(a, b): (&[f32; 3], &[f32; 3])| -> f64 {
        let difference = |k: usize| f64::from(a[k].clamp(0.0, 1.0)) - f64::from(b[k].clamp(0.0, 1.0));
        (0..3).map(|k| difference(k) * difference(k)).sum()
    };
    let sum: f64 = a.par_iter().zip(&b).map(square).sum();
    sum / (3 * a.len()).max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_distance_is_that_of_exposed_values() {
        let exact = Picture { radiance: vec![[0.5; 3]; 4], coverage: vec![1.0; 4], ..Picture::black(2, 2) };
        let mut near = exact.clone();
        near.radiance[1] = [0.5, 0.7, 0.5];
        let expected = -10.0 * (0.2f64 * 0.2 / 12.0).log10();
        assert!((psnr_between(&near, &exact, Exposure::Conserve) - expected).abs() < 1e-5);
        assert_eq!(psnr_between(&exact, &exact, Exposure::Conserve), 200.0);
        let dimmer = Picture { radiance: vec![[0.25; 3]; 4], coverage: vec![0.5; 4], ..exact.clone() };
        assert_eq!(psnr_between(&dimmer, &exact, Exposure::Normalise), 200.0);
        assert!(psnr_between(&dimmer, &exact, Exposure::Conserve) < 13.0);
    }
}
