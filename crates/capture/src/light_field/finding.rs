//! Where in a folder the views are, and whose names they have.

use super::arrangement::Arrangement;
use super::hexagon::hexagon;
use super::optics::read_parameters;
use super::row_column::{numbered, positions, row_column};
use super::view_list::{NAME, read_view_list};
use crate::CaptureError;
use crate::folder::{Folder, Found, extension};
use std::path::{Path, PathBuf};

/// How views' files end.
const FORMS: [&str; 4] = ["png", "jpg", "jpeg", "webp"];
/// Words in the names of pictures that are no views.
const OTHERS: [&str; 8] = ["disp", "depth", "mask", "normal", "conf", "objectid", "thumb", "error"];
/// What folders of views are called.
const FOLDERS: [&str; 7] = ["lf", "views", "viewpoints", "sai", "images", "rectified", "light_field"];

/// The views of a folder: its own, else those of a folder in it, the most; and the other folders that have views.
pub(crate) fn find_views(folder: &Folder) -> Result<Option<(Arrangement, Vec<PathBuf>)>, CaptureError> {
    let root = folder.shown.as_path();
    let grid = grid_of(folder, root);
    if let Some(found) = views_in(folder, root, grid)? {
        return Ok(Some((found, Vec::new())));
    }
    let mut found = Vec::new();
    /// A folder of more folders is none of a light field.
    const MOST: usize = 64;
    let inner = folder.entries(root).into_iter().filter(|(_, found)| *found == Found::Folder).take(MOST);
    for (place, _) in inner {
        let grid = grid_of(folder, &place).or(grid);
        if let Some(arrangement) = views_in(folder, &place, grid)? {
            let name = place.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
            let is_known = FOLDERS.iter().any(|known| name.starts_with(known));
            found.push((arrangement.is_certain, is_known, arrangement.views.len(), arrangement));
        }
    }
    // Of equals the first.
    found.reverse();
    let best = (0..found.len()).max_by_key(|at| (found[*at].0, found[*at].1, found[*at].2));
    Ok(best.map(|best| {
        let (.., arrangement) = found.swap_remove(best);
        let others = found.into_iter().filter(|(is_certain, ..)| *is_certain).map(|(.., other)| other.folder);
        (arrangement, others.collect())
    }))
}

/// Columns and rows, where `parameters.cfg` says them; what is wrong with it is told when it is read for all it says.
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
        .filter(|(path, found)| *found == Found::File && is_view(path))
        .map(|(path, _)| path)
        .collect();
    let found = positions(place, &files)
        .or_else(|| hexagon(place, &files))
        .or_else(|| numbered(place, &files, grid))
        .or_else(|| row_column(place, &files));
    Ok(found)
}
