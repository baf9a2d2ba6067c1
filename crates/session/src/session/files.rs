//! Opening, saving, exporting and keeping unsaved work: all in the background.

use super::first_look::OpeningSteps;
use super::outcome::Outcome;
use super::state::Session;
use crate::commands::Event;
use crate::document::{Beginning, Document, Input, InputKind, NearQuestion};
use crate::error::{SessionError, file_name};
use crate::jobs::JobSteps;
use crate::output::write_scene;
use atlas::UnwrapOptions;
use lens::Picture;
use project::{CaptureChoices, FocusMapFile, Thumbnail, write_focus_map};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// What the job that keeps unsaved work is called; it is not news.
const KEEPING: &str = "keeping unsaved work";

/// What jobs that save are called, before the file's name.
const SAVING: &str = "saving";

/// How long closing waits for a file that is being written.
const LONGEST_WRITE: Duration = Duration::from_secs(30);

impl Session {
    pub(super) fn open(&mut self, path: PathBuf) -> Result<(), SessionError> {
        self.start_opening(path, |path, unwrap, steps| Document::open(path, unwrap, steps))
    }

    pub(super) fn open_capture(
        &mut self,
        path: PathBuf,
        choices: CaptureChoices,
    ) -> Result<(), SessionError> {
        self.start_opening(path, |path, unwrap, steps| {
            let input = Input::open_capture(path, choices, steps)?;
            Document::begin_with(input, &Beginning::default(), unwrap, steps)
        })
    }

    pub(super) fn open_template(&mut self, path: PathBuf) -> Result<(), SessionError> {
        self.start_opening(path, |path, unwrap, steps| Document::open_template(path, unwrap, steps))
    }

    /// Opens in the background what `open` opens; a question that comes up is passed on.
    fn start_opening(
        &mut self,
        path: PathBuf,
        open: impl FnOnce(&Path, &UnwrapOptions, &OpeningSteps<'_>) -> Result<Document, SessionError>
        + Send
        + 'static,
    ) -> Result<(), SessionError> {
        let unwrap = self.options.unwrap.clone();
        let label = format!("opening {}", file_name(&path));
        let first_look = self.first_look();
        self.start(label, move |progress| match open(&path, &unwrap, &first_look.steps(progress)) {
            Err(SessionError::NearUnknown { map, .. }) if InputKind::of(&path) == Ok(InputKind::Capture) => {
                Ok(Outcome::AsksNear(Box::new(NearQuestion::of(path, map)?)))
            }
            opened => Ok(Outcome::Opened(Box::new(opened?))),
        })?;
        Ok(())
    }

    pub(super) fn save(&mut self, to: Option<PathBuf>) -> Result<(), SessionError> {
        self.commit_stroke()?;
        let generation = self.generation;
        let document = self.opened()?;
        let Some(path) = to.or_else(|| document.path.clone()) else {
            let what = "no project file yet (choose one with Save as)";
            return Err(SessionError::bad(&document.stage.scene.path, what));
        };
        let (mut project, revision) = (document.to_project(), document.revision);
        let (tone, preview) = (self.tone(), self.preview.as_ref());
        let shown = preview.map(|preview| preview.picture.clone());
        self.start(format!("{SAVING} {}", file_name(&path)), move |_| {
            // A picture that a lost card had is the last one that was saved.
            if let Some(picture) = shown.and_then(|shown| shown.bring()) {
                let Picture { width, height, .. } = *picture;
                project.thumbnail = Some(Thumbnail::of(width, height, tone.displayed(&picture)));
            }
            project.save(&path)?;
            Ok(Outcome::Saved { path, revision, generation })
        })?;
        Ok(())
    }

    /// Writes unsaved work to its recovery file when it has waited long enough. Called at every poll.
    pub(super) fn keep_unsaved_work(&mut self) {
        let Some(document) = &self.document else { return };
        let is_kept = document.revision == self.recovery.kept || !document.is_unsaved();
        if is_kept || self.jobs.iter().any(|job| job.label == KEEPING) {
            self.recovery.changed = None;
            return;
        }
        let Some(changed) = self.recovery.changed else {
            self.recovery.changed = Some(Instant::now());
            self.wake_in(self.options.keep_after);
            return;
        };
        if changed.elapsed() < self.options.keep_after {
            return;
        }
        let (project, revision, path) = (document.to_project(), document.revision, document.recovery_path());
        let kept = self.start(KEEPING.into(), move |_| {
            project.save(&path)?;
            Ok(Outcome::Kept { path, revision })
        });
        if let Err(error) = kept {
            self.events.push(Event::Failed(error.to_string()));
        }
        self.recovery.changed = None;
    }

    /// Has the session polled again after `wait`, also when nobody touches the window.
    pub(super) fn wake_in(&self, wait: Duration) {
        let waker = self.options.waker.clone();
        let sleep = move || {
            std::thread::sleep(wait);
            waker();
        };
        // Without a thread, the next event of the window polls.
        let _ = std::thread::Builder::new().name("wake".into()).spawn(sleep);
    }

    /// Removes the recovery file: what it holds is saved, or given up.
    pub(super) fn forget_recovery(&mut self) {
        if let Some(file) = self.recovery.file.take()
            && let Err(error) = project::remove_recovery(&file)
        {
            self.events.push(Event::Notice(error.to_string()));
        }
    }

    pub(super) fn export_focus_map(&mut self, path: PathBuf) -> Result<(), SessionError> {
        let document = self.opened()?;
        let (map, atlas) = (document.map.clone(), document.stage.atlas.clone());
        self.start(format!("writing {}", file_name(&path)), move |_| {
            let lost = write_focus_map(&path, &FocusMapFile::of_atlas(&map, &atlas))?;
            let lost = lost.iter().map(|what| format!("{}: {what}", path.display())).collect();
            Ok(Outcome::Written(path, lost))
        })?;
        Ok(())
    }

    pub(super) fn export_scene(&mut self, path: PathBuf) -> Result<(), SessionError> {
        let document = self.opened()?;
        let (stage, camera) = (document.stage.clone(), document.camera.clone());
        self.start(format!("writing {}", file_name(&path)), move |progress| {
            write_scene(&path, &stage.tracer, &stage.atlas, &camera, &JobSteps { progress })?;
            Ok(Outcome::Written(path, Vec::new()))
        })?;
        Ok(())
    }

    /// Writes what was painted in the history. Quick enough to wait for.
    pub(super) fn export_strokes(&mut self, path: &Path) -> Result<(), SessionError> {
        self.commit_stroke()?;
        let steps: Vec<_> = self.opened()?.undo.records().cloned().collect();
        if steps.is_empty() {
            let what = "nothing was painted since the document was opened (paint first)";
            return Err(SessionError::bad(path, what));
        }
        project::write_strokes(path, &steps)?;
        self.events.push(Event::Written(path.into()));
        Ok(())
    }

    /// Replaces the painted focus by a map or a recipe. Quick enough to wait for: a file is read, texels are set.
    pub(super) fn import_focus_map(&mut self, path: PathBuf) -> Result<(), SessionError> {
        self.commit_stroke()?;
        let document = self.opened()?;
        let map = document.imported_focus(&path)?;
        self.import_map(map)
    }
}

impl Drop for Session {
    /// Closing in good order gives up what was not saved (the window has asked); a crash keeps it.
    ///
    /// Files that are being written are waited for; all other work is stopped.
    fn drop(&mut self) {
        self.jobs.iter().for_each(|job| job.progress.cancel());
        while self.jobs.iter().any(|job| job.label == KEEPING || job.label.starts_with(SAVING)) {
            let Ok((id, outcome)) = self.outcomes.recv_timeout(LONGEST_WRITE) else { break };
            self.jobs.retain(|job| Some(job.id) != id);
            if let Ok(Outcome::Kept { path, .. }) = outcome {
                self.recovery.file = Some(path);
            }
        }
        if !std::thread::panicking() {
            self.forget_recovery();
        }
    }
}
