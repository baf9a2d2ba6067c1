//! A scene that another program writes again while it is open: where a bridge's manifest lies beside it, the session looks whether the
//! file is another now, reads it in the background, and has the paint follow.
//!
//! Scenes without a manifest are read once, and nobody looks.

use super::outcome::Outcome;
use super::state::Session;
use super::watched::Watched;
use crate::commands::Event;
use crate::document::Document;
use crate::error::file_name;
use crate::jobs::JobSteps;
use std::time::{Duration, Instant};

/// How often the file is looked at. A file that changed is read when it has stayed the same for as long.
const LOOKED_EVERY: Duration = Duration::from_secs(1);

/// A revision that no recovery file holds.
const UNKEPT: u64 = 0;

impl Session {
    /// Begins to watch the scene of the document that was opened.
    pub(super) fn begin_watching(&mut self) {
        self.watched = self.document.as_ref().and_then(|document| Watched::of(&document.scene().path));
        if self.watched.is_some() {
            self.wake_in(LOOKED_EVERY);
        }
    }

    /// Looks at the scene's file when it is time to. Called at every poll.
    pub(super) fn watch_scene(&mut self) {
        let is_busy = self.is_painting() || !self.jobs.is_empty();
        let Some(watched) = self.watched.as_mut().filter(|watched| watched.looked.elapsed() >= LOOKED_EVERY)
        else {
            return;
        };
        let is_another = !is_busy && watched.is_another();
        if is_busy {
            watched.looked = Instant::now();
        }
        self.wake_in(LOOKED_EVERY);
        if is_another {
            self.follow();
        }
    }

    /// Reads the scene again, and has the paint follow it.
    fn follow(&mut self) {
        let Some(document) = &self.document else { return };
        let (project, path, revision) = (document.to_project(), document.path.clone(), document.revision);
        let (unwrap, generation) = (self.options.unwrap.clone(), self.generation);
        let cameras = document.scene().cameras.clone();
        let label = format!("following {}", file_name(&project.scene));
        let started = self.start(label, move |progress| {
            let document = Document::follow(project, &cameras, path, &unwrap, &JobSteps { progress })?;
            Ok(Outcome::Followed { document: Box::new(document), generation, revision })
        });
        if let Err(error) = started {
            self.events.push(Event::Failed(error.to_string()));
        }
    }

    /// Takes up a document that followed its scene; one that was painted on meanwhile follows again.
    pub(super) fn take_followed(&mut self, document: Document, [generation, revision]: [u64; 2]) {
        if generation != self.generation {
            return;
        }
        if self.document.as_ref().is_some_and(|open| open.revision != revision) || self.is_painting() {
            self.follow();
            return;
        }
        // The file is as it was seen when it was read, whatever happened since.
        let watched = self.watched.take();
        self.take_opened(document);
        (self.watched, self.recovery.kept) = (watched, UNKEPT);
    }
}
