//! The folders of a capture's pictures and masks.

use crate::CaptureError;
use crate::cameras::shot::Shot;
use crate::files::folder::{EntryKind, Folder, extension};
use crate::pictures::picture_names::{EXTENSIONS, PictureFiles};
use std::path::{Path, PathBuf};

/// Names of folders of pictures, likelier ones first; also `images_2` and the like.
const PICTURE_FOLDERS: [&str; 8] =
    ["images", "image", "imgs", "photos", "photographs", "pictures", "input", "rgb"];
/// Names of folders of masks.
const MASK_FOLDERS: [&str; 2] = ["masks", "mask"];
/// Folders whose pictures are not photographs.
const OTHER_FOLDERS: [&str; 9] =
    ["masks", "mask", "depth", "depths", "depth_maps", "normals", "normal_maps", "stereo", "thumbnails"];

/// How deep pictures lie in subfolders, and the most that are considered.
const MAX_DEPTH: usize = 8;
const MAX_FILES: usize = 100_000;

/// Where to search.
#[derive(Clone, Copy)]
pub(crate) struct PictureSearch<'a> {
    /// The capture's folder.
    pub folder: &'a Folder,
    /// The file with the cameras.
    pub cameras: &'a Path,
    /// The folder of the pictures, if the caller specifies it.
    pub pictures: Option<&'a Path>,
}

/// A folder of pictures, and which of them match some names.
pub(crate) struct PictureFolder {
    pub base: PathBuf,
    /// Whether its name is that of a folder of pictures.
    is_named: bool,
    /// Relative to `base`, with `/`.
    paths: Vec<String>,
    /// For each name the index of its path.
    files: Vec<Option<usize>>,
}

impl PictureFolder {
    /// Finds the folder with the most pictures of these names.
    ///
    /// # Errors
    /// A folder cannot be read, or the pictures lie outside the capture's folder.
    pub fn find(source: &PictureSearch<'_>, names: &[String]) -> Result<Self, CaptureError> {
        let PictureSearch { folder, cameras, pictures } = *source;
        if let Some(pictures) = pictures {
            return Ok(Self::new(&Folder::open(pictures)?, pictures.into(), true, names));
        }
        let above = || cameras.ancestors().skip(1).take_while(|place| place.starts_with(&folder.shown));
        let (mut bases, mut outside) = (Vec::new(), None);
        for (path, kind) in above().flat_map(|place| picture_folders(folder, place)) {
            match kind {
                EntryKind::Folder => bases.push((path, true)),
                EntryKind::Outside => drop(outside.get_or_insert(path)),
                EntryKind::File => {}
            }
        }
        bases.extend(above().map(|place| (place.to_path_buf(), false)));
        let mut best = Self {
            base: folder.shown.clone(),
            is_named: false,
            paths: Vec::new(),
            files: vec![None; names.len()],
        };
        for (base, is_named) in bases {
            let place = Self::new(folder, base, is_named, names);
            if place.hits() > best.hits() {
                best = place;
            }
            if best.hits() == names.len() {
                break;
            }
        }
        match outside {
            Some(file) if best.hits() == 0 => {
                Err(CaptureError::Outside { file, cure: "copy the pictures there, or name their folder" })
            }
            _ => Ok(best),
        }
    }

    fn new(folder: &Folder, base: PathBuf, is_named: bool, names: &[String]) -> Self {
        let paths = list_pictures(folder, &base, &OTHER_FOLDERS);
        let files = PictureFiles::new(paths.clone()).resolve(names);
        Self { base, is_named, paths, files }
    }

    fn hits(&self) -> usize {
        self.files.iter().flatten().count()
    }

    /// The path, relative to the folder, of the picture for the name with this index; `None` if there is none.
    pub fn path(&self, name: usize) -> Option<&str> {
        self.files[name].map(|file| self.paths[file].as_str())
    }

    /// The paths, relative to the folder, of pictures that match no name.
    pub fn unused(&self) -> Vec<String> {
        let mut is_used = vec![false; self.paths.len()];
        self.files.iter().flatten().for_each(|&file| is_used[file] = true);
        let unused = self.paths.iter().zip(is_used).filter(|(_, is_used)| !is_used && self.is_named);
        unused.map(|(path, _)| path.clone()).collect()
    }
}

/// The folders of pictures in a folder, likelier ones first.
fn picture_folders(folder: &Folder, place: &Path) -> Vec<(PathBuf, EntryKind)> {
    let rank = |path: &Path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
        let index = PICTURE_FOLDERS.iter().position(|folder_name| *folder_name == name);
        index.or(name.starts_with("images_").then_some(PICTURE_FOLDERS.len()))
    };
    let entries = folder.entries(place).into_iter();
    let mut ranked: Vec<_> = entries.filter_map(|(path, kind)| Some((rank(&path)?, path, kind))).collect();
    ranked.sort_by_key(|(rank, ..)| *rank);
    ranked.into_iter().map(|(_, path, kind)| (path, kind)).collect()
}

/// For each shot its mask, if it has one: the one that the file names, or one next to the pictures, called `NAME.png` as in COLMAP, or like
/// the picture.
pub(crate) fn masks(
    source: &PictureSearch<'_>,
    place: &PictureFolder,
    shots: &[Shot],
) -> Vec<Option<PathBuf>> {
    let PictureSearch { folder, cameras, .. } = *source;
    let mut masks = vec![None; shots.len()];
    let mut resolve = |base: &Path, names: Vec<(usize, String)>| {
        let (indices, names): (Vec<usize>, Vec<String>) = names.into_iter().unzip();
        if names.is_empty() || folder.entry_kind(base) != Some(EntryKind::Folder) {
            return;
        }
        let paths = list_pictures(folder, base, &[]);
        for (index, file) in indices.into_iter().zip(PictureFiles::new(paths.clone()).resolve(&names)) {
            if let (None, Some(file)) = (&masks[index], file) {
                masks[index] = Some(base.join(&paths[file]));
            }
        }
    };
    let named_masks =
        shots.iter().enumerate().filter_map(|(index, shot)| Some((index, shot.mask.clone()?))).collect();
    resolve(cameras.parent().unwrap_or(&folder.shown), named_masks);
    let parents = place.base.parent().into_iter().chain([place.base.as_path()]);
    for base in parents.flat_map(|place| MASK_FOLDERS.map(|name| place.join(name))) {
        for ending in [".png", ""] {
            let names = place.files.iter().enumerate();
            let names =
                names.filter_map(|(index, file)| Some((index, format!("{}{ending}", place.paths[(*file)?]))));
            resolve(&base, names.collect());
        }
    }
    masks
}

/// The paths of the pictures in a folder, relative to it, with `/`; folders in `without` are left out.
fn list_pictures(folder: &Folder, base: &Path, without: &[&str]) -> Vec<String> {
    let relative = |path: &PathBuf| -> Option<String> {
        let path = path.strip_prefix(base).ok()?;
        let parts: Vec<_> = path.iter().map(|part| part.to_string_lossy()).collect();
        let (_, folders) = parts.split_last()?;
        let is_other = folders.iter().any(|name| without.contains(&name.to_lowercase().as_str()));
        (!is_other && EXTENSIONS.contains(&extension(path).as_str())).then(|| parts.join("/"))
    };
    folder.files(base, MAX_DEPTH, MAX_FILES).iter().filter_map(relative).collect()
}
