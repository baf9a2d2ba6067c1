//! What background work brings, taken up once a frame.

use super::outcome::Outcome;
use super::recovery::Recovery;
use super::state::Session;
use crate::commands::Event;
use crate::document::Document;
use crate::error::SessionError;
use progress::Progress;

impl Session {
    /// What happened since the last call. To be called once a frame.
    pub fn poll(&mut self) -> Vec<Event> {
        while let Ok((id, outcome)) = self.outcomes.try_recv() {
            let is_given_up = self.jobs.iter().any(|job| Some(job.id) == id && job.progress.cancelled());
            self.jobs.retain(|job| Some(job.id) != id);
            self.reference_jobs.retain(|(job, _)| Some(*job) != id);
            match outcome {
                // It was done before it could be stopped; a newer one has its place.
                Ok(Outcome::Restaged(_)) if is_given_up => {}
                Ok(outcome) => self.take(outcome),
                Err(error) => {
                    if self.document.is_none() {
                        // What was seen of a scene that does not open.
                        self.screen.clear();
                    }
                    if !matches!(error, SessionError::Cancelled) {
                        self.events.push(Event::Failed(error.to_string()));
                    }
                }
            }
        }
        let (newer, news) = self.preview_thread.take(self.seen_preview);
        for (_, patch) in news.patches.into_iter().filter(|(generation, _)| *generation == self.generation) {
            self.screen.take(patch);
        }
        self.finished = news.finished;
        let glare = news.glare.filter(|(generation, _)| *generation == self.generation);
        self.events.extend(glare.map(|(_, stops)| Event::Glaring(stops)));
        if let Some((_, field)) = news.field.filter(|(generation, _)| *generation == self.generation) {
            self.field = Some(field);
            self.fields += 1;
        }
        if let Some(preview) = newer {
            self.seen_preview = preview.id;
            if preview.generation == self.generation {
                self.events.push(Event::PreviewReady(preview.id));
                self.preview = Some(preview);
            }
        }
        self.events.extend(news.failures.into_iter().map(Event::Failed));
        self.events.extend(news.notices.into_iter().map(Event::Notice));
        let jobs = self.jobs();
        let moved = jobs.iter().filter(|job| !self.reported.contains(job)).cloned();
        self.events.extend(moved.map(Event::Progress));
        self.reported = jobs;
        self.keep_unsaved_work();
        self.watch_scene();
        if !self.map_changes.is_empty() {
            let rectangles = std::mem::take(&mut self.map_changes).into_values().collect();
            self.events.push(Event::MapChanged(rectangles));
        }
        std::mem::take(&mut self.events)
    }

    /// Shows a document that was opened.
    pub(super) fn take_opened(&mut self, mut document: Document) {
        document.undo.set_budget(self.options.undo_budget_bytes);
        self.forget_recovery();
        self.generation += 1;
        (self.underway, self.preview, self.field) = (None, None, None);
        self.references.clear();
        self.map_changes.clear();
        self.end_verification();
        (self.looked_through, self.fixated) = (None, None);
        let camera = self.scaled_camera(&document.camera);
        self.preview_camera = Some(camera.clone());
        let stage = (document.stage.clone(), self.generation);
        self.preview_thread.set_stage(stage, (document.map.clone(), self.map_serial), camera);
        if self.document.is_some() {
            self.screen.clear();
        }
        self.events.push(Event::Opened);
        self.events.extend(document.selection.is_some().then_some(Event::SelectionChanged));
        // What was restored is in its file already; a document as saved has none.
        self.recovery = Recovery {
            file: document.is_unsaved().then(|| document.recovery_path()),
            kept: if document.carried.is_some() { document.saved } else { document.revision },
            changed: None,
        };
        self.document = Some(document);
        self.show_tone();
        self.begin_watching();
    }

    fn take(&mut self, outcome: Outcome) {
        match outcome {
            Outcome::Opened(document) => self.take_opened(*document),
            Outcome::Followed { document, generation, revision } => {
                self.take_followed(*document, [generation, revision]);
            }
            Outcome::AsksNear(question) => self.events.push(Event::AsksNear(question)),
            Outcome::Seen(picture) => self.take_seen(&picture),
            Outcome::Restaged(restaged) => {
                if let Err(error) = self.take_restaged(*restaged) {
                    self.events.push(Event::Failed(error.to_string()));
                }
            }
            Outcome::Saved { path, revision, generation } => {
                if generation == self.generation {
                    self.forget_recovery();
                    if let Some(document) = &mut self.document {
                        document.saved = revision;
                        document.path = Some(path.clone());
                    }
                    self.recovery.kept = revision;
                }
                self.events.push(Event::Written(path));
            }
            Outcome::Kept { path, revision } => {
                self.recovery.file = Some(path);
                self.recovery.kept = revision;
            }
            Outcome::Written(path, notices) => {
                self.events.extend(notices.into_iter().map(Event::Notice));
                self.events.push(Event::Written(path));
            }
            Outcome::Reference(reference) => self.take_reference(*reference),
            Outcome::Verified(number, estimate) => self.take_verified(number, *estimate),
        }
    }
}
