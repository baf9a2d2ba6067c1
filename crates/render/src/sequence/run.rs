//! Rendering frames one after another.

use crate::error::RenderError;
use crate::picture::{RenderOptions, Rendered};
use crate::sequence::baker::{Baking, FrameBaker};
use crate::sequence::frame_files::FrameFiles;
use crate::sequence::outcome::Outcome;
use crate::sequence::plan::frame_plan;
use crate::sequence::take::Take;
use light::Steps;
use progress::Progress;
use project::is_finished;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Writes a picture and its plan to a file. Returns all files written.
pub type WritePicture<'a> = dyn Fn(&Path, &Rendered, [u8; 32]) -> Result<Vec<PathBuf>, RenderError> + 'a;

/// How frames are rendered, and where they are written.
pub struct SequenceOptions<'a> {
    /// How each frame is rendered.
    pub render: RenderOptions,
    /// File names of the frames.
    pub files: FrameFiles,
    /// A description of the output format that includes everything the bytes depend on.
    pub written: String,
    /// Writes a picture.
    pub write: &'a WritePicture<'a>,
    /// Called after each frame.
    pub on_frame: &'a dyn Fn(&FrameReport),
    /// Checked for cancellation before each frame.
    pub progress: &'a dyn Progress,
}

/// The report on one frame.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameReport {
    /// Frame number.
    pub frame: i32,
    /// Time in the animation, s.
    pub seconds: f64,
    /// The file of its picture.
    pub file: PathBuf,
    /// Whether it was written.
    pub outcome: Outcome,
    /// Processing time, s.
    pub took_seconds: f64,
}

/// The report on a sequence.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SequenceReport {
    /// The frames, in order.
    pub frames: Vec<FrameReport>,
    /// Statistics of baking.
    pub baking: Baking,
    /// What the frames lack, one sentence each, without duplicates.
    pub warnings: Vec<String>,
}

impl SequenceReport {
    /// Number of frames whose outcome satisfies a condition.
    pub fn count(&self, matches_outcome: impl Fn(&Outcome) -> bool) -> usize {
        self.frames.iter().filter(|frame| matches_outcome(&frame.outcome)).count()
    }

    /// Estimated time saved by reusing light fields, s: the mean baking time for each reusing frame.
    pub fn saved_seconds(&self) -> f64 {
        let Baking { baked, reused, seconds, .. } = self.baking;
        if baked == 0 { 0.0 } else { seconds / f64::from(baked) * f64::from(reused) }
    }
}

/// Renders the frames that are not yet finished. If a frame fails, the others are still rendered.
///
/// # Errors
/// The work was cancelled, or there is a temporary problem of the machine (including a missing GPU). Finished frames stay.
pub fn render_frames(
    take: &Take<'_>,
    frames: &[i32],
    options: &SequenceOptions<'_>,
    steps: &dyn Steps,
) -> Result<SequenceReport, RenderError> {
    let mut report = SequenceReport::default();
    let mut baker = FrameBaker::new(take, &options.render);
    for &frame in frames {
        options.progress.check()?;
        let start = Instant::now();
        let (seconds, file) = (take.seconds(frame), options.files.path_of(frame));
        let made = render_one_frame(take, &mut baker, seconds, &file, options, &mut report.warnings, steps);
        let outcome = match made {
            Ok(outcome) => outcome,
            Err(error @ (RenderError::Cancelled | RenderError::TryAgain(_) | RenderError::GpuAbsent(_))) => {
                return Err(error);
            }
            Err(error) => Outcome::Failed(error),
        };
        let took_seconds = start.elapsed().as_secs_f64();
        let frame_report = FrameReport { frame, seconds, file, outcome, took_seconds };
        (options.on_frame)(&frame_report);
        report.frames.push(frame_report);
    }
    report.baking = baker.baking;
    Ok(report)
}

fn render_one_frame(
    take: &Take<'_>,
    baker: &mut FrameBaker<'_>,
    seconds: f64,
    file: &Path,
    options: &SequenceOptions<'_>,
    warnings: &mut Vec<String>,
    steps: &dyn Steps,
) -> Result<Outcome, RenderError> {
    let state = take.evaluate(seconds, options.progress)?;
    state
        .camera
        .validate()
        .map_err(|error| RenderError::bad_file(take.path(), format!("at {seconds} s the {error}")))?;
    let field = baker.field(&state)?;
    let baked = field.as_ref().map(|field| field.description()).unwrap_or_default();
    let plan = frame_plan(&state, &baked, &options.render, &options.written);
    if is_finished(file, &plan) {
        return Ok(Outcome::Skipped);
    }
    let rendered = baker.render(&state, field.as_ref(), steps)?;
    let mut scene_warnings = state
        .scene
        .scene
        .warnings
        .iter()
        .map(|warning| format!("{}: {warning}", take.path().display()))
        .collect();
    warnings.append(&mut scene_warnings);
    warnings.extend(rendered.warnings.iter().cloned());
    warnings.sort_unstable();
    warnings.dedup();
    (options.write)(file, &rendered, plan)?;
    Ok(Outcome::Written)
}
