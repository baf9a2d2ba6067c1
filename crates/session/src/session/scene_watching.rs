//! A scene that another program writes again while it is open: where a bridge's manifest lies beside it, the session looks whether the
//! file is another now, reads it in the background, and has the paint follow.
//!
//! Scenes without a manifest are read once, and nobody looks.

use crate::commands::Event;
use crate::job_steps::JobSteps;
use crate::session::job_outcome::JobOutcome;
use crate::session::state::Session;
use crate::session::watched_file::WatchedFile;
use document::{Document, file_name};
use std::time::{Duration, Instant};

/// How often the file is looked at. A file that changed is read when it has stayed the same for as long.
const CHECK_INTERVAL: Duration = Duration::from_secs(1);

/// A revision that no recovery file holds.
const UNSAVED_REVISION: u64 = 0;

impl Session {
    /// Begins to watch the scene of the document that was opened.
    pub(super) fn begin_watching(&mut self) {
        self.watched_file = self
            .document
            .as_ref()
            .and_then(|document| WatchedFile::for_bridged_scene(&document.scene().path));
        if self.watched_file.is_some() {
            self.wake_after(CHECK_INTERVAL);
        }
    }

    /// Looks at the scene's file when it is time to. Called at every poll.
    pub(super) fn check_watched_scene(&mut self) {
        let is_busy = self.is_painting() || !self.jobs.is_empty();
        let Some(watched) =
            self.watched_file.as_mut().filter(|watched| watched.last_check.elapsed() >= CHECK_INTERVAL)
        else {
            return;
        };
        let has_changed = !is_busy && watched.has_changed();
        if is_busy {
            watched.last_check = Instant::now();
        }
        self.wake_after(CHECK_INTERVAL);
        if has_changed {
            self.reload_scene();
        }
    }

    /// Reads the scene again, and has the paint follow it.
    fn reload_scene(&mut self) {
        let Some(document) = &self.document else { return };
        let (project, path, revision) = (document.to_project(), document.path.clone(), document.revision);
        let (unwrap, resources) = (self.options.unwrap.clone(), self.options.resources.clone());
        let generation = self.generation;
        let cameras = document.scene().cameras.clone();
        let label = format!("following {}", file_name(&project.scene));
        let started = self.start_job(label, move |progress| {
            let document =
                Document::reload(project, &cameras, path, (&unwrap, &resources), &JobSteps { progress })?;
            Ok(JobOutcome::SceneReloaded { document: Box::new(document), generation, revision })
        });
        if let Err(error) = started {
            self.events.push(Event::Failed(error.to_string()));
        }
    }

    /// Takes up a document that followed its scene; one that was painted on meanwhile follows again.
    pub(super) fn show_reloaded(&mut self, document: Document, [generation, revision]: [u64; 2]) {
        if generation != self.generation {
            return;
        }
        if self.document.as_ref().is_some_and(|open| open.revision != revision) || self.is_painting() {
            self.reload_scene();
            return;
        }
        // The file is as it was seen when it was read, whatever happened since.
        let watched = self.watched_file.take();
        self.show_opened(document);
        (self.watched_file, self.recovery.saved_revision) = (watched, UNSAVED_REVISION);
    }
}
