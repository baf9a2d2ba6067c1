//! Opening, saving, exporting and keeping unsaved work: all in the background.

use crate::commands::Event;
use crate::error::SessionError;
use crate::job_steps::JobSteps;
use crate::session::job_outcome::JobOutcome;
use crate::session::opening_preview::OpeningSteps;
use crate::session::state::Session;
use atlas::UnwrapOptions;
use document::{
    DepthPolarityRequest, Document, DocumentError, Input, InputKind, NewDocumentOptions, file_name,
    is_focus_table, write_splat_focus,
};
use lens::Picture;
use light::Resources;
use project::{CaptureChoices, FocusMapFile, Thumbnail, write_focus_map};
use render::write_scene;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// What the job that keeps unsaved work is called; it is not news.
const RECOVERY_JOB: &str = "keeping unsaved work";

/// What jobs that save are called, before the file's name.
const SAVE_JOB_PREFIX: &str = "saving";

/// How long closing waits for a file that is being written.
const MAX_WRITE_WAIT: Duration = Duration::from_secs(30);

impl Session {
    pub(super) fn open(&mut self, path: PathBuf) -> Result<(), SessionError> {
        self.start_opening(path, |path, unwrap, resources, steps| {
            Document::open(path, unwrap, resources, steps)
        })
    }

    pub(super) fn open_capture(
        &mut self,
        path: PathBuf,
        choices: CaptureChoices,
    ) -> Result<(), SessionError> {
        self.start_opening(path, |path, unwrap, resources, steps| {
            let input = Input::open_capture(path, choices, resources, steps)?;
            Document::create_from_input(input, &NewDocumentOptions::default(), unwrap, steps)
        })
    }

    pub(super) fn open_template(&mut self, path: PathBuf) -> Result<(), SessionError> {
        self.start_opening(path, |path, unwrap, resources, steps| {
            Document::open_template(path, unwrap, resources, steps)
        })
    }

    /// Opens in the background what `open` opens; a question that comes up is passed on.
    fn start_opening(
        &mut self,
        path: PathBuf,
        open: impl FnOnce(&Path, &UnwrapOptions, &Resources, &OpeningSteps<'_>) -> Result<Document, DocumentError>
        + Send
        + 'static,
    ) -> Result<(), SessionError> {
        let (unwrap, resources) = (self.options.unwrap.clone(), self.options.resources.clone());
        let label = format!("opening {}", file_name(&path));
        let opening_preview = self.opening_preview();
        self.start_job(label, move |progress| {
            match open(&path, &unwrap, &resources, &opening_preview.steps(progress)) {
                Err(DocumentError::NearUnknown { map, .. })
                    if InputKind::from_path(&path) == Ok(InputKind::Capture) =>
                {
                    Ok(JobOutcome::DepthPolarityRequired(Box::new(DepthPolarityRequest::from_map(
                        path, map,
                    )?)))
                }
                opened => Ok(JobOutcome::Opened(Box::new(opened?))),
            }
        })?;
        Ok(())
    }

    pub(super) fn save(&mut self, target: Option<PathBuf>) -> Result<(), SessionError> {
        self.commit_stroke()?;
        let generation = self.generation;
        let document = self.document_mut()?;
        let Some(path) = target.or_else(|| document.path.clone()) else {
            let what = "no project file yet (choose one with Save as)";
            return Err(SessionError::bad_file(&document.stage.scene.path, what));
        };
        let (mut project, state) = (document.to_project(), document.state());
        let (tone, preview) = (self.tone(), self.preview.as_ref());
        let preview_picture = preview.map(|preview| preview.picture.clone());
        self.start_job(format!("{SAVE_JOB_PREFIX} {}", file_name(&path)), move |_| {
            // A picture that a lost card had is the last one that was saved.
            if let Some(picture) = preview_picture.and_then(|preview_picture| preview_picture.fetch()) {
                let Picture { width, height, .. } = *picture;
                project.thumbnail = Some(Thumbnail::from_linear(width, height, tone.displayed(&picture)));
            }
            project.save(&path)?;
            Ok(JobOutcome::Saved { path, state, generation })
        })?;
        Ok(())
    }

    /// Writes unsaved work to its recovery file when it has waited long enough. Called at every poll.
    pub(super) fn save_recovery_if_due(&mut self) {
        let Some(document) = &self.document else { return };
        if !document.is_unsaved() && self.recovery.file.is_some() {
            // What it holds was undone.
            self.remove_recovery_file();
        }
        let Some(document) = &self.document else { return };
        let is_recovery_current = document.revision == self.recovery.saved_revision || !document.is_unsaved();
        if is_recovery_current || self.jobs.iter().any(|job| job.label == RECOVERY_JOB) {
            self.recovery.first_change = None;
            return;
        }
        let Some(first_change) = self.recovery.first_change else {
            self.recovery.first_change = Some(Instant::now());
            self.wake_after(self.options.recovery_delay);
            return;
        };
        if first_change.elapsed() < self.options.recovery_delay {
            return;
        }
        let (project, revision, path) = (document.to_project(), document.revision, document.recovery_path());
        let started = self.start_job(RECOVERY_JOB.into(), move |_| {
            project.save(&path)?;
            Ok(JobOutcome::RecoverySaved { path, revision })
        });
        if let Err(error) = started {
            self.events.push(Event::Failed(error.to_string()));
        }
        self.recovery.first_change = None;
    }

    /// Has the session polled again after `wait`, also when nobody touches the window.
    pub(super) fn wake_after(&self, wait: Duration) {
        let waker = self.options.waker.clone();
        let sleep = move || {
            std::thread::sleep(wait);
            waker();
        };
        // Without a thread, the next event of the window polls.
        let _ = std::thread::Builder::new().name("wake".into()).spawn(sleep);
    }

    /// Removes the recovery file: what it holds is saved, or given up.
    pub(super) fn remove_recovery_file(&mut self) {
        if let Some(file) = self.recovery.file.take()
            && let Err(error) = project::remove_recovery(&file)
        {
            self.events.push(Event::Notice(error.to_string()));
        }
    }

    pub(super) fn export_focus_map(&mut self, path: PathBuf) -> Result<(), SessionError> {
        let document = self.document_mut()?;
        let (map, atlas) = (document.map.clone(), document.stage.atlas.clone());
        let scene = document.stage.scene.clone();
        self.start_job(format!("writing {}", file_name(&path)), move |_| {
            if is_focus_table(&path) {
                write_splat_focus(&path, &scene, &atlas, &map)?;
                return Ok(JobOutcome::FileWritten(path, Vec::new()));
            }
            let losses = write_focus_map(&path, &FocusMapFile::from_atlas_map(&map, &atlas))?;
            let warnings = losses.iter().map(|what| format!("{}: {what}", path.display())).collect();
            Ok(JobOutcome::FileWritten(path, warnings))
        })?;
        Ok(())
    }

    pub(super) fn export_scene(&mut self, path: PathBuf) -> Result<(), SessionError> {
        let document = self.document_mut()?;
        let (stage, camera) = (document.stage.clone(), document.camera.clone());
        self.start_job(format!("writing {}", file_name(&path)), move |progress| {
            write_scene(&path, &stage.lit, &stage.atlas, &camera, &JobSteps { progress })?;
            Ok(JobOutcome::FileWritten(path, Vec::new()))
        })?;
        Ok(())
    }

    /// Writes what was painted in the history. Quick enough to wait for.
    pub(super) fn export_strokes(&mut self, path: &Path) -> Result<(), SessionError> {
        self.commit_stroke()?;
        let steps: Vec<_> = self.document_mut()?.undo.records().cloned().collect();
        if steps.is_empty() {
            let what = "nothing has been painted since the document was opened (paint first)";
            return Err(SessionError::bad_file(path, what));
        }
        project::write_strokes(path, &steps)?;
        self.events.push(Event::FileWritten(path.into()));
        Ok(())
    }

    /// Replaces the painted focus by a map or a recipe. Quick enough to wait for: a file is read, texels are set.
    pub(super) fn import_focus_map(&mut self, path: PathBuf) -> Result<(), SessionError> {
        self.commit_stroke()?;
        let document = self.document_mut()?;
        let map = document.load_focus_file(&path)?;
        self.import_map(map)
    }
}

impl Drop for Session {
    /// Closing in good order gives up what was not saved (the window has asked); a crash keeps it.
    ///
    /// Files that are being written are waited for; all other work is stopped.
    fn drop(&mut self) {
        self.jobs.iter().for_each(|job| job.progress.cancel());
        while self.jobs.iter().any(|job| job.label == RECOVERY_JOB || job.label.starts_with(SAVE_JOB_PREFIX))
        {
            let Ok((id, outcome)) = self.outcomes.recv_timeout(MAX_WRITE_WAIT) else { break };
            self.jobs.retain(|job| Some(job.id) != id);
            if let Ok(JobOutcome::RecoverySaved { path, .. }) = outcome {
                self.recovery.file = Some(path);
            }
        }
        if !std::thread::panicking() {
            self.remove_recovery_file();
        }
    }
}
