//! Focus maps of Gaussian splats as tables: `.ply` with t, anchor and gloss for each splat of the file.

use crate::error::DocumentError;
use atlas::Atlas;
use focus::FocusMap;
use gaussians::{GaussianError, read_focus_table, write_focus_table};
use lens::FocusOffset;
use progress::Progress;
use scene::{PlacedCloud, Scene};
use std::path::Path;

impl From<GaussianError> for DocumentError {
    fn from(error: GaussianError) -> Self {
        match error {
            GaussianError::Cancelled(cancelled) => cancelled.into(),
            other => Self::BadInput(other.to_string()),
        }
    }
}

/// Whether a focus map is to be a table, by its extension.
pub fn is_focus_table(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("ply"))
}

/// Writes the focus of each splat of a scene from a map over its atlas.
///
/// # Errors
/// The scene has no splats, or the file cannot be written.
pub fn write_splat_focus(
    path: &Path,
    scene: &Scene,
    atlas: &Atlas,
    map: &FocusMap,
) -> Result<(), DocumentError> {
    let splats = splats_of(path, scene)?;
    let texel = |splat: u32| texel_of(splats, atlas, splat);
    let focus: Vec<FocusOffset> =
        (0..splats.cloud.len() as u32).map(texel).map(|[x, y]| map.at(x, y)).collect();
    let mut bytes = Vec::new();
    let written = write_focus_table(&mut bytes, &splats.cloud, &focus);
    let written = written.and_then(|()| atomic_file::write(path, &bytes));
    written.map_err(|error| DocumentError::io(path, &error))
}

/// Reads the focus of each splat of a scene from a table; the rest of the map is the ordinary lens.
///
/// # Errors
/// The scene has no splats, the table cannot be read or is of other splats, or `progress` cancels.
pub(crate) fn read_splat_focus(
    path: &Path,
    scene: &Scene,
    atlas: &Atlas,
    progress: &dyn Progress,
) -> Result<FocusMap, DocumentError> {
    let splats = splats_of(path, scene)?;
    let focus = read_focus_table(path, &splats.cloud, progress)?;
    let mut map = FocusMap::new(atlas.width, atlas.height, FocusOffset::STANDARD);
    for (splat, FocusOffset { t, anchor, gloss }) in (0..).zip(focus) {
        let [x, y] = texel_of(splats, atlas, splat);
        map.set(x, y, [t as f32, anchor as f32]);
        map.set_gloss(x, y, gloss as f32);
    }
    Ok(map)
}

fn splats_of<'a>(path: &Path, scene: &'a Scene) -> Result<&'a PlacedCloud, DocumentError> {
    let none = || {
        let what = "is a table for Gaussian splats, but the scene has none (use an .exr or .png focus map)";
        DocumentError::bad_file(path, what)
    };
    scene.splats.as_deref().ok_or_else(none)
}

/// Column and row of the texel of a splat.
fn texel_of(splats: &PlacedCloud, atlas: &Atlas, splat: u32) -> [u32; 2] {
    let position = atlas.position_of(splats.address(splat));
    [position.x as u32, position.y as u32]
}
