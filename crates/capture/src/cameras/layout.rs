//! Where in a capture's folder the cameras lie.

use super::{bundler, colmap, metashape, nerfstudio, nvm};
use crate::cameras::shot::Shots;
use crate::files::folder::{EntryKind, Folder, extension};
use crate::{CameraFormat, CaptureError};
use std::io::Read;
use std::path::{Path, PathBuf};

/// Detects the format of a capture's cameras, if the folder is one: by the names of some files in it, and the first
/// lines of a few.
pub fn recognise(path: &Path) -> Option<CameraFormat> {
    let folder = Folder::open(path).ok()?;
    Cameras::find(&folder).first().map(Cameras::format)
}

/// The files that hold cameras.
#[derive(Clone, Debug)]
pub(crate) enum Cameras {
    Colmap(colmap::Model),
    Nerfstudio(PathBuf),
    Bundler { bundle: PathBuf, list: PathBuf },
    Nvm(PathBuf),
    Metashape(PathBuf),
}

/// Other places of COLMAP's models, likelier ones first.
const MODELS: [&str; 9] = [
    "sparse",
    "sparse_bin",
    "sparse_txt",
    "colmap/sparse",
    "colmap",
    "dense/sparse",
    "dense/0/sparse",
    "undistorted/sparse",
    "model",
];

impl Cameras {
    /// Finds the cameras of all programs in a folder, likelier ones first.
    pub fn find(folder: &Folder) -> Vec<Self> {
        let root = folder.shown.as_path();
        let mut cameras: Vec<Self> = models(folder).into_iter().map(Self::Colmap).collect();
        let names = ["transforms.json", "transforms_train.json"];
        let is_file = |path: &PathBuf| folder.has_file(path);
        cameras.extend(names.map(|name| root.join(name)).into_iter().find(is_file).map(Self::Nerfstudio));
        for place in ["", "bundle"] {
            let place = root.join(place);
            let bundle = ["bundle.out", "bundle.rd.out", "bundler.out"]
                .map(|name| place.join(name))
                .into_iter()
                .find(is_file);
            let lists = ["list.txt", "bundle.rd.out.list.txt", "bundle.out.list.txt", "bundle_list.txt"];
            let list = lists.iter().flat_map(|name| [place.join(name), root.join(name)]).find(is_file);
            cameras.extend(bundle.zip(list).map(|(bundle, list)| Self::Bundler { bundle, list }));
        }
        /// A folder has few files of these kinds; more are something else.
        const MAX_FILES: usize = 20;
        let files = |target_extension: &'static str| {
            let entries = folder.entries(root).into_iter();
            entries
                .filter(move |(path, kind)| *kind == EntryKind::File && extension(path) == target_extension)
                .take(MAX_FILES)
        };
        cameras.extend(
            files("nvm")
                .filter(|(path, _)| head(path).starts_with("NVM_V3"))
                .map(|(path, _)| Self::Nvm(path)),
        );
        let is_metashape = |path: &Path| {
            let head = head(path);
            head.contains("<document") && head.contains("<chunk")
        };
        cameras.extend(
            files("xml").filter(|(path, _)| is_metashape(path)).map(|(path, _)| Self::Metashape(path)),
        );
        cameras
    }

    /// The format that the cameras are stored in.
    pub fn format(&self) -> CameraFormat {
        match self {
            Self::Colmap(_) => CameraFormat::Colmap,
            Self::Nerfstudio(_) => CameraFormat::Nerfstudio,
            Self::Bundler { .. } => CameraFormat::Bundler,
            Self::Nvm(_) => CameraFormat::Nvm,
            Self::Metashape(_) => CameraFormat::Metashape,
        }
    }

    /// The file that names the pictures.
    pub fn file(&self) -> &Path {
        match self {
            Self::Colmap(model) => &model.images,
            Self::Nerfstudio(file) | Self::Nvm(file) | Self::Metashape(file) => file,
            Self::Bundler { bundle, .. } => bundle,
        }
    }

    /// Reads the cameras, in the form of their program.
    ///
    /// # Errors
    /// A file cannot be read or is malformed.
    pub fn read(&self) -> Result<Shots, CaptureError> {
        match self {
            Self::Colmap(model) => model.read(),
            Self::Nerfstudio(file) => nerfstudio::read(file),
            Self::Bundler { bundle, list } => bundler::read(bundle, list),
            Self::Nvm(file) => nvm::read(file),
            Self::Metashape(file) => metashape::read(file),
        }
    }
}

/// COLMAP's models: the one in the folder itself, then those in numbered folders, which are not connected, the one with the most pictures
/// first; then others.
fn models(folder: &Folder) -> Vec<colmap::Model> {
    let root = folder.shown.as_path();
    let mut numbered: Vec<colmap::Model> = Vec::new();
    for below in ["sparse", "colmap/sparse"] {
        let below = root.join(below);
        if folder.entry_kind(&below) != Some(EntryKind::Folder) {
            continue;
        }
        for (path, kind) in folder.entries(&below) {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            if kind == EntryKind::Folder && name.parse::<u32>().is_ok() {
                numbered.extend(colmap::Model::find(folder, &path));
            }
        }
    }
    let size = |model: &colmap::Model| std::fs::metadata(&model.images).map_or(0, |data| data.len());
    numbered.sort_by_key(|model| std::cmp::Reverse(size(model)));
    let mut models: Vec<colmap::Model> =
        colmap::Model::find(folder, root).into_iter().chain(numbered).collect();
    for place in MODELS {
        let model = colmap::Model::find(folder, &root.join(place));
        models.extend(model.filter(|model| models.iter().all(|other| other.images != model.images)));
    }
    models
}

/// The beginning of a text file.
fn head(path: &Path) -> String {
    const LENGTH: u64 = 2048;
    let mut bytes = Vec::new();
    let read = std::fs::File::open(path).and_then(|file| file.take(LENGTH).read_to_end(&mut bytes));
    read.map_or_else(|_| String::new(), |_| String::from_utf8_lossy(&bytes).into_owned())
}
