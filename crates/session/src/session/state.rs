//! The state of a session, one document open at a time.

use crate::commands::Event;
use crate::display::Screen;
use crate::error::SessionError;
use crate::light_field::BakedField;
use crate::preview::{PictureTimes, Preview, PreviewActivity, PreviewThread};
use crate::reference::{Reference, ReferenceKind};
use crate::session::job_outcome::JobOutcome;
use crate::session::recovery::Recovery;
use crate::session::watched_file::WatchedFile;
use crate::verification::Verification;
use atlas::UnwrapOptions;
use document::{ActiveEdit, Document};
use focus::SpreadSettings;
use glam::{DVec2, DVec3};
use graphics_card::Gpu;
use jobs::{Job, JobId, JobProgress, JobStatus, Waker};
use lens::Camera;
use light::Resources;
use render::{Display, LightFieldStore};
use slf::PhotographLight;
use splat::Tolerance;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::{Arc, mpsc};
use std::time::Duration;

/// Options of a session.
#[derive(Clone)]
pub struct SessionOptions {
    /// How scenes are unwrapped.
    pub unwrap: UnwrapOptions,
    /// Resources for work on documents: caches.
    pub resources: Resources,
    /// Longest side of the preview, px.
    pub preview_size: u32,
    /// Memory budget of the undo history, bytes; the oldest steps are dropped beyond it.
    pub undo_budget_bytes: usize,
    /// Delay from a change to writing the recovery file: a crash loses at most this much work, plus the time for writing.
    pub recovery_delay: Duration,
    /// Idle time before the exact picture is drawn; `None`: never.
    pub exact_delay: Option<Duration>,
    /// Maximum number of passes by which light is refined after that; 0: none.
    pub light_passes: u32,
    /// Storage of light fields between runs; `None`: they are baked every time.
    pub light_field_store: Option<LightFieldStore>,
    /// The graphics card that sums and shows the preview; `None`: the processor.
    pub gpu: Option<Gpu>,
    /// The graphics card that bakes the preview's light fields; `None`: the processor.
    pub bake_on: Option<Gpu>,
    /// Called from any thread when there is something to poll.
    pub waker: Waker,
}

impl Default for SessionOptions {
    fn default() -> Self {
        Self {
            unwrap: UnwrapOptions::default(),
            resources: Resources::default(),
            preview_size: 960,
            undo_budget_bytes: Document::UNDO_BUDGET_BYTES,
            recovery_delay: Duration::from_secs(15),
            exact_delay: None,
            light_passes: 0,
            light_field_store: None,
            gpu: None,
            bake_on: None,
            waker: Arc::new(|| {}),
        }
    }
}

/// The job id of the preview's own work.
pub(super) const PREVIEW_JOB: JobId = JobId(0);

/// What is done while nothing changes: refining light, and baking a light field for a wider aperture.
pub(super) const LIGHT_JOB: JobId = JobId(u64::MAX);
pub(super) const SPARE_JOB: JobId = JobId(u64::MAX - 1);

/// An open document and the work on it. See the crate's documentation.
pub struct Session {
    pub(super) options: SessionOptions,
    pub(super) document: Option<Document>,
    /// Counts opened documents.
    pub(super) generation: u64,
    pub(super) active_edit: Option<ActiveEdit>,
    /// The layer that is to be spread once its strokes are solved for, by index, and how.
    pub(super) requested_spread: Option<(usize, SpreadSettings)>,
    pub(super) preview_thread: PreviewThread,
    pub(super) preview: Option<Preview>,
    /// The preview as it is shown.
    pub(super) screen: Screen,
    pub(super) display: Display,
    pub(super) tolerance: Tolerance,
    /// The light field that the preview is made of.
    pub(super) light_field: Option<BakedField>,
    /// Counts them.
    pub(super) light_field_count: u64,
    /// The pictures that were finished between the last two polls.
    pub(super) finished_pictures: Vec<PictureTimes>,
    /// The aperture point that the preview shows the scene through; none: all of the aperture.
    pub(super) sub_aperture_point: Option<DVec2>,
    /// The place in the world that two eyes look at; none: what the lens is focused on.
    pub(super) fixation_point: Option<DVec3>,
    /// The camera that the preview was asked to show last.
    pub(super) preview_camera: Option<Camera>,
    /// The newest preview that was seen, of whatever document.
    pub(super) last_preview_id: u64,
    /// The picture on a lost card that another was asked for in place of; 0: none.
    pub(super) replaced_preview_id: u64,
    /// Counts changes of the map that were shown to the preview.
    pub(super) map_serial: u64,
    pub(super) recovery: Recovery,
    /// The scene's file, where another program may write it again.
    pub(super) watched_file: Option<WatchedFile>,
    /// The pictures to compare with, one of a kind.
    pub(super) references: Vec<Reference>,
    /// Which of the jobs make such pictures.
    pub(super) reference_jobs: Vec<(JobId, ReferenceKind)>,
    pub(super) verification: Option<Verification>,
    pub(super) verification_job: Option<JobId>,
    /// Counts verifications.
    pub(super) verifications: u64,
    pub(super) jobs: Vec<Job>,
    pub(super) last_job: u64,
    /// What jobs hand over: with their id when they are done, without it on the way.
    pub(super) outcomes: mpsc::Receiver<(Option<JobId>, Result<JobOutcome, SessionError>)>,
    pub(super) outcome_sender: mpsc::Sender<(Option<JobId>, Result<JobOutcome, SessionError>)>,
    pub(super) events: Vec<Event>,
    /// Rectangles of the map that changed since the last poll, by squares of the atlas.
    pub(super) map_changes: BTreeMap<[u32; 2], [Range<u32>; 2]>,
    pub(super) reported_jobs: Vec<JobStatus>,
}

impl Session {
    /// A session without an open document.
    ///
    /// # Errors
    /// The preview thread cannot be started.
    pub fn new(options: SessionOptions) -> Result<Self, SessionError> {
        let (sender, outcomes) = mpsc::channel();
        Ok(Self {
            preview_thread: PreviewThread::start(
                options.waker.clone(),
                options.exact_delay,
                options.light_passes,
                options.light_field_store.clone(),
                [options.gpu.clone(), options.bake_on.clone()],
            )?,
            options,
            document: None,
            generation: 0,
            active_edit: None,
            requested_spread: None,
            preview: None,
            screen: Screen::default(),
            display: Display::default(),
            tolerance: Tolerance::VIEWING,
            light_field: None,
            light_field_count: 0,
            finished_pictures: Vec::new(),
            sub_aperture_point: None,
            fixation_point: None,
            preview_camera: None,
            last_preview_id: 0,
            replaced_preview_id: 0,
            map_serial: 0,
            recovery: Recovery::default(),
            watched_file: None,
            references: Vec::new(),
            reference_jobs: Vec::new(),
            verification: None,
            verification_job: None,
            verifications: 0,
            jobs: Vec::new(),
            last_job: PREVIEW_JOB.0,
            outcomes,
            outcome_sender: sender,
            events: Vec::new(),
            map_changes: BTreeMap::new(),
            reported_jobs: Vec::new(),
        })
    }

    /// The open document; `None` if nothing is open.
    pub fn document(&self) -> Option<&Document> {
        self.document.as_ref()
    }

    /// The last picture that could be drawn; `None` before the first.
    pub fn preview(&self) -> Option<&Preview> {
        self.preview.as_ref()
    }

    /// The display settings.
    pub fn display(&self) -> Display {
        self.display
    }

    /// Tolerance of the live picture.
    pub fn tolerance(&self) -> Tolerance {
        self.tolerance
    }

    /// The aperture point that the live picture shows the scene through, in [−1, 1]²; none: all of the aperture.
    pub fn sub_aperture_point(&self) -> Option<DVec2> {
        self.sub_aperture_point
    }

    /// The light of the photographs of what is open, once it is there.
    pub fn photograph_light(&self) -> Option<Arc<PhotographLight>> {
        self.document.as_ref()?.stage.lit.solved_photograph_light()
    }

    /// The live picture as the screen shows it.
    pub fn screen(&self) -> &Screen {
        &self.screen
    }

    /// When the pictures of full size were made that were finished between the last two calls of [`Self::poll`].
    pub fn finished_pictures(&self) -> &[PictureTimes] {
        &self.finished_pictures
    }

    /// The number of changes of the focus map so far: a preview that has seen as many shows the map as it is.
    pub fn map_serial(&self) -> u64 {
        self.map_serial
    }

    /// What the preview is doing.
    pub fn preview_activity(&self) -> PreviewActivity {
        self.preview_thread.activity().0
    }

    /// Progress of the exact picture, in [0, 1], while it is drawn.
    pub fn exact_picture_progress(&self) -> Option<f32> {
        self.preview_thread.refining()
    }

    /// Number of light fields that were baked for the live picture since the session began, apart from those of few pixels.
    pub fn baked_light_fields(&self) -> usize {
        self.preview_thread.bakes()
    }

    /// Whether a stroke or gradient is in progress.
    pub fn is_painting(&self) -> bool {
        self.active_edit.is_some()
    }

    /// Whether all background work is done and the preview shows the document as it is, within the tolerance.
    pub fn is_settled(&self) -> bool {
        self.jobs.is_empty() && self.preview_thread.is_settled(self.last_preview_id)
    }

    /// The jobs that are done while nothing changes. They may go on for minutes, and give way to everything else.
    pub const BACKGROUND_JOBS: [JobId; 2] = [LIGHT_JOB, SPARE_JOB];

    /// The state of all background work in progress.
    pub fn jobs(&self) -> Vec<JobStatus> {
        let (activity, progress) = self.preview_thread.activity();
        let label = match activity {
            PreviewActivity::RoughBaking => Some("baking roughly"),
            PreviewActivity::Baking => Some("baking"),
            _ => None,
        };
        let baking = label.map(|label| {
            let (step, seconds_left) = progress.step_status();
            let (label, fraction) = (label.into(), progress.fraction());
            JobStatus { id: PREVIEW_JOB, label, step, fraction, seconds_left, can_cancel: true }
        });
        let light = self.preview_thread.refining_light().map(|(passes, progress)| {
            let (_, seconds_left) = progress.step_status();
            let (label, step) = ("refining the light".into(), format!("{passes} passes"));
            JobStatus {
                id: LIGHT_JOB,
                label,
                step,
                fraction: progress.fraction(),
                seconds_left,
                can_cancel: true,
            }
        });
        let spare = self.preview_thread.spare_progress().map(|progress| {
            let (_, seconds_left) = progress.step_status();
            let (label, step) = ("preparing a wider aperture".into(), String::new());
            let fraction = progress.fraction();
            JobStatus { id: SPARE_JOB, label, step, fraction, seconds_left, can_cancel: true }
        });
        baking.into_iter().chain(light).chain(spare).chain(self.jobs.iter().map(Job::status)).collect()
    }

    /// The document, to be changed.
    pub(super) fn document_mut(&mut self) -> Result<&mut Document, SessionError> {
        self.document.as_mut().ok_or(SessionError::NothingOpen)
    }

    /// Starts background work; its id.
    pub(super) fn start_job(
        &mut self,
        label: String,
        work: impl FnOnce(&JobProgress) -> Result<JobOutcome, SessionError> + Send + 'static,
    ) -> Result<JobId, SessionError> {
        self.last_job += 1;
        let (sender, waker) = (self.outcome_sender.clone(), self.options.waker.clone());
        let job = Job::start(JobId(self.last_job), label, work, move |id, outcome| {
            // The session may have been dropped.
            let _ = sender.send((Some(id), outcome));
            waker();
        })?;
        self.jobs.push(job);
        Ok(JobId(self.last_job))
    }
}
