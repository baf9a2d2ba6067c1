//! Opens what the arguments describe: the scene with its appearance, its camera and its focus.

use super::arguments::{AppearanceArguments, AtlasArguments, ShotArguments};
use super::camera_presets::with_presets;
use super::console::Console;
use super::failure::Failure;
use atlas::{Density, UnwrapOptions, UvPolicy};
use document::{Input, InputKind};
use focus::Focus;
use lens::Camera;
use light::{Resources, Steps};
use project::{CaptureChoices, EnvironmentChoice, SplatsFile, WorldFile};
use scene::BuiltInEnvironment;
use std::path::Path;

/// The options for unwrapping; the engines run in child processes of this program.
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

/// Opens a file with the requested appearance, of a picture with depth the requested layer.
///
/// # Errors
/// The file cannot be opened, or an option of its appearance is invalid.
pub fn open_input(
    file: &Path,
    appearance: &AppearanceArguments,
    layer: Option<&str>,
    resources: &Resources,
    steps: &dyn Steps,
) -> Result<Input, Failure> {
    let world = read_world(appearance)?;
    let mut input = match layer {
        None => Input::open_variant(file, &appearance.variant(), resources, steps)?,
        Some(_) if InputKind::from_path(file)? != InputKind::Capture => {
            let what = "has no layers to choose from: it is not a picture with depth (leave out --layer)";
            return Err(Failure::bad_input(format!("{}: {what}", file.display())));
        }
        Some(layer) => {
            let choices = CaptureChoices { layer: Some(layer.into()), ..CaptureChoices::default() };
            Input::open_capture(file, choices, resources, steps)?
        }
    };
    if let Some(splats) = read_splats(appearance.splats.as_deref())? {
        input.set_splats(&splats, steps)?;
    }
    if appearance.floor {
        input.set_floor(true)?;
    }
    input.transfer_paint_if_changed(&unwrap_options(None), steps)?;
    if let Some(back_faces) = appearance.back_faces {
        input.set_back_faces(back_faces);
    }
    if let Some(world) = world {
        let (world, faults) = world.load(&input.scene)?;
        input.set_world(Some(world));
        input.warnings.extend(faults);
    }
    input.light = appearance.light();
    Ok(input)
}

/// The requested world; its environment map is not read yet.
///
/// # Errors
/// The environment map is not of a supported type.
pub fn read_world(appearance: &AppearanceArguments) -> Result<Option<WorldFile>, Failure> {
    let Some(file) = &appearance.world else { return Ok(None) };
    let built_in = file.to_str().and_then(BuiltInEnvironment::from_name);
    if let Some(built_in) = built_in.filter(|_| !file.exists()) {
        let environment = EnvironmentChoice::BuiltIn(built_in);
        return Ok(Some(WorldFile { environment, ..WorldFile::default() }));
    }
    let is_picture = file.extension().is_some_and(|e| {
        ["hdr", "exr"].iter().any(|picture_extension| e.eq_ignore_ascii_case(picture_extension))
    });
    Ok(Some(if is_picture { WorldFile::from_environment_file(file) } else { WorldFile::read(file)? }))
}

/// The requested splats, by a file of splats or one that describes them; their own file is not read yet.
///
/// # Errors
/// The file is of neither type, or what it says cannot be used.
pub fn read_splats(file: Option<&Path>) -> Result<Option<SplatsFile>, Failure> {
    let Some(file) = file else { return Ok(None) };
    let is_json = file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"));
    if is_json && InputKind::from_path(file).ok() != Some(InputKind::Splats) {
        return Ok(Some(SplatsFile::read(file)?));
    }
    match InputKind::from_path(file)? {
        InputKind::Splats => Ok(Some(SplatsFile { file: Some(file.into()), ..SplatsFile::default() })),
        _ => {
            let what = "is no file of Gaussian splats (give a .ply, .spz, .sog, .splat or .ksplat, or a .json about one)";
            Err(Failure::bad_input(format!("{}: {what}", file.display())))
        }
    }
}

/// Refuses splats and a floor that only one run would know of, where a project has to say what is shown.
///
/// # Errors
/// Splats or a floor are requested.
pub fn refuse_additions(appearance: &AppearanceArguments) -> Result<(), Failure> {
    match &appearance.splats {
        None if appearance.floor => Err(Failure::wrong_usage(
            "--floor: a floor must be in a project here (make one: `focus-brush new SCENE --floor -o PROJECT.fbrush`)",
        )),
        None => Ok(()),
        Some(file) => Err(Failure::wrong_usage(format!(
            "{}: splats must be in a project here (make one: `focus-brush new SCENE --splats … -o PROJECT.fbrush`)",
            file.display()
        ))),
    }
}

/// The requested camera and focus.
///
/// # Errors
/// There is no such camera, or the camera, recipe or focus map cannot be read.
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

/// Checks that the folder of an output exists, before any work is done.
///
/// # Errors
/// The folder does not exist.
pub fn check_folder(output: &Path) -> Result<(), Failure> {
    match output.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        Some(folder) if !folder.is_dir() => Err(Failure::bad_input(format!(
            "{}: its folder does not exist (create it first)",
            output.display()
        ))),
        _ => Ok(()),
    }
}

/// Checks that a picture can be written to `output`, before any work is done.
///
/// # Errors
/// The folder does not exist, or the extension is not that of a supported picture format.
pub fn check_picture_output(output: &Path) -> Result<(), Failure> {
    let extension = output.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    if !["exr", "png"].contains(&extension.as_str()) {
        let what = "pictures are written as .exr or .png (name one of them)";
        return Err(Failure::wrong_usage(format!("{}: {what}", output.display())));
    }
    check_folder(output)
}
