//! The exact picture, drawn once nothing has changed for a while.
//!
//! While one paints, the picture is summed within a tolerance. A second sum of the same light field, without one, is made
//! on a thread of its own as soon as there is time; any change stops it. It is kept, so that after the next strokes only
//! what they moved is summed again.

use super::deliveries::{Exact, Refined};
use super::mailbox::Shared;
use crate::error::SessionError;
use crate::jobs::{Urgency, among_others, guarded};
use crate::light_field::{Changes, LightField};
use focus::Focus;
use lens::{Camera, Exposure, Picture};
use progress::Stage as Share;
use rayon::prelude::*;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Instant;

/// The second sum is kept while it takes no more bytes than these: a picture of 1920 × 1080 takes two fifths of it.
const KEPT_BYTES: usize = 1 << 29;

/// The exact sum, at rest or at work.
#[derive(Default)]
pub(crate) struct Refinement {
    /// Between two pictures.
    field: Option<LightField>,
    thread: Option<JoinHandle<()>>,
    /// What changed while the thread has it.
    since: Changes,
}

/// What is drawn exactly.
pub(crate) struct Task {
    pub camera: Camera,
    pub focus: Focus,
    /// The picture that was worked with, to be compared.
    pub viewing: Arc<Picture>,
    /// How the two are compared.
    pub exposure: Exposure,
    /// Changes that the map holds.
    pub map_serial: u64,
}

impl Refinement {
    /// Whether a picture is being drawn.
    pub fn is_at_work(&self) -> bool {
        self.thread.is_some()
    }

    /// Notes changes of the focus map.
    pub fn note(&mut self, changes: &Changes) {
        match &mut self.field {
            Some(field) => field.note(changes),
            None => self.since.join(changes),
        }
    }

    /// Draws the exact picture of `viewed`'s light field in the background.
    pub fn start(&mut self, shared: &Arc<Shared>, viewed: &LightField, task: Task) {
        if self.is_at_work() || !shared.begin_refining() {
            return;
        }
        let kept = self.field.take().filter(|field| field.is_twin_of(viewed));
        let mut field = kept.unwrap_or_else(|| viewed.exact());
        self.since = Changes::default();
        let theirs = shared.clone();
        let work = move || {
            let drawn = guarded("drawing the exact picture", || {
                among_others(Urgency::Later, || {
                    let outcome = draw(&mut field, task, &theirs);
                    Ok((field, outcome))
                })
            });
            theirs.refined(match drawn {
                Ok((field, outcome)) => Refined { field: Some(field), outcome },
                Err(error) => Refined { field: None, outcome: Err(error) },
            });
        };
        match std::thread::Builder::new().name("exact picture".into()).stack_size(16 << 20).spawn(work) {
            Ok(thread) => self.thread = Some(thread),
            Err(error) => {
                let error = SessionError::TryAgain(format!("no thread: {error} (try again)"));
                shared.refined(Refined { field: None, outcome: Err(error) });
            }
        }
    }

    /// Takes the sum back from the thread.
    pub fn take_up(&mut self, refined: Refined) -> Result<(Exact, Option<&LightField>), SessionError> {
        self.join();
        self.field = refined.field;
        let since = std::mem::take(&mut self.since);
        if let Some(field) = &mut self.field {
            field.note(&since);
        }
        Ok((refined.outcome?, self.field.as_ref()))
    }

    /// Gives up a sum that is of another light field than the one `viewed`, or takes too much memory.
    pub fn tidy(&mut self, viewed: Option<&LightField>) {
        self.field.take_if(|field| {
            let is_another = viewed.is_some_and(|viewed| !field.is_twin_of(viewed));
            is_another || field.summing_bytes() > KEPT_BYTES
        });
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

fn draw(field: &mut LightField, task: Task, shared: &Shared) -> Result<Exact, SessionError> {
    let Task { camera, focus, viewing, exposure, map_serial } = task;
    field.prepare()(&shared.refining);
    let start = Instant::now();
    field.bring_up(&camera, &focus, &Share::new(&shared.refining, 0.0, 1.0))?;
    let seconds = start.elapsed().as_secs_f64();
    let viewing_psnr = psnr_between(&viewing, field.brought()?, exposure);
    Ok(Exact { map_serial, camera, seconds, viewing_psnr })
}

/// How far `picture` is from `exact`, of the same size: PSNR in dB of linear values clipped to [0, 1].
fn psnr_between(picture: &Picture, exact: &Picture, exposure: Exposure) -> f64 {
    project::psnr(square_between(picture, exact, exposure))
}

/// The mean square of how far two pictures of one size are apart, of linear values clipped to [0, 1].
pub(super) fn square_between(picture: &Picture, exact: &Picture, exposure: Exposure) -> f64 {
    let [a, b] = [picture, exact].map(|picture| picture.exposed(exposure));
    let square = |(a, b): (&[f32; 3], &[f32; 3])| -> f64 {
        let of = |k: usize| f64::from(a[k].clamp(0.0, 1.0)) - f64::from(b[k].clamp(0.0, 1.0));
        (0..3).map(|k| of(k) * of(k)).sum()
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
