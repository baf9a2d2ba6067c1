//! Cameras with presets applied.

use super::failure::Failure;
use lens::Camera;
use project::{Preset, PresetKind, PresetLibrary};
use std::ffi::OsStr;
use std::path::Path;

/// The camera with a lens preset and a bokeh preset applied, each given by name or by file.
///
/// # Errors
/// There is no preset of that name, or its file cannot be read.
pub fn with_presets(
    mut camera: Camera,
    lens: Option<&OsStr>,
    bokeh: Option<&OsStr>,
) -> Result<Camera, Failure> {
    for (kind, choice) in [(PresetKind::Lens, lens), (PresetKind::Bokeh, bokeh)] {
        let Some(choice) = choice else { continue };
        let preset = find_preset(kind, choice)?;
        camera = match preset.apply_to_camera(&camera) {
            Some(changed) => changed.map_err(Failure::bad_input)?,
            None => camera,
        };
    }
    Ok(camera)
}

/// The preset with this name, or in this file if it ends in `.json`.
fn find_preset(kind: PresetKind, choice: &OsStr) -> Result<Preset, Failure> {
    let file = Path::new(choice);
    let preset = if file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json")) {
        Preset::read(file)?
    } else {
        let library = PresetLibrary::open(PresetLibrary::default_folder());
        let name = choice.to_string_lossy();
        let what =
            || format!("no {} preset is called \"{name}\" (focus-brush presets lists them)", kind.name());
        library.find(kind, &name).cloned().ok_or_else(|| Failure::bad_input(what()))?
    };
    if preset.kind() != kind {
        let (actual, expected) = (preset.kind().name(), kind.name());
        return Err(Failure::bad_input(format!(
            "{}: is a preset of {actual} (give one of {expected})",
            file.display()
        )));
    }
    Ok(preset)
}
