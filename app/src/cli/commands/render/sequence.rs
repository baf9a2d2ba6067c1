//! `focus-brush render --frame` and `--frames`.

use super::{check_options, exposure, gpu, open, options, picture_options};
use crate::cli::arguments::RenderArguments;
use crate::cli::console::{Console, path_text, print_json};
use crate::cli::failure::Failure;
use crate::cli::input::camera_and_focus;
use crate::cli::termination;
use focus::LensMotion;
use project::{PictureOptions, read_keys, seal_picture, write_picture};
use render::RenderError;
use render::{
    Baking, FrameFiles, FrameList, FrameReport, Outcome, Rendered, SequenceOptions, SequenceReport, Shard,
    Take, TakeOptions, render_frames,
};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Renders frames.
///
/// # Errors
/// The options contradict each other, the scene cannot be opened, or frames cannot be rendered or written.
pub fn run(arguments: &RenderArguments, console: &Console) -> Result<(), Failure> {
    let sequence_arguments = &arguments.sequence;
    termination::install_handler()?;
    let gpu = gpu(arguments)?;
    check_options(arguments)?;
    let (files, frames) = files_and_frames(arguments)?;
    let keys = sequence_arguments.keys.as_deref().map(read_keys).transpose()?;

    let start = Instant::now();
    let input = open(arguments, console)?;
    let (camera, focus) = camera_and_focus(&input, &arguments.shot, console)?;
    let render = options(arguments, &input, gpu)?;
    let file_options = picture_options(arguments, exposure(arguments, &input));
    let project_motion =
        || input.project.as_ref().map_or_else(LensMotion::default, |project| project.lens_motion.clone());
    let take = TakeOptions {
        frames_per_second: sequence_arguments.fps,
        animation: sequence_arguments.animation.clone(),
        lens: keys.unwrap_or_else(project_motion),
        has_layers: arguments.shot.focus.is_none(),
        overscan: arguments.overscan,
    };
    let take = Take::new(&input, camera, &focus, take, console)?;
    let write = |file: &Path, rendered: &Rendered, plan: [u8; 32]| -> Result<Vec<PathBuf>, RenderError> {
        let frame_options =
            PictureOptions { attributes: rendered.attributes.clone(), ..file_options.clone() };
        let files = write_picture(file, &rendered.picture, &rendered.layers, &frame_options)?;
        seal_picture(&files, &plan)?;
        Ok(files)
    };
    let sequence = SequenceOptions {
        render,
        files,
        written: format!("{file_options:?} {}", extension(&arguments.output)),
        write: &write,
        on_frame: &|frame| report_frame(console, frame),
        progress: console,
    };
    let report = render_frames(&take, &frames, &sequence, console)?;
    console.warn(&report.warnings);
    summarize(arguments, console, &report, start)
}

/// The output files, and the frame numbers of this share.
fn files_and_frames(arguments: &RenderArguments) -> Result<(FrameFiles, Vec<i32>), Failure> {
    let sequence_arguments = &arguments.sequence;
    let frames = sequence_arguments.frames.clone().or(sequence_arguments.frame.map(FrameList::single));
    let frames = frames.as_ref().map_or(&[][..], FrameList::numbers);
    let files = match FrameFiles::new(&arguments.output) {
        Err(_) if sequence_arguments.frame.is_some() => FrameFiles::single(&arguments.output),
        files => files.map_err(Failure::wrong_usage)?,
    };
    let shard = sequence_arguments.shard.unwrap_or(Shard::WHOLE);
    let own = frames.iter().enumerate().filter(|(piece, _)| shard.contains(*piece)).map(|(_, frame)| *frame);
    Ok((files, own.collect()))
}

fn extension(file: &Path) -> String {
    file.extension().map(|extension| extension.to_string_lossy().to_lowercase()).unwrap_or_default()
}

/// Reports a finished frame.
fn report_frame(console: &Console, report: &FrameReport) {
    let FrameReport { frame, seconds, file, outcome, took_seconds } = report;
    let what = match outcome {
        Outcome::Written => format!("wrote {} ({took_seconds:.1} s)", file.display()),
        Outcome::Skipped => format!("{} is finished", file.display()),
        Outcome::Failed(error) => format!("frame {frame} failed: {error}"),
    };
    console.event(
        &what,
        &json!({
            "frame": frame,
            "at_seconds": seconds,
            "file": path_text(file),
            "state": outcome.name(),
            "seconds": took_seconds,
            "error": outcome.error().map(ToString::to_string),
        }),
    );
}

/// Prints the summary; an error if frames failed.
fn summarize(
    arguments: &RenderArguments,
    console: &Console,
    report: &SequenceReport,
    start: Instant,
) -> Result<(), Failure> {
    let written = report.count(|outcome| *outcome == Outcome::Written);
    let skipped = report.count(|outcome| *outcome == Outcome::Skipped);
    let failed = report.frames.len() - written - skipped;
    let Baking { baked, reused, scenes, seconds, light_seconds } = report.baking;
    let saved = report.saved_seconds();
    if arguments.json {
        let frame = |frame: &FrameReport| json!({ "frame": frame.frame, "file": path_text(&frame.file), "state": frame.outcome.name() });
        print_json(&json!({
            "input": path_text(&arguments.file),
            "frames": report.frames.iter().map(frame).collect::<Vec<_>>(),
            "written": written,
            "skipped": skipped,
            "failed": failed,
            "light_fields": { "baked": baked, "kept": reused, "seconds": seconds, "saved_seconds": saved },
            "light": { "scenes": scenes, "seconds": light_seconds },
            "seconds": start.elapsed().as_secs_f64(),
            "warnings": report.warnings,
        }));
    }
    let mut line = format!("{written} frames written, {skipped} were finished");
    if failed > 0 {
        line += &format!(", {failed} failed");
    }
    if baked > 0 {
        line += &format!("; light of {scenes} scenes in {light_seconds:.1} s");
        line += &format!(
            "; {baked} light fields baked in {seconds:.1} s, {reused} frames used one that was there"
        );
    }
    if reused > 0 {
        line += &format!(" (about {saved:.1} s saved)");
    }
    console.note(&line);
    let first = report.frames.iter().find_map(|frame| frame.outcome.error());
    match first {
        None => Ok(()),
        Some(error) if written + skipped > 0 => {
            Err(Failure::partly_done(format!("{failed} of {} frames failed: {error}", report.frames.len())))
        }
        Some(error) => Err(error.clone().into()),
    }
}
