//! `focus-brush new`.

use super::arguments::NewArguments;
use super::console::Console;
use super::failure::Failure;
use super::shot::{check_folder, unwrap_options, world};
use project::ProjectFile;
use session::{Beginning, Document};
use std::path::Path;

/// Makes a project of a scene.
pub fn run(arguments: &NewArguments, console: &Console) -> Result<(), Failure> {
    let output = &arguments.output;
    check_project_name(output)?;
    check_folder(output)?;
    let beginning = Beginning {
        camera: arguments.camera.as_ref(),
        focus: arguments.focus.as_deref(),
        paint_from: arguments.paint_from.as_deref(),
        variant: arguments.scene_look.variant(),
    };
    let document = Document::begin(&arguments.scene, &beginning, &unwrap_options(None), console)?;
    console.warn(&document.warnings);
    let mut project = document.to_project();
    project.back_faces = arguments.scene_look.back_faces.unwrap_or(project.back_faces);
    project.world = world(&arguments.scene_look)?.or(project.world);
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
    Err(Failure::usage(format!("{}: {what}", output.display())))
}
