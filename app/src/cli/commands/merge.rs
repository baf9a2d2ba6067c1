//! `focus-brush merge`.

use crate::cli::arguments::MergeArguments;
use crate::cli::console::{Console, path_text, print_json};
use crate::cli::failure::Failure;
use crate::cli::input::check_folder;
use crate::cli::termination;
use render::{Merged, merge_tiles};
use serde_json::json;
use std::time::Instant;

/// Merges the parts of a picture.
///
/// # Errors
/// The parts cannot be read, do not fit together or are incomplete, or the output cannot be written.
pub fn run(arguments: &MergeArguments, console: &Console) -> Result<(), Failure> {
    termination::install_handler()?;
    super::render::tiles::check_exr_output(&arguments.output)?;
    check_folder(&arguments.output)?;
    let start = Instant::now();
    let Merged { size: [width, height], tiles, warnings } =
        merge_tiles(&arguments.parts, &arguments.output, console)?;
    console.warn(&warnings);
    let seconds = start.elapsed().as_secs_f64();
    if arguments.json {
        print_json(&json!({
            "file": path_text(&arguments.output),
            "width": width,
            "height": height,
            "tiles": tiles,
            "seconds": seconds,
            "warnings": warnings,
        }));
    }
    console.note(&format!("merged {tiles} tiles to {} ({seconds:.1} s)", arguments.output.display()));
    Ok(())
}
