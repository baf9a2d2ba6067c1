//! The files and embedded data that a document refers to.
//!
//! A reference is a data URI or a relative path inside the scene's folder. Everything else (absolute paths, `..`,
//! schemes, links that lead outside) is rejected: opening a scene must not read other parts of the disk.

use crate::error::Fault;
use crate::gltf::container::data_uri::{decode_data, strip_data_scheme};
use crate::gltf::container::file_reference::{UriInterpretation, interpret_uri};
use crate::gltf::document::Document;
use gltf::buffer::Source;
use std::io::Read;
use std::path::{Path, PathBuf};

impl<'a> Document<'a> {
    /// The bytes of the `uri`, a data URI or a file beside the scene, of the buffer or image at `owner`.
    ///
    /// # Errors
    /// The data is malformed, or the file cannot be read, lies outside the scene's folder, or exceeds the budget.
    pub fn resource(&self, owner: &str, uri: &str) -> Result<Vec<u8>, Fault> {
        let refuse = |what: &str| Fault::Resource {
            place: format!("{owner}/uri"),
            uri: shortened(uri),
            what: what.into(),
        };
        if let Some(data) = strip_data_scheme(uri) {
            self.budget.take_memory(data.len() as u64, owner)?;
            return decode_data(data).ok_or_else(|| refuse("is not valid data (export the scene again)"));
        }
        let path = self.find_inner_file(owner, uri).map_err(|what| refuse(&what))?;
        let size = path.metadata().map_err(|error| refuse(&read_failure(&error)))?.len();
        self.budget.take_file(size, &shortened(uri))?;
        let mut bytes = Vec::with_capacity(size as usize);
        // No more than was accounted for, even if the file is growing.
        let read = std::fs::File::open(&path).and_then(|file| file.take(size).read_to_end(&mut bytes));
        read.map_err(|error| refuse(&read_failure(&error)))?;
        Ok(bytes)
    }

    /// The file in the scene's folder that the `uri` at `owner` means, or what is wrong with its first
    /// interpretation.
    fn find_inner_file(&self, owner: &str, uri: &str) -> Result<PathBuf, String> {
        let mut wrong = None;
        for reading in interpret_uri(uri) {
            let resolved = reading.map_err(String::from).and_then(
                |UriInterpretation { path, is_well_formed: is_proper }| {
                    Ok((resolve(&self.folder, &path)?, path, is_proper))
                },
            );
            match resolved {
                Ok((file, path, is_proper)) => {
                    if !is_proper {
                        let (uri, path) = (shortened(uri), shortened(&path.display().to_string()));
                        self.warn(format!("{owner}/uri: {uri}: is not a valid URI; the file {path} is read"));
                    }
                    return Ok(file);
                }
                Err(what) => drop(wrong.get_or_insert(what)),
            }
        }
        Err(wrong.unwrap_or_default())
    }

    /// The bytes of buffer `index`, to which `place` refers, as far as declared and present. They are read once.
    ///
    /// # Errors
    /// The buffer does not exist or is faulty, or its file cannot be read.
    pub fn buffer(&self, index: usize, place: &str) -> Result<&[u8], Fault> {
        let buffer_place = self.entry("buffers", index, place)?;
        self.check_below(&buffer_place)?;
        let buffer = self.typed().buffers().nth(index);
        let Some((declared, source)) = buffer.map(|buffer| (buffer.length(), buffer.source())) else {
            return Err(Fault::NoData { place: buffer_place });
        };
        let cached = &self.cached_buffers[index];
        let bytes: &[u8] = match (cached.get(), source, self.chunk) {
            (Some(bytes), ..) => bytes,
            (None, Source::Uri(uri), _) => {
                let bytes = self.resource(&buffer_place, uri)?;
                cached.get_or_init(|| bytes)
            }
            (None, Source::Bin, Some(chunk)) if index == 0 => chunk,
            (None, Source::Bin, _) => return Err(Fault::NoData { place: buffer_place }),
        };
        if bytes.len() < declared {
            self.warn(format!(
                "{buffer_place}/byteLength: declares {declared} bytes, but there are {}",
                bytes.len()
            ));
        }
        Ok(&bytes[..bytes.len().min(declared)])
    }

    /// The bytes of buffer view `index`, to which `place` refers, and its stride in bytes, if declared.
    ///
    /// # Errors
    /// It does not exist, is faulty, or reaches beyond its buffer.
    pub fn buffer_view(&self, index: usize, place: &str) -> Result<(&[u8], Option<usize>), Fault> {
        let view_place = self.entry("bufferViews", index, place)?;
        self.check_below(&view_place)?;
        let Some(view) = self.typed().views().nth(index) else {
            return Err(Fault::NoData { place: view_place });
        };
        let buffer = view.buffer().index();
        let bytes = self.buffer(buffer, &format!("{view_place}/buffer"))?;
        let (offset, length) = (view.offset(), view.length());
        let Some(end) = offset.checked_add(length).filter(|&end| end <= bytes.len()) else {
            return Err(Fault::Malformed {
                place: view_place,
                what: format!(
                    "bytes {offset} + {length} do not fit buffer {buffer} of {} bytes",
                    bytes.len()
                ),
            });
        };
        Ok((&bytes[offset..end], view.stride()))
    }
}

fn read_failure(error: &std::io::Error) -> String {
    match error.kind() {
        std::io::ErrorKind::NotFound => "is missing (put it back beside the scene file)".into(),
        _ => format!("cannot be read: {error} (check the file)"),
    }
}

/// A URI for a message, shortened because data URIs may have megabytes.
fn shortened(uri: &str) -> String {
    let mut text: String = uri.chars().take(60).map(|c| if c.is_control() { '?' } else { c }).collect();
    if uri.chars().nth(60).is_some() {
        text.push('…');
    }
    text
}

/// The regular file at `path` inside `folder`, links followed.
fn resolve(folder: &Path, path: &Path) -> Result<PathBuf, String> {
    let real = folder.join(path).canonicalize().map_err(|error| read_failure(&error))?;
    if !real.starts_with(folder) {
        return Err("is a link that leads outside the scene's folder (copy the file there)".into());
    }
    if !real.is_file() {
        return Err("is not a file (put the file back beside the scene file)".into());
    }
    Ok(real)
}
