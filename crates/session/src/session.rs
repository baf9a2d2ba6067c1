//! The session: commands in, events out, one document open at a time.

mod comparing;
mod exporting;
mod files;
mod history;
mod painting;
mod showing;
mod verifying;

pub use exporting::FullSize;

use crate::document::Document;
use crate::job::{Job, JobProgress, Waker};
use crate::light_field::BakedField;
use crate::painter::Underway;
use crate::picking::{chief_ray, pick};
use crate::preview::PreviewThread;
use crate::undo::Undo;
use crate::{
    CameraEdit, Command, Display, Event, JobId, JobStatus, LightFieldStore, PictureTimes, Preview,
    PreviewActivity, Reference, ReferenceKind, Screen, SessionError, SurfaceHit, Verification,
};
use atlas::UnwrapOptions;
use focus::FillTarget;
use glam::DVec2;
use lens::{Camera, FocusOffset};
use splat::{Gpu, Tolerance};
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::{Arc, mpsc};
use std::time::{Duration, Instant};
use trace::Ray;
use trace::truth::Estimate;

/// How a session works.
#[derive(Clone)]
pub struct SessionOptions {
    /// How scenes are unwrapped.
    pub unwrap: UnwrapOptions,
    /// The longest side that the preview is drawn at, px.
    pub preview_size: u32,
    /// Memory that steps of undo may keep alive, in bytes; the oldest are forgotten beyond it.
    pub undo_budget_bytes: usize,
    /// How long after a change unsaved work is written to its recovery file. With the time that writing takes, it
    /// is what a crash may cost.
    pub keep_after: Duration,
    /// For how long nothing must change until the exact picture is drawn; none: the one within the tolerance is enough.
    pub exact_after: Option<Duration>,
    /// Where light fields are kept from one run to the next; none: they are baked every time.
    pub light_fields: Option<LightFieldStore>,
    /// The graphics card that the preview is summed on, and shown from; none: the processor sums.
    pub gpu: Option<Gpu>,
    /// Called from any thread when there is something to poll.
    pub waker: Waker,
}

impl Default for SessionOptions {
    fn default() -> Self {
        Self {
            unwrap: UnwrapOptions::default(),
            preview_size: 960,
            undo_budget_bytes: Document::UNDO_BUDGET_BYTES,
            keep_after: Duration::from_secs(15),
            exact_after: None,
            light_fields: None,
            gpu: None,
            waker: Arc::new(|| {}),
        }
    }
}

/// The job id of the preview's own work.
const PREVIEW_JOB: JobId = JobId(0);

/// Unsaved work, kept for after a crash.
#[derive(Default)]
struct Recovery {
    /// The file that holds it, if there is one.
    file: Option<PathBuf>,
    /// The revision that the file, or the saved project, holds.
    kept: u64,
    /// When the first change after that was seen.
    changed: Option<Instant>,
}

/// What a finished job hands to the session.
pub(crate) enum Outcome {
    Opened(Box<Document>),
    /// A project file that holds this revision of this document.
    Saved {
        path: PathBuf,
        revision: u64,
        generation: u64,
    },
    /// A recovery file that holds this revision.
    Kept {
        path: PathBuf,
        revision: u64,
    },
    Written(PathBuf, Vec<String>),
    Reference(Box<Reference>),
    /// What is known after another pass of the verification of this number.
    Verified(u64, Box<Estimate>),
}

/// An open document and the work on it. See the crate's documentation.
pub struct Session {
    options: SessionOptions,
    document: Option<Document>,
    /// Counts opened documents.
    generation: u64,
    underway: Option<Underway>,
    preview_thread: PreviewThread,
    preview: Option<Preview>,
    /// The preview as it is shown.
    screen: Screen,
    display: Display,
    tolerance: Tolerance,
    /// The light field that the preview is made of.
    pub(crate) field: Option<BakedField>,
    /// Counts them.
    pub(crate) fields: u64,
    /// The pictures that were finished between the last two polls.
    finished: Vec<PictureTimes>,
    /// The camera that the preview was asked to show last.
    preview_camera: Option<Camera>,
    /// The newest preview that was seen, of whatever document.
    seen_preview: u64,
    /// Counts changes of the map that were shown to the preview.
    map_serial: u64,
    recovery: Recovery,
    /// The pictures to compare with, one of a kind.
    references: Vec<Reference>,
    /// Which of the jobs make such pictures.
    reference_jobs: Vec<(JobId, ReferenceKind)>,
    verification: Option<Verification>,
    verification_job: Option<JobId>,
    /// Counts verifications.
    verifications: u64,
    jobs: Vec<Job>,
    last_job: u64,
    /// What jobs hand over: with their id when they are done, without it on the way.
    outcomes: mpsc::Receiver<(Option<JobId>, Result<Outcome, SessionError>)>,
    sender: mpsc::Sender<(Option<JobId>, Result<Outcome, SessionError>)>,
    events: Vec<Event>,
    /// Rectangles of the map that changed since the last poll, by squares of the atlas.
    map_changes: BTreeMap<[u32; 2], [Range<u32>; 2]>,
    reported: Vec<JobStatus>,
}

impl Session {
    /// A session with nothing open.
    pub fn new(options: SessionOptions) -> Result<Self, SessionError> {
        let (sender, outcomes) = mpsc::channel();
        Ok(Self {
            preview_thread: PreviewThread::start(
                options.waker.clone(),
                options.exact_after,
                options.light_fields.clone(),
                options.gpu.clone(),
            )?,
            options,
            document: None,
            generation: 0,
            underway: None,
            preview: None,
            screen: Screen::default(),
            display: Display::default(),
            tolerance: Tolerance::VIEWING,
            field: None,
            fields: 0,
            finished: Vec::new(),
            preview_camera: None,
            seen_preview: 0,
            map_serial: 0,
            recovery: Recovery::default(),
            references: Vec::new(),
            reference_jobs: Vec::new(),
            verification: None,
            verification_job: None,
            verifications: 0,
            jobs: Vec::new(),
            last_job: PREVIEW_JOB.0,
            outcomes,
            sender,
            events: Vec::new(),
            map_changes: BTreeMap::new(),
            reported: Vec::new(),
        })
    }

    /// The open document.
    pub fn document(&self) -> Option<&Document> {
        self.document.as_ref()
    }

    /// The last good picture.
    pub fn preview(&self) -> Option<&Preview> {
        self.preview.as_ref()
    }

    /// How the screen shows any picture.
    pub fn display(&self) -> Display {
        self.display
    }

    /// How coarse the live picture may be.
    pub fn tolerance(&self) -> Tolerance {
        self.tolerance
    }

    /// The live picture as the screen shows it.
    pub fn screen(&self) -> &Screen {
        &self.screen
    }

    /// When the pictures of full size were made that were finished between the last two calls of [`Self::poll`].
    pub fn finished_pictures(&self) -> &[PictureTimes] {
        &self.finished
    }

    /// How many changes of the map there were: a preview that has seen as many shows it as it is.
    pub fn map_serial(&self) -> u64 {
        self.map_serial
    }

    /// What the preview is being drawn as.
    pub fn preview_activity(&self) -> PreviewActivity {
        self.preview_thread.activity().0
    }

    /// How far the exact picture is, in [0, 1], while it is drawn.
    pub fn drawing_exactly(&self) -> Option<f32> {
        self.preview_thread.refining()
    }

    /// Whether a stroke or a gradient is going on.
    pub fn is_painting(&self) -> bool {
        self.underway.is_some()
    }

    /// Whether all background work is done and the preview shows the document as it is, within the tolerance.
    pub fn is_settled(&self) -> bool {
        self.jobs.is_empty() && self.preview_thread.is_settled(self.seen_preview)
    }

    /// All background work that is going on.
    pub fn jobs(&self) -> Vec<JobStatus> {
        let (activity, progress) = self.preview_thread.activity();
        let label = match activity {
            PreviewActivity::RoughBaking => Some("baking roughly"),
            PreviewActivity::Baking => Some("baking"),
            _ => None,
        };
        let baking = label.map(|label| {
            let (step, seconds_left) = progress.standing();
            let (label, fraction) = (label.into(), progress.fraction());
            JobStatus { id: PREVIEW_JOB, label, step, fraction, seconds_left, can_cancel: true }
        });
        baking.into_iter().chain(self.jobs.iter().map(Job::status)).collect()
    }

    /// What a ray of either view meets first.
    pub fn pick(&self, ray: &Ray) -> Option<SurfaceHit> {
        pick(&self.document.as_ref()?.stage.tracer, ray)
    }

    /// The ray of a position in the picture: (0, 0) its upper left corner, (1, 1) its lower right.
    pub fn picture_ray(&self, position: DVec2) -> Option<Ray> {
        Some(chief_ray(&self.document.as_ref()?.camera, position))
    }

    /// The focus at a surface point.
    pub fn focus_at(&self, hit: &SurfaceHit) -> Option<FocusOffset> {
        let document = self.document.as_ref()?;
        Some(document.map.sample(document.stage.atlas.position_of(hit.point)))
    }

    /// What happened since the last call. To be called once a frame.
    pub fn poll(&mut self) -> Vec<Event> {
        while let Ok((id, outcome)) = self.outcomes.try_recv() {
            self.jobs.retain(|job| Some(job.id) != id);
            self.reference_jobs.retain(|(job, _)| Some(*job) != id);
            match outcome {
                Ok(outcome) => self.take(outcome),
                Err(SessionError::Cancelled) => {}
                Err(error) => self.events.push(Event::Failed(error.to_string())),
            }
        }
        let (newer, news) = self.preview_thread.take(self.seen_preview);
        for (_, patch) in news.patches.into_iter().filter(|(generation, _)| *generation == self.generation) {
            self.screen.take(patch);
        }
        self.finished = news.finished;
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
        if !self.map_changes.is_empty() {
            let rectangles = std::mem::take(&mut self.map_changes).into_values().collect();
            self.events.push(Event::MapChanged(rectangles));
        }
        std::mem::take(&mut self.events)
    }

    fn take(&mut self, outcome: Outcome) {
        match outcome {
            Outcome::Opened(mut document) => {
                document.undo = Undo::new(self.options.undo_budget_bytes);
                self.forget_recovery();
                self.generation += 1;
                (self.underway, self.preview, self.field) = (None, None, None);
                self.references.clear();
                self.map_changes.clear();
                self.end_verification();
                let camera = self.scaled_camera(&document.camera);
                self.preview_camera = Some(camera.clone());
                let stage = (document.stage.clone(), self.generation);
                self.preview_thread.set_stage(stage, (document.map.clone(), self.map_serial), camera);
                self.screen.clear();
                self.events.push(Event::Opened);
                self.events.extend(document.selection.is_some().then_some(Event::SelectionChanged));
                self.events.extend(document.warnings.iter().cloned().map(Event::Notice));
                // What was restored is in its file already; a document as saved has none.
                self.recovery = Recovery {
                    file: document.is_unsaved().then(|| document.recovery_path()),
                    kept: document.revision,
                    changed: None,
                };
                self.document = Some(*document);
                self.show_tone();
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

    /// Does what `command` asks, or starts doing it.
    pub fn apply(&mut self, command: Command) -> Result<(), SessionError> {
        match command {
            Command::Open(path) => self.open(path),
            Command::OpenTemplate(path) => self.open_template(path),
            Command::Undo => self.step_back(),
            Command::Redo => self.step_forward(),
            Command::GoTo(steps) => self.go_to(steps),
            Command::Do(step) => self.do_step(&step),
            Command::Camera(edit) => self.edit_camera(edit),
            Command::FinishEdit => {
                self.opened()?.undo.finish_run();
                Ok(())
            }
            Command::SetView(view) => {
                self.opened()?.view = view;
                Ok(())
            }
            Command::SetExposure(exposure) => {
                self.opened()?.exposure = exposure;
                self.show_tone();
                Ok(())
            }
            Command::SetDisplay(display) => {
                self.display = display;
                self.show_tone();
                Ok(())
            }
            Command::SetPreviewSize(size) => {
                self.options.preview_size = size.max(1);
                self.show_camera();
                Ok(())
            }
            Command::SetTolerance(tolerance) => {
                self.tolerance = tolerance;
                self.preview_thread.set_tolerance(tolerance);
                Ok(())
            }
            Command::SetBrush(brush) => match brush.problem() {
                Some(problem) => Err(SessionError::BadInput(format!("brush: {problem}"))),
                None => {
                    self.opened()?.brush = brush;
                    Ok(())
                }
            },
            Command::BeginStroke(point) => self.begin_stroke(point),
            Command::ExtendStroke(point) => self.extend_stroke(point),
            Command::CommitStroke => self.commit_stroke(),
            Command::AbortStroke => self.abort_stroke(),
            Command::Layer(edit) => self.edit_layers(edit),
            Command::ActivateLayer(index) => self.activate_layer(index),
            Command::Fill(region, focus) => self.fill(region, focus),
            Command::ResetMap => self.reset_map(),
            Command::SetBackgroundFocus(focus) => self.fill_targets(vec![FillTarget::Background], focus),
            Command::DragGradient(gradient) => self.drag_gradient(gradient),
            Command::Select(shape, combine) => self.select(shape, combine),
            Command::MaskFromSelection => self.mask_selected(),
            Command::SelectRegion(region, combine) => self.select_region(region, combine),
            Command::FocusHere(hit) => {
                let depth = self.opened()?.camera.camera_from_world(hit.position).z;
                self.edit_camera(CameraEdit::FocusDistance(depth))?;
                self.opened()?.undo.finish_run();
                Ok(())
            }
            Command::Pick(hit) => {
                let Some(focus) = self.focus_at(&hit) else { return Err(SessionError::NothingOpen) };
                self.opened()?.brush.target = focus;
                self.events.push(Event::BrushChanged);
                Ok(())
            }
            Command::Bake => {
                self.opened()?;
                self.preview_thread.bake();
                Ok(())
            }
            Command::Cancel(PREVIEW_JOB) => {
                self.preview_thread.cancel();
                Ok(())
            }
            Command::Cancel(id) => {
                self.jobs.iter().filter(|job| job.id == id).for_each(|job| job.progress.cancel());
                Ok(())
            }
            Command::CancelAll => {
                self.preview_thread.cancel();
                self.jobs.iter().for_each(|job| job.progress.cancel());
                Ok(())
            }
            Command::Save => self.save(None),
            Command::SaveAs(path) => self.save(Some(path)),
            Command::ExportPicture(path) => self.export_picture(path),
            Command::ExportShown(path) => self.export_shown(path),
            Command::ExportFocusMap(path) => self.export_focus_map(path),
            Command::ExportScene(path) => self.export_scene(path),
            Command::ExportStrokes(path) => self.export_strokes(&path),
            Command::ImportFocusMap(path) => self.import_focus_map(path),
            Command::VerifyRegion(corners) => self.verify(corners),
            Command::EndVerification => {
                self.end_verification();
                Ok(())
            }
            Command::MakeReference { kind, samples_per_pixel } => {
                self.make_reference(kind, samples_per_pixel)
            }
        }
    }

    /// The document, to be changed.
    fn opened(&mut self) -> Result<&mut Document, SessionError> {
        self.document.as_mut().ok_or(SessionError::NothingOpen)
    }

    /// Starts background work; its id.
    fn start(
        &mut self,
        label: String,
        work: impl FnOnce(&JobProgress) -> Result<Outcome, SessionError> + Send + 'static,
    ) -> Result<JobId, SessionError> {
        self.last_job += 1;
        let (sender, waker) = (self.sender.clone(), self.options.waker.clone());
        let job = Job::start(JobId(self.last_job), label, work, move |id, outcome| {
            // A session that is gone wants nothing.
            let _ = sender.send((Some(id), outcome));
            waker();
        })?;
        self.jobs.push(job);
        Ok(JobId(self.last_job))
    }
}
