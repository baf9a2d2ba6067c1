//! `focus-brush presets`, and cameras with presets.

use super::arguments::PresetsArguments;
use super::console::{say, say_json};
use super::failure::Failure;
use lens::Camera;
use project::{Preset, PresetKind, PresetShelf};
use serde_json::json;
use std::ffi::OsStr;
use std::path::Path;

/// Lists all presets.
pub fn run(arguments: &PresetsArguments) -> Result<(), Failure> {
    let shelf = PresetShelf::open(PresetShelf::usual_folder());
    let kinds = || PresetKind::ALL.into_iter();
    if arguments.json {
        let entry = |entry: &project::ShelfEntry| {
            json!({
                "name": entry.name(),
                "file": entry.file.as_ref().map(|file| file.to_string_lossy()),
                "problem": entry.preset.as_ref().err(),
            })
        };
        let of_kind = |kind| (kind, shelf.of_kind(kind).map(entry).collect::<Vec<_>>());
        let lists = kinds().map(of_kind).map(|(kind, list)| (kind.name().to_string(), json!(list)));
        say_json(&serde_json::Value::Object(lists.collect()));
        return Ok(());
    }
    for kind in kinds() {
        say(kind.name());
        for entry in shelf.of_kind(kind) {
            match (&entry.preset, &entry.file) {
                (Err(problem), _) => say(format!("  {} (cannot be read: {problem})", entry.name())),
                (Ok(preset), None) => say(format!("  {}", preset.name)),
                (Ok(preset), Some(file)) => say(format!("  {}  {}", preset.name, file.display())),
            }
        }
    }
    Ok(())
}

/// The camera with a lens and a bokeh, each the name of a preset or its file.
pub fn with_presets(
    mut camera: Camera,
    lens: Option<&OsStr>,
    bokeh: Option<&OsStr>,
) -> Result<Camera, Failure> {
    for (kind, wanted) in [(PresetKind::Lens, lens), (PresetKind::Bokeh, bokeh)] {
        let Some(wanted) = wanted else { continue };
        let preset = found(kind, wanted)?;
        camera = match preset.camera(&camera) {
            Some(changed) => changed.map_err(Failure::bad)?,
            None => camera,
        };
    }
    Ok(camera)
}

/// The preset of a name, or of a file that ends in `.json`.
fn found(kind: PresetKind, wanted: &OsStr) -> Result<Preset, Failure> {
    let file = Path::new(wanted);
    let preset = if file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json")) {
        Preset::read(file)?
    } else {
        let shelf = PresetShelf::open(PresetShelf::usual_folder());
        let name = wanted.to_string_lossy();
        let what =
            || format!("no {} preset is called \"{name}\" (focus-brush presets lists them)", kind.name());
        shelf.named(kind, &name).cloned().ok_or_else(|| Failure::bad(what()))?
    };
    if preset.kind() != kind {
        let (is, wants) = (preset.kind().name(), kind.name());
        return Err(Failure::bad(format!("{}: is a preset of {is} (give one of {wants})", file.display())));
    }
    Ok(preset)
}
