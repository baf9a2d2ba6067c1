//! `focus-brush thumbnail`.

use crate::cli::arguments::ThumbnailArguments;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::input::check_folder;

/// Writes the thumbnail of a file. File managers run this command and choose the name of the output, so its
/// extension is not checked.
///
/// # Errors
/// The file cannot be read, or the picture cannot be written.
pub fn run(arguments: &ThumbnailArguments, console: &Console) -> Result<(), Failure> {
    let ThumbnailArguments { file, output, size } = arguments;
    check_folder(output)?;
    let thumbnail = render::read_thumbnail(file, &*light::Steps::begin(console, "drawing"))?;
    let reduced = thumbnail.reduced_to(*size);
    let smaller = reduced.map_err(|what| {
        Failure::bad_input(format!(
            "{}: its thumbnail is damaged: {what} (save the file again)",
            file.display()
        ))
    })?;
    Ok(smaller.write(output)?)
}
