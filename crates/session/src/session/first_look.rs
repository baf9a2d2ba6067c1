//! What is seen of a scene that takes a while to prepare, before it can be painted on: a small picture without blur.

use super::outcome::JobOutcome;
use super::showing::scale_to_fit;
use super::state::Session;
use crate::display::{Content, Patch, to_screen};
use crate::error::SessionError;
use crate::jobs::{JobId, JobProgress, JobSteps, Steps, Waker};
use crate::light_field::quick_light;
use baselines::FirstHits;
use focus::Focus;
use lens::{Camera, FocusOffset, Picture};
use progress::Progress;
use std::sync::Arc;
use std::sync::mpsc::Sender;
use trace::Tracer;

/// Its longest side, px: half a second's work.
const SIDE_PX: u32 = 400;

/// The way from a scene that is being opened to the session.
pub(super) struct OpeningPreview {
    sender: Sender<(Option<JobId>, Result<JobOutcome, SessionError>)>,
    waker: Waker,
}

/// The steps of opening.
pub(super) struct OpeningSteps<'a> {
    steps: JobSteps<'a>,
    preview: &'a OpeningPreview,
}

impl OpeningPreview {
    pub fn steps<'a>(&'a self, progress: &'a JobProgress) -> OpeningSteps<'a> {
        OpeningSteps { steps: JobSteps { progress }, preview: self }
    }
}

impl Steps for OpeningSteps<'_> {
    fn begin(&self, label: &str) -> Box<dyn Progress + '_> {
        self.steps.begin(label)
    }

    fn scene_ready(&self, tracer: &Arc<Tracer>, camera: &Camera) {
        let camera = scale_to_fit(camera, SIDE_PX);
        let focus = Focus::constant(tracer.scene().clone(), FocusOffset::STANDARD);
        let progress = self.begin("first look");
        let light = quick_light(tracer, &camera, &*progress);
        if let Ok(hits) = FirstHits::trace(tracer, &*light, &focus, &camera, &*progress) {
            self.picture_ready(&hits.picture());
        }
    }

    fn picture_ready(&self, picture: &Picture) {
        // A session that is gone wants nothing.
        let _ = self.preview.sender.send((None, Ok(JobOutcome::OpeningPicture(picture.clone()))));
        (self.preview.waker)();
    }
}

impl Session {
    pub(super) fn opening_preview(&self) -> OpeningPreview {
        OpeningPreview { sender: self.outcome_sender.clone(), waker: self.options.waker.clone() }
    }

    /// Shows what is seen of a scene that is being opened, unless another one is open.
    pub(super) fn show_opening_picture(&mut self, picture: &Picture) {
        if self.document.is_none() {
            let size = [picture.width, picture.height];
            let content = Content::Pixels(to_screen(picture, self.tone()));
            self.screen.apply_patch(Patch { size, rectangle: size.map(|side| 0..side), content });
        }
    }
}
