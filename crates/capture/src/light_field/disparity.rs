//! The disparity map in the folder of the views.

use super::attributes::read_attributes;
use super::optics::Optics;
use crate::CaptureError;
use crate::depth_map::{DepthMap, DepthMeaning, DepthQuantity, NearEnd, is_coded_by_color, read_depth_map};
use crate::files::folder::{EntryKind, Folder, extension};
use scene::LoadOptions;
use std::path::{Path, PathBuf};

/// Where to search for disparities, and for which pictures.
pub(super) struct DisparitySearch<'a> {
    pub folder: &'a Folder,
    /// The folder of the views, and the one above.
    pub places: &'a [&'a Path],
    pub size: [u32; 2],
    pub optics: &'a Optics,
    pub near: Option<NearEnd>,
    pub load: &'a LoadOptions,
}

/// The disparities of a light field.
pub(super) enum DisparitySource {
    /// The map, and its file.
    Map(DepthMap, PathBuf),
    /// A file whose colours are a code.
    Coded(PathBuf),
}

impl DisparitySource {
    /// Reads a file that is given as disparities; `near` says which end of its numbers is near. A map coded by
    /// colours is decoded later.
    ///
    /// # Errors
    /// The file cannot be read or decoded, or which end is near is not known.
    pub fn from_file(file: &Path, near: Option<NearEnd>, load: &LoadOptions) -> Result<Self, CaptureError> {
        if is_coded_by_color(file, load) {
            return Ok(Self::Coded(file.into()));
        }
        Ok(Self::Map(read_depth_map(file, Some(DepthQuantity::Disparity), near, load)?, file.into()))
    }
}

/// Finds the disparity map of these places and its file, if there is one: `depth.bin` with `attributes.dat`; a file named after disparity as
/// PFM, EXR or picture; distances with parameters that convert them to disparities.
pub(super) fn find_disparity(search: &DisparitySearch<'_>) -> Result<Option<DisparitySource>, CaptureError> {
    let inside = |path: &PathBuf| search.folder.has_file(path);
    for place in search.places {
        let [attributes, depth] = ["attributes.dat", "depth.bin"].map(|name| place.join(name));
        if inside(&attributes) && inside(&depth) {
            let map = read_attributes(&attributes)?.disparity(&depth, search.size, search.load)?;
            return Ok(Some(DisparitySource::Map(map, depth)));
        }
    }
    if let Some(file) = named(search, "disp") {
        return DisparitySource::from_file(&file, search.near, search.load).map(Some);
    }
    let Some(file) = named(search, "depth").filter(|file| ["pfm", "exr"].contains(&extension(file).as_str()))
    else {
        return Ok(None);
    };
    let longer_side = search.size[0].max(search.size[1]);
    if search.optics.disparity(1.0, longer_side).is_none() {
        return Ok(None);
    }
    let mut map = read_depth_map(&file, Some(DepthQuantity::Depth), None, search.load)?;
    map.meaning = DepthMeaning::Disparity;
    for value in &mut map.values {
        let disparity = search.optics.disparity(f64::from(*value), longer_side).map(|value| value as f32);
        *value = disparity.filter(|value| value.is_finite()).unwrap_or(f32::NAN);
    }
    if map.range().is_none() {
        let what = "parameters.cfg makes no finite disparity of any distance";
        return Err(CaptureError::malformed(&file, "all pixels", what));
    }
    Ok(Some(DisparitySource::Map(map, file)))
}

/// The likeliest file whose name contains this word: floats before levels, of the size of the views before finer
/// ones.
fn named(search: &DisparitySearch<'_>, word: &str) -> Option<PathBuf> {
    const FORMS: [&str; 6] = ["pfm", "exr", "png", "webp", "jpg", "jpeg"];
    let rank = |file: &Path| {
        let name = file.file_name()?.to_string_lossy().to_lowercase();
        let form = FORMS.iter().position(|form| *form == extension(file))?;
        let is_other = name.contains("highres") || name.contains("conf") || name.contains("error");
        name.contains(word).then_some((is_other, form))
    };
    let files = search.places.iter().flat_map(|place| search.folder.entries(place));
    let files =
        files.filter(|(_, kind)| *kind == EntryKind::File).filter_map(|(file, _)| Some((rank(&file)?, file)));
    files.min().map(|(_, file)| file)
}
