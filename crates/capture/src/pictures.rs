//! From what a program says of photographs to views: their files, looked for where captures have them, and what those say of themselves.
//!
//! A picture is turned by what its EXIF data say only if its camera's width and height are then those of the picture, and are not as it
//! is stored: programs differ in whether they look at turned pictures, and the cameras tell.

use crate::exif::Exif;
use crate::folder::{Folder, Found, extension};
use crate::picture_names::{EXTENSIONS, PictureFiles};
use crate::shot::{Shot, Shots};
use crate::{CaptureError, Remark};
use image::{ImageDecoder, ImageReader};
use lens::CalibratedLens;
use progress::Progress;
use scene::View;
use std::fs::File;
use std::io::{Cursor, Read};
use std::path::{Path, PathBuf};

/// What folders of pictures are called, likelier ones first; also `images_2` and the like.
const PICTURE_FOLDERS: [&str; 8] =
    ["images", "image", "imgs", "photos", "photographs", "pictures", "input", "rgb"];
/// What folders of masks are called.
const MASK_FOLDERS: [&str; 2] = ["masks", "mask"];
/// Folders whose pictures are no photographs.
const OTHER_FOLDERS: [&str; 9] =
    ["masks", "mask", "depth", "depths", "depth_maps", "normals", "normal_maps", "stereo", "thumbnails"];

/// How deep pictures lie in subfolders, and how many are looked at.
const DEEPEST: usize = 8;
const MOST: usize = 100_000;

/// The views of `shots`, by name, told of in `cameras`; remarks on what is incomplete. `given`: where the pictures are, wherever that is.
pub(crate) fn views(
    folder: &Folder,
    cameras: &Path,
    shots: Shots,
    given: Option<&Path>,
    progress: &dyn Progress,
    remarks: &mut Vec<Remark>,
) -> Result<Vec<View>, CaptureError> {
    let file = cameras.display();
    let Shots { shots, notes, without_camera } = shots;
    remarks.extend(notes.into_iter().map(|note| Remark::note(format!("{file}: {note}"))));
    remarks.extend(Remark::about(without_camera, false, |names| {
        format!("{file}: no camera was found for {names} (they are left out)")
    }));
    let names: Vec<String> = shots.iter().map(|shot| shot.name.clone()).collect();
    let place = place(folder, cameras, given, &names)?;
    let masks = masks(folder, cameras, &place, &shots);

    let (mut views, mut wrong, mut turned, mut resized) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut first_wrong = None;
    for (index, shot) in shots.iter().enumerate() {
        progress.check()?;
        progress.report(index as f32 / shots.len() as f32);
        let Some(name) = place.name(index) else { continue };
        match view(shot, name, place.base.join(name), masks[index].clone()) {
            Ok(view) => {
                if view.orientation != 1 {
                    turned.push(shot.name.clone());
                }
                if matches!(shot.lens.for_size(view.lens.size_px()), Ok(lens) if lens.size_px() != view.lens.size_px())
                {
                    resized.push(shot.name.clone());
                }
                views.push(view);
            }
            Err(what) => {
                let what = format!("{} ({}): {what}", shot.name, shot.place);
                first_wrong.get_or_insert_with(|| what.clone());
                wrong.push(what);
            }
        }
    }
    let missing: Vec<String> = (0..shots.len())
        .filter(|&index| place.files[index].is_none())
        .map(|index| names[index].clone())
        .collect();
    if views.is_empty() {
        let why = first_wrong.unwrap_or_else(|| match missing.first() {
            Some(name) => format!("{} is not in {}", crate::text::quoted(name), place.base.display()),
            None => "the file has no picture".into(),
        });
        return Err(CaptureError::NoPictures { file: cameras.into(), cameras: shots.len(), why });
    }
    let (count, all) = (missing.len(), shots.len());
    remarks.extend(Remark::about(missing, true, |names| {
        format!(
            "{file}: {count} of {all} pictures are missing: {names} (put them into {})",
            place.base.display()
        )
    }));
    remarks
        .extend(Remark::about(wrong, true, |names| format!("{file}: pictures that cannot be used: {names}")));
    remarks.extend(Remark::about(turned, false, |names| {
        format!("{file}: turned as their EXIF data say, for their cameras have width and height the other way round: {names}")
    }));
    remarks.extend(Remark::about(resized, false, |names| {
        format!("{file}: not of their cameras' size, which is scaled to theirs: {names}")
    }));
    remarks.extend(Remark::about(place.unused(), false, |names| {
        format!("{}: pictures without a camera: {names} (they are left out)", place.base.display())
    }));
    views.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(views)
}

/// A folder of pictures, and which of them are those of some names.
struct Place {
    base: PathBuf,
    /// Whether it is a folder of pictures and of nothing else.
    is_named: bool,
    paths: Vec<String>,
    /// Indices of `paths`.
    files: Vec<Option<usize>>,
}

impl Place {
    fn of(folder: &Folder, base: PathBuf, is_named: bool, names: &[String]) -> Self {
        let paths = listed(folder, &base, &OTHER_FOLDERS);
        let files = PictureFiles::new(paths.clone()).resolve(names);
        Self { base, is_named, paths, files }
    }

    fn hits(&self) -> usize {
        self.files.iter().flatten().count()
    }

    /// The path of a shot's picture.
    fn name(&self, index: usize) -> Option<&str> {
        self.files[index].map(|file| self.paths[file].as_str())
    }

    /// Pictures that nobody asked for.
    fn unused(&self) -> Vec<String> {
        let mut is_used = vec![false; self.paths.len()];
        self.files.iter().flatten().for_each(|&file| is_used[file] = true);
        let unused = self.paths.iter().zip(is_used).filter(|(_, is_used)| !is_used && self.is_named);
        unused.map(|(path, _)| path.clone()).collect()
    }
}

/// The folder where most pictures of these names are.
fn place(
    folder: &Folder,
    cameras: &Path,
    given: Option<&Path>,
    names: &[String],
) -> Result<Place, CaptureError> {
    if let Some(given) = given {
        return Ok(Place::of(&Folder::open(given)?, given.into(), true, names));
    }
    let ancestors: Vec<&Path> =
        cameras.ancestors().skip(1).take_while(|place| place.starts_with(&folder.shown)).collect();
    let mut outside = None;
    let mut bases = Vec::new();
    for place in &ancestors {
        let entries = folder.entries(place);
        let called = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
        let ranked = PICTURE_FOLDERS
            .iter()
            .flat_map(|name| entries.iter().filter(move |(path, _)| called(path) == **name));
        let scaled = entries.iter().filter(|(path, _)| called(path).starts_with("images_"));
        for (path, found) in ranked.chain(scaled) {
            match found {
                Found::Folder => bases.push((path.clone(), true)),
                Found::Outside => drop(outside.get_or_insert(path.clone())),
                Found::File => {}
            }
        }
    }
    bases.extend(ancestors.iter().map(|place| (place.to_path_buf(), false)));
    let mut best: Option<Place> = None;
    for (base, is_named) in bases {
        let place = Place::of(folder, base, is_named, names);
        if best.as_ref().is_none_or(|best| place.hits() > best.hits()) {
            best = Some(place);
        }
        if best.as_ref().is_some_and(|best| best.hits() == names.len()) {
            break;
        }
    }
    match (best, outside) {
        (best, Some(file)) if best.as_ref().is_none_or(|best| best.hits() == 0) => {
            Err(CaptureError::Outside { file, cure: "copy the pictures there, or name their folder" })
        }
        (Some(best), _) => Ok(best),
        (None, _) => Err(CaptureError::NoCameras { folder: folder.shown.clone() }),
    }
}

/// For each shot its mask, if it has one: what the file says, or what lies beside the pictures, called `NAME.png` as COLMAP has it,
/// or like the picture.
fn masks(folder: &Folder, cameras: &Path, place: &Place, shots: &[Shot]) -> Vec<Option<PathBuf>> {
    let mut masks = vec![None; shots.len()];
    let mut resolve = |base: &Path, names: Vec<(usize, String)>| {
        let (indices, names): (Vec<usize>, Vec<String>) = names.into_iter().unzip();
        if names.is_empty() || folder.find(base) != Some(Found::Folder) {
            return;
        }
        let paths = listed(folder, base, &[]);
        for (index, file) in indices.into_iter().zip(PictureFiles::new(paths.clone()).resolve(&names)) {
            if let (None, Some(file)) = (&masks[index], file) {
                masks[index] = Some(base.join(&paths[file]));
            }
        }
    };
    let said =
        shots.iter().enumerate().filter_map(|(index, shot)| Some((index, shot.mask.clone()?))).collect();
    resolve(cameras.parent().unwrap_or(&folder.shown), said);
    let beside = place.base.parent().into_iter().chain([place.base.as_path()]);
    for base in beside.flat_map(|place| MASK_FOLDERS.map(|name| place.join(name))) {
        for ending in [".png", ""] {
            let names = place.files.iter().enumerate();
            let names =
                names.filter_map(|(index, file)| Some((index, format!("{}{ending}", place.paths[(*file)?]))));
            resolve(&base, names.collect());
        }
    }
    masks
}

/// The paths of the pictures in a folder, relative to it, with `/`; of subfolders but for some.
fn listed(folder: &Folder, base: &Path, without: &[&str]) -> Vec<String> {
    let relative = |path: &PathBuf| -> Option<String> {
        let path = path.strip_prefix(base).ok()?;
        let parts: Vec<_> = path.iter().map(|part| part.to_string_lossy()).collect();
        let (_, folders) = parts.split_last()?;
        let is_other = folders.iter().any(|name| without.contains(&name.to_lowercase().as_str()));
        (!is_other && EXTENSIONS.contains(&extension(path).as_str())).then(|| parts.join("/"))
    };
    folder.files(base, DEEPEST, MOST).iter().filter_map(relative).collect()
}

/// The view of a shot whose picture is this file, called `name`.
fn view(shot: &Shot, name: &str, picture: PathBuf, mask: Option<PathBuf>) -> Result<View, String> {
    let (size, exif) = header(&picture)?;
    let lens = shot.lens.for_size(size).map_err(|error| error.to_string())?;
    let (lens, orientation) = fitted(lens, size, exif.orientation)?;
    Ok(View {
        name: name.into(),
        picture,
        orientation,
        exif_orientation: exif.orientation,
        lens,
        camera_to_world: shot.camera_to_world,
        mask,
        exposure_hint: exif.exposure,
    })
}

/// The lens scaled to a picture that is stored in this size, and how the picture is to be turned for it.
fn fitted(
    lens: CalibratedLens,
    stored: [u32; 2],
    exif_orientation: u8,
) -> Result<(CalibratedLens, u8), String> {
    let wanted = lens.size_px();
    let [width, height] = stored;
    let turned = [height, width];
    // From 5 on width and height change places.
    let may_turn = exif_orientation >= 5;
    let resized = |size| lens.resized(size).map_err(|error| error.to_string());
    match () {
        () if stored == wanted => Ok((lens, 1)),
        () if turned == wanted && may_turn => Ok((lens, exif_orientation)),
        () if is_scaled(stored, wanted) => Ok((resized(stored)?, 1)),
        () if is_scaled(turned, wanted) && may_turn => Ok((resized(turned)?, exif_orientation)),
        () => Err(format!("it is {width} × {height} px, its camera is for {} × {} px", wanted[0], wanted[1])),
    }
}

/// Whether a size is another one scaled, up to a pixel of rounding.
fn is_scaled(size: [u32; 2], of: [u32; 2]) -> bool {
    let [width, height, of_width, of_height] = [size[0], size[1], of[0], of[1]].map(f64::from);
    // A pixel more or less on either side.
    (width * of_height - height * of_width).abs() <= of_width.max(of_height).max(width).max(height)
}

/// The size of a picture as it is stored, and its EXIF data.
fn header(file: &Path) -> Result<([u32; 2], Exif), String> {
    /// Enough for the EXIF data with their small picture and for profiles; what has more is read whole.
    const HEAD: u64 = 256 << 10;
    let mut bytes = Vec::new();
    let unreadable = |error: std::io::Error| format!("cannot be read: {error}");
    let mut input = File::open(file).map_err(unreadable)?;
    (&mut input).take(HEAD).read_to_end(&mut bytes).map_err(unreadable)?;
    if let Ok(header) = header_of(&bytes) {
        return Ok(header);
    }
    /// No picture within the limits of reading is larger.
    const WHOLE: u64 = 512 << 20;
    input.take(WHOLE).read_to_end(&mut bytes).map_err(unreadable)?;
    header_of(&bytes).map_err(|error| format!("cannot be decoded: {error}").replace('\n', " "))
}

fn header_of(bytes: &[u8]) -> Result<([u32; 2], Exif), image::ImageError> {
    let reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format()?;
    let mut decoder = reader.into_decoder()?;
    let (width, height) = decoder.dimensions();
    let exif = decoder.exif_metadata().ok().flatten();
    Ok(([width, height], exif.map_or_else(Exif::default, |data| Exif::of(&data))))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lens() -> CalibratedLens {
        CalibratedLens::pinhole([600, 400], 500.0).unwrap()
    }

    #[test]
    fn pictures_are_turned_only_where_the_camera_says_so() {
        let orientation = |stored, exif| fitted(lens(), stored, exif).map(|(_, orientation)| orientation);
        // As it is stored, whatever the EXIF data say: COLMAP since 3.7.
        assert_eq!(orientation([600, 400], 6), Ok(1));
        assert_eq!(orientation([600, 400], 3), Ok(1));
        // The camera is that of the turned picture.
        assert_eq!(orientation([400, 600], 6), Ok(6));
        assert_eq!(orientation([400, 600], 8), Ok(8));
        // Nothing says which way.
        let error = orientation([400, 600], 1).unwrap_err();
        assert_eq!(error, "it is 400 × 600 px, its camera is for 600 × 400 px");
    }

    #[test]
    fn lenses_follow_pictures_that_were_made_smaller() {
        let focal =
            |stored, exif| fitted(lens(), stored, exif).map(|(lens, _)| lens.intrinsics().focal_px[0]);
        assert_eq!(focal([300, 200], 1), Ok(250.0));
        assert_eq!(focal([200, 300], 6), Ok(250.0));
        // 1/7 is 85.7 × 57.1.
        assert!(focal([86, 57], 1).is_ok() && focal([85, 57], 1).is_ok());
        assert!(focal([300, 220], 1).is_err());
    }
}
