//! `focus-brush new`.

use super::arguments::NewArguments;
use super::console::Console;
use super::failure::Failure;
use super::shot::{check_folder, read_world, unwrap_options};
use project::ProjectFile;
use session::{Document, NewDocumentOptions};
use std::path::Path;

/// Makes a project of a scene.
pub fn run(arguments: &NewArguments, console: &Console) -> Result<(), Failure> {
    let output = &arguments.output;
    check_project_name(output)?;
    check_folder(output)?;
    let beginning = NewDocumentOptions {
        camera: arguments.camera.as_ref(),
        focus: arguments.focus.as_deref(),
        paint_from: arguments.paint_from.as_deref(),
        variant: arguments.appearance.variant(),
    };
    let document = Document::create(&arguments.scene, &beginning, &unwrap_options(None), console)?;
    console.warn(&document.warnings);
    let mut project = document.to_project();
    project.back_faces = arguments.appearance.back_faces.unwrap_or(project.back_faces);
    project.world = read_world(&arguments.appearance)?.or(project.world);
    project.save(output)?;
    console.note(&format!("wrote {}", output.display()));
    Ok(())
}

/// An error if an output is not named as a project.
pub fn check_project_name(output: &Path) -> Result<(), Failure> {
    if output.extension().is_some_and(|e| e.eq_ignore_ascii_case(ProjectFile::EXTENSION)) {
        return Ok(());
    }
    let what = format!("projects end in .{} (name one)", ProjectFile::EXTENSION);
    Err(Failure::wrong_usage(format!("{}: {what}", output.display())))
}
