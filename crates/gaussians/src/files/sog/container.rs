//! Where the files of a SOG scene are: in a folder, or in a zip archive.

use super::super::reading::Reading;
use crate::error::{GaussianError, quoted};
use std::fs::File;
use std::io::{Cursor, Read};
use std::path::{Component, Path, PathBuf};
use zip::ZipArchive;
use zip::result::ZipError;

/// The name of the description.
const META: &str = "meta.json";

/// The files of a scene.
pub(super) enum Container<'a> {
    /// A folder.
    Folder(PathBuf),
    /// An archive, and the folder in it that has the description.
    Archive(ZipArchive<Cursor<&'a [u8]>>, String),
}

impl<'a> Container<'a> {
    pub fn folder(folder: &Path) -> Self {
        Self::Folder(folder.into())
    }

    /// The archive in `bytes`.
    ///
    /// # Errors
    /// It is malformed, or has no description.
    pub fn archive(reading: &Reading<'_>, bytes: &'a [u8]) -> Result<Self, GaussianError> {
        let archive = ZipArchive::new(Cursor::new(bytes)).map_err(|e| reading.malformed("zip archive", e))?;
        let is_meta = |name: &String| {
            name.strip_suffix(META).is_some_and(|folder| folder.is_empty() || folder.ends_with('/'))
        };
        let names = archive.file_names().filter_map(|name| Some(name.ok()?.into_owned()));
        // That of the root, or else the outermost.
        let Some(meta) = names.filter(is_meta).min_by_key(String::len) else {
            return Err(GaussianError::no_splats(
                reading.file(),
                "is a zip archive without a meta.json of SOG",
            ));
        };
        let prefix = meta[..meta.len() - META.len()].to_string();
        Ok(Self::Archive(archive, prefix))
    }

    /// The description.
    ///
    /// # Errors
    /// It is missing, or larger than any description.
    pub fn meta(&mut self, reading: &Reading<'_>) -> Result<Vec<u8>, GaussianError> {
        /// Codebooks of 3 × 256 numbers, names, and room.
        const MAX_BYTES: u64 = 1 << 20;
        self.read(reading, META, MAX_BYTES)
    }

    /// A file of the scene, of at most `max_bytes`.
    ///
    /// # Errors
    /// It is missing, outside the scene's folder, or larger.
    pub fn read(
        &mut self,
        reading: &Reading<'_>,
        name: &str,
        max_bytes: u64,
    ) -> Result<Vec<u8>, GaussianError> {
        let missing =
            |e: &dyn std::fmt::Display| reading.malformed(quoted(name), format!("cannot be read: {e}"));
        let is_inside =
            Path::new(name).components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
        let outside = || GaussianError::Outside { file: reading.file().into(), name: quoted(name) };
        if !is_inside || name.contains('\\') {
            return Err(outside());
        }
        let mut bytes = Vec::new();
        match self {
            Self::Folder(folder) => {
                let unreadable = |e| GaussianError::unreadable(&folder.join(name), e);
                let file = folder.join(name).canonicalize().map_err(unreadable)?;
                // A link may lead anywhere.
                if !file.starts_with(folder.canonicalize().map_err(unreadable)?) {
                    return Err(outside());
                }
                let input = File::open(file).map_err(unreadable)?;
                input.take(max_bytes.saturating_add(1)).read_to_end(&mut bytes).map_err(unreadable)?;
            }
            Self::Archive(archive, prefix) => {
                let entry = archive.by_name(&format!("{prefix}{name}")).map_err(|e: ZipError| missing(&e))?;
                entry.take(max_bytes.saturating_add(1)).read_to_end(&mut bytes).map_err(|e| missing(&e))?;
            }
        }
        if bytes.len() as u64 > max_bytes {
            return Err(reading
                .malformed(quoted(name), format!("is larger than the {max_bytes} bytes that it needs")));
        }
        Ok(bytes)
    }
}
