//! What is seen of a scene that takes a while to prepare, before it can be painted on: a small picture without blur.

use super::outcome::Outcome;
use super::showing::scaled_within;
use super::state::Session;
use crate::display::{Content, Patch, to_screen};
use crate::error::SessionError;
use crate::jobs::{JobId, JobProgress, JobSteps, Steps, Waker};
use crate::light_field::first_light;
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
pub(super) struct FirstLook {
    sender: Sender<(Option<JobId>, Result<Outcome, SessionError>)>,
    waker: Waker,
}

/// The steps of opening.
pub(super) struct OpeningSteps<'a> {
    steps: JobSteps<'a>,
    look: &'a FirstLook,
}

impl FirstLook {
    pub fn steps<'a>(&'a self, progress: &'a JobProgress) -> OpeningSteps<'a> {
        OpeningSteps { steps: JobSteps { progress }, look: self }
    }
}

impl Steps for OpeningSteps<'_> {
    fn begin(&self, label: &str) -> Box<dyn Progress + '_> {
        self.steps.begin(label)
    }

    fn seen(&self, tracer: &Arc<Tracer>, camera: &Camera) {
        let camera = scaled_within(camera, SIDE_PX);
        let focus = Focus::constant(tracer.scene().clone(), FocusOffset::STANDARD);
        let progress = self.begin("first look");
        let light = first_light(tracer, &camera, &*progress);
        if let Ok(hits) = FirstHits::trace(tracer, &*light, &focus, &camera, &*progress) {
            self.shown(&hits.picture());
        }
    }

    fn shown(&self, picture: &Picture) {
        // A session that is gone wants nothing.
        let _ = self.look.sender.send((None, Ok(Outcome::Seen(picture.clone()))));
        (self.look.waker)();
    }
}

impl Session {
    pub(super) fn first_look(&self) -> FirstLook {
        FirstLook { sender: self.sender.clone(), waker: self.options.waker.clone() }
    }

    /// Shows what is seen of a scene that is being opened, unless another one is open.
    pub(super) fn take_seen(&mut self, picture: &Picture) {
        if self.document.is_none() {
            let size = [picture.width, picture.height];
            let content = Content::Pixels(to_screen(picture, self.tone()));
            self.screen.take(Patch { size, rectangle: size.map(|side| 0..side), content });
        }
    }
}
