//! `focus-brush replay`.

use super::new::check_project_name;
use crate::cli::arguments::ReplayArguments;
use crate::cli::console::{Console, path_text, print_json};
use crate::cli::failure::Failure;
use crate::cli::input::{check_folder, unwrap_options};
use document::{Document, InputKind, replay};
use project::RecordedStep;
use serde_json::json;
use std::time::Instant;

/// Applies recorded steps to a project or a scene and saves the result as a project.
///
/// # Errors
/// The input or the recording cannot be read, a step does not apply, or the project cannot be written.
pub fn run(arguments: &ReplayArguments, console: &Console) -> Result<(), Failure> {
    check_project_name(&arguments.output)?;
    check_folder(&arguments.output)?;
    let steps = project::read_strokes(&arguments.strokes)?;
    let unwrap = unwrap_options(None);
    let mut document = match InputKind::from_path(&arguments.file)? {
        InputKind::Scene => {
            Document::create(&arguments.file, &Default::default(), &unwrap, console.resources(), console)?
        }
        _ => Document::open_saved(&arguments.file, &unwrap, console.resources(), console)?,
    };
    console.warn(&document.warnings);
    let start = Instant::now();
    let painted = replay(&mut document, &steps)
        .map_err(|error| Failure::bad_input(format!("{}: {error}", arguments.strokes.display())))?;
    let seconds = start.elapsed().as_secs_f64();
    document.to_project().save(&arguments.output)?;
    if arguments.json {
        print_json(&json!({
            "input": path_text(&arguments.file),
            "files": [path_text(&arguments.output)],
            "steps": steps.len(),
            "painted": painted,
            "points": steps.iter().map(point_count).sum::<usize>(),
            "seconds": { "paint": seconds },
        }));
    } else {
        console.note(&format!(
            "wrote {}: {painted} of {} steps changed it",
            arguments.output.display(),
            steps.len()
        ));
    }
    Ok(())
}

/// Number of points of a stroke; 0 for other steps.
fn point_count(step: &RecordedStep) -> usize {
    match step {
        RecordedStep::Stroke(stroke) => stroke.points.len(),
        _ => 0,
    }
}
