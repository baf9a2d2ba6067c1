//! `focus-brush presets`.

use crate::cli::arguments::PresetsArguments;
use crate::cli::console::{print_json, print_line};
use crate::cli::failure::Failure;
use project::{PresetKind, PresetLibrary};
use serde_json::json;

/// Lists all presets.
///
/// # Errors
/// Never; presets that cannot be read are listed with the reason.
pub fn run(arguments: &PresetsArguments) -> Result<(), Failure> {
    let library = PresetLibrary::open(PresetLibrary::default_folder());
    let kinds = || PresetKind::ALL.into_iter();
    if arguments.json {
        let entry = |entry: &project::LibraryEntry| {
            json!({
                "name": entry.name(),
                "file": entry.file.as_ref().map(|file| file.to_string_lossy()),
                "problem": entry.preset.as_ref().err(),
            })
        };
        let of_kind = |kind| (kind, library.entries_of_kind(kind).map(entry).collect::<Vec<_>>());
        let lists = kinds().map(of_kind).map(|(kind, list)| (kind.name().to_string(), json!(list)));
        print_json(&serde_json::Value::Object(lists.collect()));
        return Ok(());
    }
    for kind in kinds() {
        print_line(kind.name());
        for entry in library.entries_of_kind(kind) {
            match (&entry.preset, &entry.file) {
                (Err(problem), _) => print_line(format!("  {} (cannot be read: {problem})", entry.name())),
                (Ok(preset), None) => print_line(format!("  {}", preset.name)),
                (Ok(preset), Some(file)) => print_line(format!("  {}  {}", preset.name, file.display())),
            }
        }
    }
    Ok(())
}
