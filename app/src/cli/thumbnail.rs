//! `focus-brush thumbnail`.

use super::arguments::ThumbnailArguments;
use super::console::Console;
use super::failure::Failure;
use super::shot::check_folder;

/// Writes the small picture of a file. File managers ask for it beside their own work, and name its file as they like.
pub fn run(arguments: &ThumbnailArguments, console: &Console) -> Result<(), Failure> {
    let ThumbnailArguments { file, output, size } = arguments;
    check_folder(output)?;
    let thumbnail = session::read_thumbnail(file, &*session::Steps::begin(console, "drawing"))?;
    let reduced = thumbnail.reduced_to(*size);
    let smaller = reduced.map_err(|what| {
        Failure::bad_input(format!("{}: its picture is damaged: {what} (save it anew)", file.display()))
    })?;
    Ok(smaller.write(output)?)
}
