//! The disparity map that lies with the views.

use super::attributes::read_attributes;
use super::optics::Optics;
use crate::CaptureError;
use crate::depth_map::{DepthAs, DepthMap, DepthMeaning, NearEnd, is_coded_by_color, read_depth_map};
use crate::folder::{Folder, Found, extension};
use scene::LoadOptions;
use std::path::{Path, PathBuf};

/// Where disparities are looked for, and for which pictures.
pub(super) struct Wanted<'a> {
    pub folder: &'a Folder,
    /// Where the views lie, and what is above.
    pub places: &'a [&'a Path],
    pub size: [u32; 2],
    pub optics: &'a Optics,
    pub near: Option<NearEnd>,
    pub load: &'a LoadOptions,
}

/// A disparity map that was found.
pub(super) enum FoundDisparity {
    /// Its numbers, and its file.
    Map(DepthMap, PathBuf),
    /// A file whose colours are a code.
    Coded(PathBuf),
}

impl FoundDisparity {
    /// What a file holds that is given as disparities.
    pub fn of(file: &Path, near: Option<NearEnd>, load: &LoadOptions) -> Result<Self, CaptureError> {
        if is_coded_by_color(file, load) {
            return Ok(Self::Coded(file.into()));
        }
        Ok(Self::Map(read_depth_map(file, Some(DepthAs::Disparity), near, load)?, file.into()))
    }
}

/// The disparity map of these places and its file, if there is one: `depth.bin` with `attributes.dat`; a file called after disparity as PFM, EXR or
/// picture; distances with parameters that turn them into disparities.
pub(super) fn find_disparity(wanted: &Wanted<'_>) -> Result<Option<FoundDisparity>, CaptureError> {
    let inside = |path: &PathBuf| wanted.folder.has_file(path);
    for place in wanted.places {
        let [attributes, depth] = ["attributes.dat", "depth.bin"].map(|name| place.join(name));
        if inside(&attributes) && inside(&depth) {
            let map = read_attributes(&attributes)?.disparity(&depth, wanted.size, wanted.load)?;
            return Ok(Some(FoundDisparity::Map(map, depth)));
        }
    }
    if let Some(file) = named(wanted, "disp") {
        return FoundDisparity::of(&file, wanted.near, wanted.load).map(Some);
    }
    let Some(file) = named(wanted, "depth").filter(|file| ["pfm", "exr"].contains(&extension(file).as_str()))
    else {
        return Ok(None);
    };
    let longer_side = wanted.size[0].max(wanted.size[1]);
    if wanted.optics.disparity(1.0, longer_side).is_none() {
        return Ok(None);
    }
    let mut map = read_depth_map(&file, Some(DepthAs::Depth), None, wanted.load)?;
    map.meaning = DepthMeaning::Disparity;
    for value in &mut map.values {
        let disparity = wanted.optics.disparity(f64::from(*value), longer_side).map(|value| value as f32);
        *value = disparity.filter(|value| value.is_finite()).unwrap_or(f32::NAN);
    }
    if map.range().is_none() {
        let what = "parameters.cfg makes no finite disparity of any distance";
        return Err(CaptureError::malformed(&file, "all pixels", what));
    }
    Ok(Some(FoundDisparity::Map(map, file)))
}

/// The likeliest file whose name has this word: floats before levels, of the size of the views before finer ones.
fn named(wanted: &Wanted<'_>, word: &str) -> Option<PathBuf> {
    const FORMS: [&str; 6] = ["pfm", "exr", "png", "webp", "jpg", "jpeg"];
    let rank = |file: &Path| {
        let name = file.file_name()?.to_string_lossy().to_lowercase();
        let form = FORMS.iter().position(|form| *form == extension(file))?;
        let is_other = name.contains("highres") || name.contains("conf") || name.contains("error");
        name.contains(word).then_some((is_other, form))
    };
    let files = wanted.places.iter().flat_map(|place| wanted.folder.entries(place));
    let files =
        files.filter(|(_, found)| *found == Found::File).filter_map(|(file, _)| Some((rank(&file)?, file)));
    files.min().map(|(_, file)| file)
}
