//! `focus-brush export`.

use crate::cli::arguments::ExportArguments;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::input::{check_folder, unwrap_options};
use document::{Input, InputKind};
use focus::FocusMap;
use lens::{FocusOffset, Picture};
use project::{FocusMapFile, Layer, PictureOptions, write_focus_map, write_picture};
use render::{Aov, RenderOptions, Rendered, render_input};
use std::path::Path;

/// Writes the requested parts of a project. A failure of one does not prevent the others from being written.
///
/// # Errors
/// The project cannot be opened, or a part cannot be written; the first failure is returned after all parts were tried.
pub fn run(arguments: &ExportArguments, console: &Console) -> Result<(), Failure> {
    let project = &arguments.project;
    if InputKind::from_path(project)? != InputKind::Project {
        return Err(Failure::bad_input(format!(
            "{}: not a project (give a .fbrush file)",
            project.display()
        )));
    }
    let mut input = Input::open(project, console.resources(), console)?;
    input.transfer_paint_if_changed(&unwrap_options(None), console)?;
    console.warn(&input.warnings);
    let mut written_count = 0;
    let mut failures = Vec::new();
    let mut record_result = |path: &Path, result: Result<(), Failure>| match result {
        Ok(()) => {
            console.note(&format!("wrote {}", path.display()));
            written_count += 1;
        }
        Err(failure) => failures.push(failure),
    };
    if let Some(path) = &arguments.focus_map {
        record_result(path, export_focus_map(&input, path, console));
    }
    if let Some(path) = &arguments.glb {
        record_result(path, export_glb(&input, path, console));
    }
    if let Some(path) = &arguments.layers {
        record_result(path, export_layers(&input, path, console));
    }
    for (name, path) in &arguments.photo {
        record_result(path, export_photograph(&input, name, path, console));
    }
    match (written_count, failures.len()) {
        (_, 0) => Ok(()),
        (0, 1) => Err(failures.remove(0)),
        (_, _) => {
            let all: Vec<_> = failures.iter().map(|failure| failure.message.as_str()).collect();
            let all = all.join("; ");
            if written_count == 0 { Err(Failure::bad_input(all)) } else { Err(Failure::partly_done(all)) }
        }
    }
}

fn export_focus_map(input: &Input, path: &Path, console: &Console) -> Result<(), Failure> {
    check_folder(path)?;
    let atlas = input.atlas(&unwrap_options(None), console)?;
    let project = input.project.as_ref();
    let blank = || {
        let mut map = FocusMap::new(atlas.width, atlas.height, FocusOffset::STANDARD);
        map.background = project.map_or(FocusOffset::STANDARD, |project| project.background_focus);
        map
    };
    let map = project.and_then(|project| project.focus_map.clone()).unwrap_or_else(blank);
    let lost = write_focus_map(path, &FocusMapFile::from_atlas_map(&map, &atlas))?;
    console.warn(&lost.iter().map(|what| format!("{}: {what}", path.display())).collect::<Vec<_>>());
    Ok(())
}

fn export_glb(input: &Input, path: &Path, console: &Console) -> Result<(), Failure> {
    check_folder(path)?;
    Ok(render::export_glb(input, path, &unwrap_options(None), console)?)
}

fn export_photograph(input: &Input, name: &str, path: &Path, console: &Console) -> Result<(), Failure> {
    check_folder(path)?;
    let (picture, layers) = render::render_photograph(input, name, console)?;
    write_layered_picture(input, path, &picture, &layers)
}

fn export_layers(input: &Input, path: &Path, console: &Console) -> Result<(), Failure> {
    if !path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr")) {
        return Err(Failure::wrong_usage(format!(
            "{}: layers are written as .exr (name one)",
            path.display()
        )));
    }
    check_folder(path)?;
    let focus = input.focus(None, &unwrap_options(None), console)?;
    let aovs = vec![Aov::Coverage, Aov::CircleOfConfusion, Aov::Depth, Aov::Focus, Aov::Seen];
    let options = RenderOptions { aovs, ..RenderOptions::default() };
    let Rendered { picture, layers, warnings, .. } =
        render_input(input, &input.camera, &focus, &options, console)?;
    console.warn(&warnings);
    write_layered_picture(input, path, &picture, &layers)
}

fn write_layered_picture(
    input: &Input,
    path: &Path,
    picture: &Picture,
    layers: &[Layer],
) -> Result<(), Failure> {
    let options = PictureOptions { exposure: input.exposure(), ..PictureOptions::default() };
    write_picture(path, picture, layers, &options)?;
    Ok(())
}
