//! `focus-brush import`.

use super::new::check_project_name;
use crate::cli::arguments::ImportArguments;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::input::{check_folder, read_splats, unwrap_options};
use document::{Document, Input, InputKind, NewDocumentOptions};
use project::CaptureChoices;

/// Makes a project from a capture or from Gaussian splats. Missing parts are reported and the rest is imported; the command then ends
/// as partly done.
///
/// # Errors
/// The capture cannot be read or its type not detected, the project cannot be written, or parts are missing (partly done).
pub fn run(arguments: &ImportArguments, console: &Console) -> Result<(), Failure> {
    let ImportArguments { capture, output, splats, mesh, leave_out, kind, disparity, depth, layer, near } =
        arguments;
    check_project_name(output)?;
    check_folder(output)?;
    let splats = read_splats(splats.as_deref())?;
    let new = NewDocumentOptions { splats: splats.as_ref(), ..NewDocumentOptions::default() };
    let kind_of_input = InputKind::from_path(capture)?;
    if kind_of_input == InputKind::Splats {
        let resources = console.resources();
        let document = Document::create(capture, &new, &unwrap_options(None), resources, console)?;
        console.warn(&document.warnings);
        document.to_project().save(output)?;
        console.note(&format!("wrote {}", output.display()));
        return Ok(());
    }
    if kind_of_input != InputKind::Capture {
        let what = "not a capture (give the folder of one; `focus-brush new` makes projects from scenes)";
        return Err(Failure::bad_input(format!("{}: {what}", capture.display())));
    }
    if splats.is_some() {
        let what = "splats cannot be added to a capture (add them to a scene of meshes: `focus-brush new`)";
        return Err(Failure::wrong_usage(format!("{}: {what}", capture.display())));
    }
    let choices = CaptureChoices {
        depth_strokes: Vec::new(),
        mesh: mesh.clone(),
        leave_out: leave_out.clone(),
        kind: kind.map(|kind| kind.name().into()),
        disparity: disparity.clone(),
        depth: depth.clone(),
        layer: layer.clone(),
        near: near.clone(),
    };
    let input = Input::open_capture(capture, choices, console.resources(), console)?;
    let is_incomplete = input.is_incomplete;
    let document = Document::create_from_input(input, &new, &unwrap_options(None), console)?;
    console.warn(&document.warnings);
    document.to_project().save(output)?;
    console.note(&format!("wrote {}", output.display()));
    if is_incomplete { Err(Failure::incomplete_capture(capture)) } else { Ok(()) }
}
