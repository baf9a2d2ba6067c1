//! What background work brings, taken up once a frame.

use crate::commands::Event;
use crate::error::SessionError;
use crate::session::job_outcome::JobOutcome;
use crate::session::recovery::Recovery;
use crate::session::state::Session;
use document::Document;
use progress::Progress;

impl Session {
    /// What happened since the last call. To be called once a frame.
    pub fn poll(&mut self) -> Vec<Event> {
        while let Ok((id, outcome)) = self.outcomes.try_recv() {
            let is_cancelled = self.jobs.iter().any(|job| Some(job.id) == id && job.progress.cancelled());
            self.jobs.retain(|job| Some(job.id) != id);
            self.reference_jobs.retain(|(job, _)| Some(*job) != id);
            match outcome {
                // It was done before it could be stopped; a newer one has its place.
                Ok(
                    JobOutcome::StageRebuilt(_)
                    | JobOutcome::SpreadSolved { .. }
                    | JobOutcome::SelectionFound { .. },
                ) if is_cancelled => {}
                Ok(outcome) => self.take_outcome(outcome),
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
        let (new_preview, updates) = self.preview_thread.take(self.last_preview_id);
        for (_, patch) in updates.patches.into_iter().filter(|(generation, _)| *generation == self.generation)
        {
            self.screen.apply_patch(patch);
        }
        self.finished_pictures = updates.finished;
        let glare = updates.glare.filter(|(generation, _)| *generation == self.generation);
        self.events.extend(glare.map(|(_, stops)| Event::GlareDetected(stops)));
        if let Some((_, field)) = updates.field.filter(|(generation, _)| *generation == self.generation) {
            self.light_field = Some(field);
            self.light_field_count += 1;
        }
        if let Some(preview) = new_preview {
            self.last_preview_id = preview.id;
            if preview.generation == self.generation {
                self.events.push(Event::PreviewReady(preview.id));
                self.preview = Some(preview);
            }
        }
        self.replace_lost_picture();
        self.events.extend(updates.failures.into_iter().map(Event::Failed));
        self.events.extend(updates.notices.into_iter().map(Event::Notice));
        let jobs = self.jobs();
        let changed_jobs = jobs.iter().filter(|job| !self.reported_jobs.contains(job)).cloned();
        self.events.extend(changed_jobs.map(Event::Progress));
        self.reported_jobs = jobs;
        self.save_recovery_if_due();
        self.check_watched_scene();
        if !self.map_changes.is_empty() {
            let rectangles = std::mem::take(&mut self.map_changes).into_values().collect();
            self.events.push(Event::MapChanged(rectangles));
        }
        std::mem::take(&mut self.events)
    }

    /// Asks, once a picture, for another one where the card that had it is lost.
    fn replace_lost_picture(&mut self) {
        let is_lost = self.preview.as_ref().is_some_and(|preview| preview.picture.is_lost());
        if is_lost && self.replaced_preview_id != self.last_preview_id {
            self.replaced_preview_id = self.last_preview_id;
            self.preview_thread.replace_lost_picture();
        }
    }

    /// Shows a document that was opened.
    pub(super) fn show_opened(&mut self, mut document: Document) {
        document.undo.set_budget(self.options.undo_budget_bytes);
        self.remove_recovery_file();
        self.generation += 1;
        (self.active_edit, self.preview, self.light_field) = (None, None, None);
        self.requested_spread = None;
        self.references.clear();
        self.map_changes.clear();
        self.end_verification();
        (self.sub_aperture_point, self.fixation_point) = (None, None);
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
            saved_revision: if document.paint_transfer.is_some() {
                document.saved_revision()
            } else {
                document.revision
            },
            first_change: None,
        };
        self.document = Some(document);
        self.show_tone();
        self.begin_watching();
    }

    fn take_outcome(&mut self, outcome: JobOutcome) {
        match outcome {
            JobOutcome::Opened(document) => self.show_opened(*document),
            JobOutcome::SceneReloaded { document, generation, revision } => {
                self.show_reloaded(*document, [generation, revision]);
            }
            JobOutcome::DepthPolarityRequired(question) => {
                self.events.push(Event::DepthPolarityRequired(question))
            }
            JobOutcome::OpeningPicture(picture) => self.show_opening_picture(&picture),
            JobOutcome::StageRebuilt(restaged) => {
                if let Err(error) = self.show_rebuilt_stage(*restaged) {
                    self.events.push(Event::Failed(error.to_string()));
                }
            }
            JobOutcome::Saved { path, state, generation } => {
                if generation == self.generation {
                    self.remove_recovery_file();
                    if let Some(document) = &mut self.document {
                        document.set_saved(state);
                        document.path = Some(path.clone());
                    }
                    self.recovery.saved_revision = state.revision;
                }
                self.events.push(Event::FileWritten(path));
            }
            JobOutcome::RecoverySaved { path, revision } => {
                self.recovery.file = Some(path);
                self.recovery.saved_revision = revision;
            }
            JobOutcome::SpreadSolved { solved, generation } => {
                let shown = self.show_solved_spread(*solved, generation);
                self.events.extend(shown.err().map(|error| Event::Failed(error.to_string())));
            }
            JobOutcome::SelectionFound { matches, combine, generation } => {
                let selected = self.select_matches(*matches, combine, generation);
                self.events.extend(selected.err().map(|error| Event::Failed(error.to_string())));
            }
            JobOutcome::FileWritten(path, notices) => {
                self.events.extend(notices.into_iter().map(Event::Notice));
                self.events.push(Event::FileWritten(path));
            }
            JobOutcome::Reference(reference) => self.take_reference(*reference),
            JobOutcome::VerificationPass(number, estimate) => self.show_verification_pass(number, *estimate),
        }
    }
}
