//! Pictures to compare with, made in the background.

use crate::commands::Event;
use crate::error::SessionError;
use crate::job_steps::JobSteps;
use crate::preview::PreviewActivity;
use crate::reference::{Reference, ReferenceKind};
use crate::session::job_outcome::JobOutcome;
use crate::session::state::Session;
use baselines::FirstHits;
use document::{Document, depth_in_direction};
use focus::Focus;
use lens::{Camera, FocusOffset};
use light::{LightQuality, Steps};
use render::{RenderOptions, Renderer, Stereo, light_of_photographs, photograph_picture, render};
use std::sync::Arc;
use std::time::Instant;
use trace::truth::TruthOptions;

/// How far the eyes are apart, as a share of the aperture's diameter.
const EYE_SEPARATION: f64 = 0.5;

impl Session {
    /// The picture of a kind that was made last of this document.
    pub fn reference(&self, kind: ReferenceKind) -> Option<&Reference> {
        self.references.iter().find(|reference| reference.kind == kind)
    }

    /// Whether the picture of a kind shows the document as it is.
    pub fn is_reference_current(&self, kind: ReferenceKind) -> bool {
        let (Some(document), Some(reference)) = (&self.document, self.reference(kind)) else { return false };
        let is_being_painted =
            matches!(kind, ReferenceKind::Truth | ReferenceKind::Stereo(_)) && self.is_painting();
        !is_being_painted && reference.shows(&self.reference_camera(kind, document), document.revision)
    }

    /// The camera of a picture; where two eyes look at something, that is in focus: it has no disparity.
    fn reference_camera(&self, kind: ReferenceKind, document: &Document) -> Camera {
        let camera = self.scaled_camera(&document.camera);
        let fixation_point = self.fixation_point.filter(|_| matches!(kind, ReferenceKind::Stereo(_)));
        match fixation_point.and_then(|point| depth_in_direction(document.stage.tracer(), &camera, point)) {
            Some(focus_distance) => Camera { focus_distance, ..camera },
            None => camera,
        }
    }

    /// Whether something is fixated in pictures for two eyes, other than what the lens is focused on.
    pub fn is_fixating(&self) -> bool {
        self.fixation_point.is_some()
    }

    /// Whether the reference picture of this kind is being made.
    pub fn is_making_reference(&self, kind: ReferenceKind) -> bool {
        self.reference_jobs.iter().any(|(_, job_kind)| *job_kind == kind)
    }

    /// Whether there is time for a picture to compare with: nothing else is going on.
    pub fn is_idle(&self) -> bool {
        let is_drawing =
            self.preview_activity() != PreviewActivity::Idle || self.exact_picture_progress().is_some();
        self.jobs.is_empty() && !self.is_painting() && !is_drawing
    }

    /// Starts making a picture; an older wish for the same kind is given up.
    pub(super) fn make_reference(
        &mut self,
        kind: ReferenceKind,
        samples_per_pixel: u32,
    ) -> Result<(), SessionError> {
        let document = self.document_mut()?;
        let (stage, revision) = (document.stage.clone(), document.revision);
        let focus = match kind {
            ReferenceKind::Truth | ReferenceKind::Stereo(_) => {
                let map = Arc::new(document.map.clone());
                Focus::from_atlas_map(stage.scene.clone(), stage.atlas.clone(), map)
            }
            _ => Focus::constant(stage.scene.clone(), FocusOffset::STANDARD),
        };
        let exposure = document.exposure;
        let document = self.document.as_ref().ok_or(SessionError::NothingOpen)?;
        let (camera, generation) = (self.reference_camera(kind, document), self.generation);
        for (id, _) in self.reference_jobs.iter().filter(|(_, job_kind)| *job_kind == kind) {
            self.jobs.iter().filter(|job| job.id == *id).for_each(|job| job.progress.cancel());
        }
        let label = match kind {
            ReferenceKind::Pinhole => "drawing the pinhole picture",
            ReferenceKind::Standard => "drawing the ordinary lens",
            ReferenceKind::Truth => "tracing the ground truth",
            ReferenceKind::Photograph => "reading the photograph",
            ReferenceKind::Stereo(_) => "drawing for two eyes",
        };
        let photograph = self.document.as_ref().and_then(|document| document.photograph().cloned());
        let available_fields = self.available_fields(stage.clone());
        let id = self.start_job(label.into(), move |progress| {
            let start = Instant::now();
            let steps = JobSteps { progress };
            let picture = match kind {
                ReferenceKind::Pinhole => {
                    let radiance = stage.lit.solve(&camera, LightQuality::Fine, &*steps.begin("light"))?;
                    let progress = steps.begin("first hits");
                    FirstHits::trace(stage.tracer(), &*radiance, &focus, &camera, &*progress)?.picture()
                }
                ReferenceKind::Standard => {
                    available_fields.render(&camera, &focus, &RenderOptions::default(), &steps)?.picture
                }
                ReferenceKind::Truth => {
                    let truth = TruthOptions { samples_per_pixel, ..TruthOptions::default() };
                    let options =
                        RenderOptions { renderer: Renderer::Truth, truth, ..RenderOptions::default() };
                    render(&stage.lit, &camera, &focus, &options, &steps)?.picture
                }
                ReferenceKind::Stereo(form) => {
                    // The camera is focused on what they fixate.
                    let stereo = Stereo { form, eyes: EYE_SEPARATION, fixate: None, exposure };
                    let options = RenderOptions::default();
                    stereo
                        .render_pair(&camera, |eye| available_fields.render(eye, &focus, &options, &steps))?
                        .picture
                }
                ReferenceKind::Photograph => {
                    let what = "the camera is not that of a photograph (choose a photograph as the camera)";
                    let view = photograph.ok_or_else(|| SessionError::bad_file(&stage.scene.path, what))?;
                    let light = light_of_photographs(&stage.lit, &steps)?;
                    photograph_picture(&view, &camera, stage.tracer(), light.as_deref())?.0
                }
            };
            let samples_per_pixel = if kind == ReferenceKind::Truth { samples_per_pixel } else { 0 };
            let (picture, seconds) = (Arc::new(picture), start.elapsed().as_secs_f64());
            Ok(JobOutcome::Reference(Box::new(Reference {
                kind,
                picture,
                camera,
                samples_per_pixel,
                seconds,
                revision,
                generation,
            })))
        })?;
        self.reference_jobs.push((id, kind));
        Ok(())
    }

    /// Takes up a picture that was made.
    pub(super) fn take_reference(&mut self, reference: Reference) {
        if reference.generation == self.generation {
            let kind = reference.kind;
            self.references.retain(|old| old.kind != kind);
            self.references.push(reference);
            self.events.push(Event::ReferenceReady(kind));
        }
    }
}
