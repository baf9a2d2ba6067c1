//! Detection of the kind of capture that a path is.

use crate::CaptureError;
use crate::cameras::layout;
use crate::depth_picture::{InFolder, has_depth, in_folder};
use crate::files::folder::{EntryKind, Folder, extension};
use crate::files::picture_header::read_header;
use crate::light_field::find_views;
use crate::mosaic::detect_pitch;
use crate::pictures::picture_names::EXTENSIONS;
use crate::unsupported_format::unsupported_format_error;
use scene::LoadOptions;
use std::path::Path;

/// The kinds of captures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CaptureKind {
    /// Photographs with cameras, and a mesh: [`crate::open`].
    Photographs,
    /// Views of one place from points of an aperture: [`crate::open_light_field`].
    LightField,
    /// A picture and its depth: [`crate::open_depth_picture`].
    Depth,
}

impl CaptureKind {
    /// All kinds, with the names by which they are selected.
    pub const ALL: [(&str, Self); 3] =
        [("photographs", Self::Photographs), ("lightfield", Self::LightField), ("depth", Self::Depth)];

    /// The kind with this name in files and on the command line; `None` if there is none.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(candidate, _)| *candidate == name).map(|(_, kind)| *kind)
    }
}

/// Whether a file's extension is that of a picture, or of a container of pictures: one for which
/// [`detect_capture_kind`] has an answer.
pub fn may_be_picture(path: &Path) -> bool {
    const OTHERS: [&str; 5] = ["heif", "avif", "lfp", "lfr", "lfx"];
    let extension = extension(path);
    EXTENSIONS.contains(&extension.as_str()) || OTHERS.contains(&extension.as_str())
}

/// Detects the kind of capture that a folder or file is.
///
/// A folder is searched for cameras of photographs first, then for views, then for a picture with depth; a picture for depth in it or
/// next to it, then for the period of micro-images. That is quick, except for pictures with neither, whose pixels are analysed.
///
/// # Errors
/// [`CaptureError::NoCapture`] if it is none, with the kinds of input that can be opened. [`CaptureError::UnsupportedFormat`] for files that
/// another program has to export first.
pub fn detect_capture_kind(path: &Path) -> Result<CaptureKind, CaptureError> {
    let options = LoadOptions::default();
    let none = |detail: &str| Err(CaptureError::NoCapture { path: path.into(), detail: detail.into() });
    if !path.is_dir() {
        if let Some(error) = unsupported_format_error(path) {
            return Err(error);
        }
        if has_depth(path, &options) {
            return Ok(CaptureKind::Depth);
        }
        if extension(path) == "exr" {
            return none(": an EXR without a depth channel");
        }
        if let Err(why) = read_header(path) {
            return Err(match std::fs::metadata(path) {
                Err(source) => CaptureError::unreadable(path, source),
                Ok(_) => CaptureError::malformed(path, "picture", why),
            });
        }
        return match detect_pitch(path, &options) {
            Some(_) => Ok(CaptureKind::LightField),
            None => none(": a picture alone"),
        };
    }
    if layout::recognise(path).is_some() {
        return Ok(CaptureKind::Photographs);
    }
    let folder = Folder::open(path)?;
    if find_views(&folder)?.is_some_and(|(views, _)| views.is_certain) {
        return Ok(CaptureKind::LightField);
    }
    match in_folder(path) {
        InFolder::One(_) => return Ok(CaptureKind::Depth),
        InFolder::Several(names) => {
            return Err(CaptureError::Ambiguous {
                path: path.into(),
                what: "several pictures with depth",
                names,
            });
        }
        InFolder::None => {}
    }
    let files = folder.entries(path).into_iter().filter(|(_, entry)| *entry == EntryKind::File);
    match files.take(1000).find_map(|(file, _)| unsupported_format_error(&file)) {
        Some(error) => Err(error),
        None => none(""),
    }
}
