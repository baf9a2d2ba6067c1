//! What is seen of a scene that takes a while to prepare, before it can be painted on: a small picture, blurred where nothing is painted yet.

use crate::display::{Content, Defocused, Patch};
use crate::error::SessionError;
use crate::job_steps::JobSteps;
use crate::session::job_outcome::JobOutcome;
use crate::session::preview_updates::scale_to_fit;
use crate::session::state::Session;
use baselines::FirstHits;
use focus::Focus;
use jobs::{JobId, JobProgress, Waker};
use lens::{Camera, FocusOffset, Picture};
use light::{LitScene, Steps};
use progress::Progress;
use render::to_screen;
use std::sync::Arc;
use std::sync::mpsc::Sender;

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
    /// The steps of opening, which report to `progress` and update this preview.
    pub fn steps<'a>(&'a self, progress: &'a JobProgress) -> OpeningSteps<'a> {
        OpeningSteps { steps: JobSteps { progress }, preview: self }
    }
}

impl Steps for OpeningSteps<'_> {
    fn begin(&self, label: &str) -> Box<dyn Progress + '_> {
        self.steps.begin(label)
    }

    fn scene_ready(&self, lit: &Arc<LitScene>, camera: &Camera, is_painted: bool) {
        let camera = scale_to_fit(camera, SIDE_PX);
        let focus = Focus::constant(lit.scene().clone(), FocusOffset::STANDARD);
        let progress = self.begin("first look");
        let light = lit.quick(&camera, &*progress);
        if let Ok(hits) = FirstHits::trace(lit.tracer(), &*light, &focus, &camera, &*progress) {
            let picture = if is_painted { hits.picture() } else { Defocused::new(&hits, &camera).picture };
            self.picture_ready(&picture);
        }
        // The scene is unwrapped meanwhile.
        lit.start_rough(&camera);
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
