//! From where a picture is taken, and how it is focused.

use super::arguments::{AppearanceArguments, AtlasArguments, ShotArguments};
use super::console::Console;
use super::failure::Failure;
use super::presets::with_presets;
use atlas::{Density, UnwrapOptions, UvPolicy};
use focus::Focus;
use lens::Camera;
use project::WorldFile;
use session::{Input, Steps};
use std::path::Path;

/// How scenes are unwrapped: by the engines of this program in child processes.
pub fn unwrap_options(arguments: Option<&AtlasArguments>) -> UnwrapOptions {
    let density = match arguments {
        Some(AtlasArguments { density: Some(density), .. }) => Density::TexelsPerUnit(*density),
        Some(AtlasArguments { side: Some(side), .. }) => Density::Side(*side),
        _ => Density::Auto,
    };
    let ignore_uv = arguments.is_some_and(|arguments| arguments.ignore_uv);
    UnwrapOptions {
        density,
        uv: if ignore_uv { UvPolicy::Ignore } else { UvPolicy::Auto },
        child: std::env::current_exe().ok(),
        ..UnwrapOptions::default()
    }
}

/// Opens what is to be shown, seen and lit as asked for.
pub fn open_input(
    file: &Path,
    appearance: &AppearanceArguments,
    steps: &dyn Steps,
) -> Result<Input, Failure> {
    let world = read_world(appearance)?;
    let mut input = Input::open_variant(file, &appearance.variant(), steps)?;
    input.transfer_paint_if_changed(&unwrap_options(None), steps)?;
    if let Some(back_faces) = appearance.back_faces {
        input.set_back_faces(back_faces);
    }
    if let Some(world) = world {
        let world = world.load(&input.scene)?;
        input.set_world(Some(world));
    }
    input.set_single_scattering(appearance.single_scattering);
    input.set_photo_lookup(appearance.photos);
    Ok(input)
}

/// The world that was asked for, its environment not yet read.
pub fn read_world(appearance: &AppearanceArguments) -> Result<Option<WorldFile>, Failure> {
    let Some(file) = &appearance.world else { return Ok(None) };
    let is_picture = file.extension().is_some_and(|e| {
        ["hdr", "exr"].iter().any(|picture_extension| e.eq_ignore_ascii_case(picture_extension))
    });
    Ok(Some(if is_picture { WorldFile::from_environment_file(file) } else { WorldFile::read(file)? }))
}

/// The camera and the focus that were asked for.
pub fn camera_and_focus(
    input: &Input,
    arguments: &ShotArguments,
    console: &Console,
) -> Result<(Camera, Focus), Failure> {
    let camera = input.camera(arguments.camera.as_ref())?;
    let mut camera = with_presets(camera, arguments.lens.as_deref(), arguments.bokeh.as_deref())?;
    if let Some(radius) = arguments.aperture_radius {
        camera.aperture_radius = radius;
    }
    if let Some([width, height]) = arguments.size {
        (camera.width, camera.height) = (width, height);
    }
    let focus = input.focus(arguments.focus.as_deref(), &unwrap_options(None), console)?;
    Ok((camera, focus))
}

/// An error if the folder of an output is not there: better before the work than after it.
pub fn check_folder(output: &Path) -> Result<(), Failure> {
    match output.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        Some(folder) if !folder.is_dir() => Err(Failure::bad_input(format!(
            "{}: its folder does not exist (make it first)",
            output.display()
        ))),
        _ => Ok(()),
    }
}

/// An error if a picture cannot be written to `output`: better before the work than after it.
pub fn check_picture_output(output: &Path) -> Result<(), Failure> {
    let extension = output.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    if !["exr", "png"].contains(&extension.as_str()) {
        let what = "pictures are written as .exr or .png (name one of them)";
        return Err(Failure::wrong_usage(format!("{}: {what}", output.display())));
    }
    check_folder(output)
}
