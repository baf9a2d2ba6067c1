//! Checking a rectangle of the picture against the ground truth, pass by pass.

use crate::commands::Event;
use crate::error::SessionError;
use crate::session::job_outcome::JobOutcome;
use crate::session::state::Session;
use crate::verification::Verification;
use focus::Focus;
use glam::DVec2;
use progress::Stage as Share;
use std::sync::Arc;
use trace::truth::{Estimate, Region, Truth, TruthOptions};

/// Rays a pixel of a verification.
const SAMPLES_PER_PIXEL: u32 = 1024;

impl Session {
    /// The rectangle that is being verified, or was last; `None` if there is none.
    pub fn verification(&self) -> Option<&Verification> {
        self.verification.as_ref()
    }

    /// Whether what is verified is the document as it is.
    pub fn is_verification_current(&self) -> bool {
        let (Some(document), Some(verification)) = (&self.document, &self.verification) else { return false };
        !self.is_painting()
            && verification.revision == document.revision
            && verification.camera == self.scaled_camera(&document.camera)
    }

    /// Starts tracing the rectangle between two positions of the picture; an older one is given up.
    pub(super) fn verify(&mut self, corners: [DVec2; 2]) -> Result<(), SessionError> {
        self.end_verification();
        let document = self.document_mut()?;
        let (stage, revision) = (document.stage.clone(), document.revision);
        let map = Arc::new(document.map.clone());
        let focus = Focus::from_atlas_map(stage.scene.clone(), stage.atlas.clone(), map);
        let shot_camera = document.camera.clone();
        let camera = self.scaled_camera(&shot_camera);
        let size = DVec2::new(camera.width as f64, camera.height as f64);
        let [a, b] = corners.map(|corner| corner.clamp(DVec2::ZERO, DVec2::ONE) * size);
        let (low, high) = (a.min(b).floor(), a.max(b).ceil());
        let [x, y, width, height] = [low.x, low.y, high.x - low.x, high.y - low.y].map(|side| side as u32);
        let region = Region { x, y, width, height }.within(&camera);
        if region.pixels() == 0 {
            return Ok(());
        }
        if stage.scene.splats.is_some() {
            let what = "Gaussian splats cannot be verified ray by ray here (use `focus-brush render --renderer truth`)";
            return Err(SessionError::bad_file(&stage.scene.path, what));
        }
        self.verifications += 1;
        let verification_number = self.verifications;
        let target_samples = SAMPLES_PER_PIXEL;
        let verification = Verification {
            region,
            camera: camera.clone(),
            estimate: None,
            target_samples,
            revision,
            number: verification_number,
        };
        self.verification = Some(verification);
        let (sender, waker) = (self.outcome_sender.clone(), self.options.waker.clone());
        let id = self.start_job("verifying".into(), move |progress| {
            let light = stage.lit.ground_truth(&camera, progress)?;
            let options = TruthOptions {
                samples_per_pixel: SAMPLES_PER_PIXEL,
                region: Some(region),
                ..TruthOptions::default()
            };
            let mut truth = Truth::new(stage.tracer(), &*light, &focus, &camera, &options);
            let share = |samples: u32| samples as f32 / SAMPLES_PER_PIXEL as f32;
            while !truth.is_done() {
                let done = truth.samples_per_pixel();
                let after = share(done + options.samples_of_pass());
                truth.pass(&Share::new(progress, share(done), after.min(1.0)))?;
                // A session that is gone wants nothing.
                let update = JobOutcome::VerificationPass(verification_number, Box::new(truth.estimate()));
                let _ = sender.send((None, Ok(update)));
                waker();
            }
            Ok(JobOutcome::VerificationPass(verification_number, Box::new(truth.estimate())))
        })?;
        self.verification_job = Some(id);
        Ok(())
    }

    /// Stops verifying and forgets what was found.
    pub(super) fn end_verification(&mut self) {
        self.verification = None;
        if let Some(id) = self.verification_job.take() {
            self.jobs.iter().filter(|job| job.id == id).for_each(|job| job.progress.cancel());
        }
    }

    /// Takes up what is known after another pass.
    pub(super) fn show_verification_pass(&mut self, number: u64, estimate: Estimate) {
        if let Some(verification) = self.verification.as_mut().filter(|v| v.number == number) {
            verification.estimate = Some(Arc::new(estimate));
            self.events.push(Event::VerificationUpdated);
        }
    }
}
