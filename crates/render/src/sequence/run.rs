//! Rendering frames one after the other.

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

/// Writes a picture to a file, and in it the plan that it was made by; returns all files that it wrote.
pub type WritePicture<'a> = dyn Fn(&Path, &Rendered, [u8; 32]) -> Result<Vec<PathBuf>, RenderError> + 'a;

/// What frames are rendered as, and where to.
pub struct SequenceOptions<'a> {
    /// How each is rendered.
    pub render: RenderOptions,
    /// Where they are written.
    pub files: FrameFiles,
    /// All of how a picture is written that its bytes depend on, in words.
    pub written: String,
    /// Writes a picture, and in it the plan that it was made by; returns the files.
    pub write: &'a WritePicture<'a>,
    /// Is told of every frame.
    pub on_frame: &'a dyn Fn(&FrameReport),
    /// Whether the work is to end: asked before each frame.
    pub progress: &'a dyn Progress,
}

/// A frame of the report.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameReport {
    /// Its number.
    pub frame: u32,
    /// Its time, s.
    pub seconds: f64,
    /// Its picture.
    pub file: PathBuf,
    /// What became of it.
    pub outcome: Outcome,
    /// How long it took, s.
    pub took_seconds: f64,
}

/// What was done.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SequenceReport {
    /// The frames, in order.
    pub frames: Vec<FrameReport>,
    /// What baking took, and what was not baked again.
    pub baking: Baking,
    /// What the frames lack, a sentence each, no two alike.
    pub warnings: Vec<String>,
}

impl SequenceReport {
    /// How many frames had an outcome like this.
    pub fn count(&self, is_like: impl Fn(&Outcome) -> bool) -> usize {
        self.frames.iter().filter(|frame| is_like(&frame.outcome)).count()
    }

    /// Seconds that were saved by not baking again what did not move: as many as baking took on average, for each frame.
    pub fn saved_seconds(&self) -> f64 {
        let Baking { baked, reused, seconds, .. } = self.baking;
        if baked == 0 { 0.0 } else { seconds / f64::from(baked) * f64::from(reused) }
    }
}

/// Renders frames, but for those that are finished. A frame that cannot be made does not keep the others from it.
///
/// # Errors
/// The work was cancelled, or the machine stands in the way: what is finished stays.
pub fn render_frames(
    take: &Take<'_>,
    frames: &[u32],
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
    let at = take.at(seconds, options.progress)?;
    at.camera
        .validate()
        .map_err(|error| RenderError::bad_file(take.path(), format!("at {seconds} s the {error}")))?;
    let field = baker.field(&at)?;
    let baked = field.as_ref().map(|field| field.description()).unwrap_or_default();
    let plan = frame_plan(&at, &baked, &options.render, &options.written);
    if is_finished(file, &plan) {
        return Ok(Outcome::Skipped);
    }
    let rendered = baker.render(&at, field.as_ref(), steps)?;
    let mut scene_warnings = at
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
