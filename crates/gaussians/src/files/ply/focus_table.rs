//! Focus paint as a table: t, anchor and gloss for each splat of a file.

use super::super::reading::Reading;
use super::super::splat_file::ReadOptions;
use super::header::Header;
use super::rows::Rows;
use super::writer::{write_header, write_row};
use crate::cloud::GaussianCloud;
use crate::error::GaussianError;
use lens::FocusOffset;
use progress::Progress;
use std::fs::File;
use std::io::{self, BufReader, Write};
use std::path::Path;

/// Writes the focus of each splat as a PLY table `vertex` with the properties `t`, `anchor` and `gloss`, a row for each row of the cloud's
/// file; rows that were left out of the cloud have the standard focus.
///
/// # Errors
/// `out` cannot be written.
///
/// # Panics
/// `focus` is not as long as the cloud.
pub fn write_focus_table(
    out: &mut impl Write,
    cloud: &GaussianCloud,
    focus: &[FocusOffset],
) -> io::Result<()> {
    assert_eq!(focus.len(), cloud.len());
    write_header(out, "", cloud.file_rows(), ["t", "anchor", "gloss"].map(String::from).into_iter())?;
    let mut rows = vec![FocusOffset::STANDARD; cloud.file_rows()];
    for (row, offset) in cloud.left_out().retained_rows(cloud.file_rows()).zip(focus) {
        rows[row] = *offset;
    }
    for FocusOffset { t, anchor, gloss } in rows {
        write_row(out, [t, anchor, gloss].map(|x| x as f32).into_iter())?;
    }
    Ok(())
}

/// Reads the focus of each splat of a cloud from a PLY file whose table `vertex` has the property `t` and, where not 0, `anchor` and
/// `gloss`, whatever its other properties: a table as [`write_focus_table`] writes it, or a scene that has them, too. It has a row for
/// each row of the cloud's file.
///
/// # Errors
/// The file cannot be read, has no such properties, has another number of rows, or an offset is not valid (t finite, anchor and gloss
/// in [0, 1]); or `progress` cancels.
pub fn read_focus_table(
    path: &Path,
    cloud: &GaussianCloud,
    progress: &dyn Progress,
) -> Result<Vec<FocusOffset>, GaussianError> {
    let unreadable = |source| GaussianError::unreadable(path, source);
    let options = ReadOptions::default();
    let reading = Reading::new(path, &options, progress);
    let file = File::open(path).map_err(unreadable)?;
    let size = file.metadata().map_err(unreadable)?.len();
    let mut input = BufReader::new(file);
    let header = Header::read(&reading, &mut input)?;
    let vertices = header.vertices(&reading)?;
    let mut rows = Rows::new(&header, input, size);
    for element in header.elements.iter().take_while(|element| element.name != vertices.name) {
        rows.skip(&reading, element)?;
    }
    let t = vertices.column("t").ok_or_else(|| reading.malformed("vertex", "has no property t"))?;
    let [anchor, gloss] = ["anchor", "gloss"].map(|name| vertices.column(name));
    let file_rows = cloud.file_rows();
    if vertices.count != file_rows as u64 {
        let what = format!("has {} rows, but the scene has {file_rows} splats", vertices.count);
        return Err(reading.malformed("vertex", what));
    }
    rows.check_count(&reading, vertices)?;
    let (mut focus, mut row) = (Vec::with_capacity(cloud.len()), Vec::new());
    let mut retained = cloud.left_out().retained_rows(file_rows).peekable();
    for index in 0..file_rows {
        reading.at_row(index as u64, vertices.count)?;
        rows.next(&reading, vertices, &mut row)?;
        if retained.next_if_eq(&index).is_none() {
            continue;
        }
        let or_zero = |column: Option<usize>| column.map_or(0.0, |column| row[column]);
        let offset = FocusOffset { t: row[t], anchor: or_zero(anchor), gloss: or_zero(gloss) };
        if !offset.is_valid() {
            let what = "t must be finite, anchor and gloss must be from 0 to 1";
            return Err(reading.malformed(format!("row {index}"), what));
        }
        focus.push(offset);
    }
    Ok(focus)
}
