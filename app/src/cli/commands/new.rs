//! `focus-brush new`.

use crate::cli::arguments::NewArguments;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::input::{check_folder, read_splats, read_world, unwrap_options};
use document::{Document, NewDocumentOptions};
use project::ProjectFile;
use std::path::Path;

/// Makes a project from a scene.
///
/// # Errors
/// The scene cannot be opened, or the project cannot be written.
pub fn run(arguments: &NewArguments, console: &Console) -> Result<(), Failure> {
    let output = &arguments.output;
    check_project_name(output)?;
    check_folder(output)?;
    let splats = read_splats(arguments.appearance.splats.as_deref())?;
    let beginning = NewDocumentOptions {
        splats: splats.as_ref(),
        floor: arguments.appearance.floor,
        camera: arguments.camera.as_ref(),
        focus: arguments.focus.as_deref(),
        paint_from: arguments.paint_from.as_deref(),
        variant: arguments.appearance.variant(),
    };
    let document =
        Document::create(&arguments.scene, &beginning, &unwrap_options(None), console.resources(), console)?;
    console.warn(&document.warnings);
    let mut project = document.to_project();
    project.back_faces = arguments.appearance.back_faces.unwrap_or(project.back_faces);
    project.world = read_world(&arguments.appearance)?.or(project.world);
    project.save(output)?;
    console.note(&format!("wrote {}", output.display()));
    Ok(())
}

/// Checks that an output file has the extension of a project.
///
/// # Errors
/// The extension is another one.
pub fn check_project_name(output: &Path) -> Result<(), Failure> {
    if output.extension().is_some_and(|e| e.eq_ignore_ascii_case(ProjectFile::EXTENSION)) {
        return Ok(());
    }
    let what = format!("project files end in .{} (change the extension)", ProjectFile::EXTENSION);
    Err(Failure::wrong_usage(format!("{}: {what}", output.display())))
}
