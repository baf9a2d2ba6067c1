//! Detection of the views in a folder, and of their naming scheme.

use super::arrangement::Arrangement;
use super::hexagon::arrange_hexagon;
use super::optics::read_parameters;
use super::row_column::{arrange_by_positions, arrange_by_row_column, arrange_numbered};
use super::view_list::{NAME, read_view_list};
use crate::CaptureError;
use crate::files::folder::{EntryKind, Folder, extension};
use std::path::{Path, PathBuf};

/// Extensions of views.
const FORMS: [&str; 4] = ["png", "jpg", "jpeg", "webp"];
/// Words in the names of pictures that are not views.
const OTHERS: [&str; 8] = ["disp", "depth", "mask", "normal", "conf", "objectid", "thumb", "error"];
/// Names of folders of views.
const FOLDERS: [&str; 7] = ["lf", "views", "viewpoints", "sai", "images", "rectified", "light_field"];

/// The views of a folder: its own, else those of the subfolder with the most; and the other subfolders that have
/// views.
pub(crate) fn find_views(folder: &Folder) -> Result<Option<(Arrangement, Vec<PathBuf>)>, CaptureError> {
    let root = folder.shown.as_path();
    let grid = grid_of(folder, root);
    if let Some(arrangement) = views_in(folder, root, grid)? {
        return Ok(Some((arrangement, Vec::new())));
    }
    let mut candidates = Vec::new();
    /// A folder with more subfolders is not a light field.
    const MAX_FOLDERS: usize = 64;
    let inner =
        folder.entries(root).into_iter().filter(|(_, kind)| *kind == EntryKind::Folder).take(MAX_FOLDERS);
    for (place, _) in inner {
        let grid = grid_of(folder, &place).or(grid);
        if let Some(arrangement) = views_in(folder, &place, grid)? {
            let name = place.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
            let is_view_folder = FOLDERS.iter().any(|folder_name| name.starts_with(folder_name));
            candidates.push((arrangement.is_certain, is_view_folder, arrangement.views.len(), arrangement));
        }
    }
    // Of equals the first.
    candidates.reverse();
    let best =
        (0..candidates.len()).max_by_key(|at| (candidates[*at].0, candidates[*at].1, candidates[*at].2));
    Ok(best.map(|best| {
        let (.., arrangement) = candidates.swap_remove(best);
        let others =
            candidates.into_iter().filter(|(is_certain, ..)| *is_certain).map(|(.., other)| other.folder);
        (arrangement, others.collect())
    }))
}

/// Columns and rows from `parameters.cfg`, if there is one; errors in it are reported when it is read for its other
/// values.
fn grid_of(folder: &Folder, place: &Path) -> Option<[u32; 2]> {
    let file = place.join("parameters.cfg");
    folder.has_file(&file).then(|| read_parameters(&file).ok()).flatten()?.grid
}

/// The views in one folder.
fn views_in(
    folder: &Folder,
    place: &Path,
    grid: Option<[u32; 2]>,
) -> Result<Option<Arrangement>, CaptureError> {
    let list = place.join(NAME);
    if folder.has_file(&list) {
        return read_view_list(folder, &list).map(Some);
    }
    let is_view = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
        FORMS.contains(&extension(path).as_str()) && !OTHERS.iter().any(|other| name.contains(other))
    };
    let entries = folder.entries(place).into_iter();
    let files: Vec<PathBuf> = entries
        .filter(|(path, kind)| *kind == EntryKind::File && is_view(path))
        .map(|(path, _)| path)
        .collect();
    if let Some(arrangement) = arrange_by_positions(place, &files).or_else(|| arrange_hexagon(place, &files))
    {
        return Ok(Some(arrangement));
    }
    let numbered = arrange_numbered(place, &files, grid)?;
    Ok(numbered.or_else(|| arrange_by_row_column(place, &files)))
}
