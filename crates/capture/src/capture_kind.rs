//! What kind of capture a path is.

use crate::depth_picture::{InFolder, has_depth, in_folder};
use crate::folder::{EntryKind, Folder, extension};
use crate::foreign::unsupported_format_error;
use crate::light_field::find_views;
use crate::mosaic::detect_pitch;
use crate::picture_header::read_header;
use crate::picture_names::EXTENSIONS;
use crate::{CaptureError, layout};
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
    /// All, with the names they are chosen by.
    pub const ALL: [(&str, Self); 3] =
        [("photographs", Self::Photographs), ("lightfield", Self::LightField), ("depth", Self::Depth)];

    /// The one with this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(candidate, _)| *candidate == name).map(|(_, kind)| *kind)
    }
}

/// Whether a file's name says that it is a picture, or holds some: one that [`capture_kind`] can say something about.
pub fn may_be_picture(path: &Path) -> bool {
    const OTHERS: [&str; 5] = ["heif", "avif", "lfp", "lfr", "lfx"];
    let extension = extension(path);
    EXTENSIONS.contains(&extension.as_str()) || OTHERS.contains(&extension.as_str())
}

/// The kind of capture that a folder or file is.
///
/// A folder is asked for cameras of photographs first, then for views, then for a picture with depth; a picture for depth in it or
/// beside it, then for the period of micro-images. That is quick, but for pictures with neither, whose pixels are looked at.
///
/// # Errors
/// It is none: a sentence that says what there is to give. [`CaptureError::Foreign`] of files that another program has to export first.
pub fn detect_capture_kind(path: &Path) -> Result<CaptureKind, CaptureError> {
    let options = LoadOptions::default();
    let none = |detail: &str| Err(CaptureError::NoCapture { path: path.into(), found: detail.into() });
    if !path.is_dir() {
        if let Some(error) = unsupported_format_error(path) {
            return Err(error);
        }
        if has_depth(path, &options) {
            return Ok(CaptureKind::Depth);
        }
        if extension(path) == "exr" {
            return none(": an EXR without a channel of depth");
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
