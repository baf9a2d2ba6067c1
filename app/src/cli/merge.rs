//! `focus-brush merge`.

use super::arguments::MergeArguments;
use super::console::{Console, path_text, print_json};
use super::failure::Failure;
use super::shot::check_folder;
use super::stopping;
use serde_json::json;
use session::{Merged, merge_tiles};
use std::time::Instant;

/// Merges the parts of a picture.
pub fn run(arguments: &MergeArguments, console: &Console) -> Result<(), Failure> {
    stopping::install_handler()?;
    super::tiles::check_exr_output(&arguments.output)?;
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
