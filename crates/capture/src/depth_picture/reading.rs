//! Opening a picture with depth.

use super::dynamic_depth::read_dynamic_depth;
use super::embedded::Embedded;
use super::gdepth::read_gdepth;
use super::jpeg::{Segments, is_jpeg};
use super::sibling_depth::{depth_files, pictures};
use super::xmp::XmpTexts;
use crate::depth_map::{
    DepthMap, DepthMeaning, DepthQuantity, NearEnd, quantity_from_name, read_depth_channel, read_depth_map,
};
use crate::files::exif::Exif;
use crate::files::folder::extension;
use crate::files::picture_header::read_header;
use crate::files::text::quoted;
use crate::files::whole_file::{head, whole_file};
use crate::pictures::exr_channels::{color_channels, depth_channel, exr_names_and_root};
use crate::pictures::exr_layers::{ExrLayer, exr_layers};
use crate::pictures::picture_source::PictureSource;
use crate::unsupported_format::unsupported_format_error;
use crate::{CaptureError, Remark};
use scene::LoadOptions;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Options for reading a picture with depth.
#[derive(Clone, Debug, Default)]
pub struct DepthPictureOptions {
    /// The file of its depth, and the quantity that it holds; `None`: looked for in the picture and next to it.
    pub depth: Option<(PathBuf, DepthQuantity)>,
    /// The layer of an EXR with several pictures, by name; `None`: the first one with depth.
    pub layer: Option<String>,
    /// The near end of a relative map.
    pub near: Option<NearEnd>,
    /// Limits on memory and size.
    pub load: LoadOptions,
}

/// Where the depth of a picture was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthContainer {
    /// In a channel of the picture's EXR.
    Exr,
    /// In a file of its own.
    Beside,
    /// In the XMP of the picture's JPEG.
    GDepth,
    /// Behind the picture in its JPEG.
    DynamicDepth,
}

/// One picture, and the distance of what it shows.
#[derive(Clone, Debug)]
pub struct DepthPicture {
    /// Its file's name.
    pub name: String,
    /// The picture; the sharp one if the file has it in addition to a blurred one.
    pub picture: PictureSource,
    /// Columns and rows of the upright picture.
    pub size: [u32; 2],
    /// Its depth, oriented like the picture; it may be coarser, and covers the whole picture.
    pub depth: DepthMap,
    /// The file of the depth.
    pub depth_file: PathBuf,
    /// Where the depth was.
    pub container: DepthContainer,
    /// The distances of the least and the greatest level according to the file itself, m.
    pub near_far_m: Option<[f64; 2]>,
    /// The focal length, in pixels of the picture, if the file has it.
    pub focal_px: Option<f64>,
    /// What was incomplete, or is good to know.
    pub remarks: Vec<Remark>,
}

/// Opens a picture with its depth: a file that holds both, a picture with a file next to it, or a folder of one such picture.
///
/// # Errors
/// There is no depth; the picture or the depth cannot be read, are malformed or exceed the limits; or the depth is relative and its near
/// end is unknown.
pub fn open_depth_picture(path: &Path, options: &DepthPictureOptions) -> Result<DepthPicture, CaptureError> {
    if path.is_dir() {
        return match in_folder(path) {
            InFolder::One(picture) => open_depth_picture(&picture, options),
            InFolder::Several(names) => {
                Err(CaptureError::Ambiguous { path: path.into(), what: "several pictures with depth", names })
            }
            InFolder::None if options.depth.is_some() && pictures(path).len() == 1 => {
                open_depth_picture(&pictures(path)[0], options)
            }
            InFolder::None => {
                Err(CaptureError::NoDepth { path: path.into(), detail: " of a picture in it".into() })
            }
        };
    }
    if let Some(error) = unsupported_format_error(path) {
        return Err(error);
    }
    let opening = Opening { file: path, options };
    if options.layer.is_some() && extension(path) != "exr" {
        return Err(CaptureError::Unlayered { file: path.into() });
    }
    if let Some((depth, quantity)) = &options.depth {
        return opening.with_file(depth, Some(*quantity), Vec::new());
    }
    if extension(path) == "exr" {
        return opening.exr();
    }
    if let Some(picture) = opening.embedded()? {
        return Ok(picture);
    }
    let depth_maps = depth_files(path);
    let Some(depth) = depth_maps.first() else {
        // A file that cannot be read is reported as such.
        read_header(path).map_err(|why| CaptureError::malformed(path, "picture", why))?;
        return Err(CaptureError::NoDepth { path: path.into(), detail: " in it or beside it".into() });
    };
    let others = depth_maps[1..].iter().map(|file| file.display().to_string()).collect();
    let remark = Remark::about(others, false, |names| {
        format!(
            "{}: is used as the depth; there are also {names} (name one of those to use it instead)",
            depth.display()
        )
    });
    opening.with_file(depth, None, remark.into_iter().collect())
}

/// Whether a file is a picture with depth, by its name, its neighbours' and its header.
pub(crate) fn has_depth(file: &Path, options: &LoadOptions) -> bool {
    if extension(file) == "exr" {
        let (names, root) = exr_names_and_root(file, options).unwrap_or_default();
        let layers = exr_layers(&names, &root);
        let has_picture = color_channels(&names).is_some();
        return layers.iter().any(|layer| layer.depth.is_some())
            || has_picture && !depth_files(file).is_empty();
    }
    if !depth_files(file).is_empty() {
        return true;
    }
    let bytes = head(file, 2);
    is_jpeg(&bytes) && whole_file(file, options.max_memory / 4).is_ok_and(|bytes| mentions_depth(&bytes))
}

/// Whether a JPEG's XMP has depth of a supported kind; for a broken one, whether it seems so.
fn mentions_depth(bytes: &[u8]) -> bool {
    let Ok(segments) = Segments::parse(bytes) else { return false };
    let Some(xmp) = segments.xmp else { return false };
    let text = String::from_utf8_lossy(xmp);
    ["DepthURI", "photos/1.0/depthmap"].iter().any(|word| text.contains(word)) || has_depth_semantic(&text)
}

fn has_depth_semantic(text: &str) -> bool {
    text.contains("Semantic=\"Depth\"") || text.contains("Semantic>Depth<")
}

/// The pictures with depth of a folder.
pub(crate) enum InFolder {
    None,
    One(PathBuf),
    /// Some of their names.
    Several(String),
}

/// Looks for pictures with depth in a folder; by names alone, except for JPEGs if there are few.
pub(crate) fn in_folder(folder: &Path) -> InFolder {
    /// A folder of more pictures is something else.
    const MAX_PICTURES: usize = 50;
    let mut all = pictures(folder);
    if let Ok(entries) = std::fs::read_dir(folder) {
        let is_exr = |path: &PathBuf| extension(path) == "exr" && path.is_file();
        let mut exrs: Vec<PathBuf> =
            entries.take(MAX_PICTURES).flatten().map(|entry| entry.path()).filter(is_exr).collect();
        exrs.sort();
        all.extend(exrs);
    }
    if all.len() > MAX_PICTURES {
        return InFolder::None;
    }
    let options = LoadOptions::default();
    let with_depth: Vec<PathBuf> = all.into_iter().filter(|file| has_depth(file, &options)).collect();
    match &with_depth[..] {
        [] => InFolder::None,
        [only] => InFolder::One(only.clone()),
        several => {
            let names =
                several.iter().take(4).map(|file| file.file_name().unwrap_or_default().to_string_lossy());
            let dots = if several.len() > 4 { ", …" } else { "" };
            InFolder::Several(names.collect::<Vec<_>>().join(", ") + dots)
        }
    }
}

struct Opening<'a> {
    file: &'a Path,
    options: &'a DepthPictureOptions,
}

/// The content of a picture's header.
struct Shown {
    stored: [u32; 2],
    exif: Exif,
}

impl Opening<'_> {
    fn malformed(&self, place: &str, what: impl ToString) -> CaptureError {
        CaptureError::malformed(self.file, place, what)
    }

    fn name(&self) -> String {
        self.file.file_name().unwrap_or_default().to_string_lossy().into_owned()
    }

    fn header(&self) -> Result<Shown, CaptureError> {
        let (stored, exif) = read_header(self.file).map_err(|why| self.malformed("picture", why))?;
        Ok(Shown { stored, exif })
    }

    /// An EXR with a depth channel, or with a depth file next to it.
    fn exr(&self) -> Result<DepthPicture, CaptureError> {
        let load = &self.options.load;
        let (names, root) = exr_names_and_root(self.file, load)?;
        let layers: Vec<ExrLayer> =
            exr_layers(&names, &root).into_iter().filter(|layer| layer.depth.is_some()).collect();
        if layers.is_empty() && depth_channel(&names).is_none() {
            return match depth_files(self.file).first() {
                Some(depth) => self.with_file(depth, None, Vec::new()),
                None => Err(CaptureError::NoDepth {
                    path: self.file.into(),
                    detail: " among its channels (Z, depth.Z, ViewLayer.Depth.Z, Depth.V) or beside it"
                        .into(),
                }),
            };
        }
        if layers.is_empty() {
            return Err(self
                .malformed("EXR", "has a depth channel, but no picture (R, G, B; ViewLayer.Combined.R …)"));
        }
        let ExrLayer { name, color: channels, depth } = self.chosen_layer(&layers)?;
        let others = layers.iter().filter(|layer| layer.name != *name).map(|layer| layer.name.clone());
        let others = if self.options.layer.is_some() { Vec::new() } else { others.collect() };
        let remark = Remark::about(others, false, |names| {
            format!(
                "{}: its layer {} is used; there are also {names} (choose one with --layer)",
                self.file.display(),
                quoted(name)
            )
        });
        // Depth in the picture's own file means distances, unless the near end is specified.
        let depth = depth.as_deref().unwrap_or_default();
        let depth = read_depth_channel(self.file, depth, self.options.near, load)?;
        Ok(DepthPicture {
            name: self.name(),
            picture: PictureSource::Exr { file: self.file.into(), channels: channels.clone() },
            size: [depth.width, depth.height],
            depth,
            depth_file: self.file.into(),
            container: DepthContainer::Exr,
            near_far_m: None,
            focal_px: None,
            remarks: remark.into_iter().collect(),
        })
    }

    /// The layer that is asked for, by its name; else the first.
    fn chosen_layer<'b>(&self, layers: &'b [ExrLayer]) -> Result<&'b ExrLayer, CaptureError> {
        let Some(name) = &self.options.layer else { return Ok(&layers[0]) };
        layers.iter().find(|layer| layer.name == *name).ok_or_else(|| {
            let layers: Vec<String> = layers.iter().map(|layer| quoted(&layer.name)).collect();
            CaptureError::NoLayer { file: self.file.into(), layer: quoted(name), layers: layers.join(", ") }
        })
    }

    /// A picture whose depth is in another file.
    fn with_file(
        &self,
        depth_file: &Path,
        quantity: Option<DepthQuantity>,
        mut remarks: Vec<Remark>,
    ) -> Result<DepthPicture, CaptureError> {
        let Self { file, options } = *self;
        let depth = read_depth_map(depth_file, quantity, options.near, &options.load)?;
        if options.near.is_none()
            && quantity.is_none()
            && depth.meaning == DepthMeaning::Relative
            && quantity_from_name(depth_file) == Some(DepthQuantity::Disparity)
        {
            remarks.push(Remark::note(format!(
                "{}: is named a disparity, so white is near (pass --near black otherwise)",
                depth_file.display()
            )));
        }
        let (picture, size, depth, focal_px) = if extension(file) == "exr" {
            let (names, root) = exr_names_and_root(file, &options.load)?;
            let channels = match &options.layer {
                Some(_) => Some(self.chosen_layer(&exr_layers(&names, &root))?.color.clone()),
                None => color_channels(&names),
            };
            let channels = channels
                .ok_or_else(|| self.malformed("EXR", "has no picture (R, G, B; ViewLayer.Combined.R …)"))?;
            let size = crate::pictures::exr_channels::read_exr(file, &[&channels[0]], &options.load)?.size;
            (PictureSource::Exr { file: file.into(), channels }, size, depth, None)
        } else {
            let shown = self.header()?;
            let orientation = shown.exif.orientation;
            let is_turned = is_turned_already(shown.stored, orientation, [depth.width, depth.height]);
            let depth = if is_turned { depth } else { depth.turned(orientation) };
            let picture = PictureSource::File { file: file.into(), orientation };
            (picture, upright_size(shown.stored, orientation), depth, focal_px(&shown))
        };
        remarks.extend(other_shape(depth_file, size, &depth));
        Ok(DepthPicture {
            name: self.name(),
            picture,
            size,
            depth,
            depth_file: depth_file.into(),
            container: DepthContainer::Beside,
            near_far_m: None,
            focal_px,
            remarks,
        })
    }

    /// A JPEG with embedded depth; `None` if it has none.
    fn embedded(&self) -> Result<Option<DepthPicture>, CaptureError> {
        let Self { file, options } = *self;
        if !is_jpeg(&head(file, 2)) {
            return Ok(None);
        }
        let bytes = whole_file(file, options.load.max_memory / 4)?;
        if !mentions_depth(&bytes) {
            return Ok(None);
        }
        let at = |(byte, what): (usize, String)| self.malformed(&format!("byte {byte}"), what);
        let segments = Segments::parse(&bytes).map_err(at)?;
        let texts = XmpTexts::from_segments(&segments).map_err(at)?;
        let documents = texts.documents().map_err(|why| self.malformed("XMP", why))?;
        let gdepth =
            || read_gdepth(&documents, &options.load).map(|embedded| (embedded, DepthContainer::GDepth));
        let dynamic = || {
            let embedded = read_dynamic_depth(&documents, &bytes, &options.load);
            embedded.map(|embedded| (embedded, DepthContainer::DynamicDepth))
        };
        let Some((embedded, container)) = gdepth().or_else(dynamic) else {
            if texts.mention("GDepth:Near") || texts.mention("GDepth:Format") {
                return Err(self.malformed(
                    "XMP",
                    "refers to a depth map (GDepth) that is missing (there is no GDepth:Data)",
                ));
            }
            return Ok(None);
        };
        let embedded = embedded.map_err(|why| self.malformed("XMP", why))?;
        self.embedded_picture(embedded, container).map(Some)
    }

    fn embedded_picture(
        &self,
        embedded: Embedded,
        container: DepthContainer,
    ) -> Result<DepthPicture, CaptureError> {
        let file = self.file;
        let shown = self.header()?;
        let orientation = shown.exif.orientation;
        let Embedded { map, near_far, original, focal_share, notes } = embedded;
        let note = |note: String| Remark::note(format!("{}: {note}", file.display()));
        let mut remarks: Vec<Remark> = notes.into_iter().map(note).collect();
        let (picture, stored, picture_orientation) = match original {
            Some(bytes) => {
                let (stored, own) = crate::files::picture_header::header_of_bytes(&bytes)
                    .map_err(|why| self.malformed("original picture", why))?;
                remarks.push(note("contains the picture before it was blurred, which is used".into()));
                // It is stored as the picture is, or upright.
                let is_alike = (stored[0] > stored[1]) == (shown.stored[0] > shown.stored[1]);
                let orientation =
                    if own.orientation != 1 || !is_alike { own.orientation } else { orientation };
                (
                    PictureSource::Within { file: file.into(), bytes: Arc::from(bytes), orientation },
                    stored,
                    orientation,
                )
            }
            None => (PictureSource::File { file: file.into(), orientation }, shown.stored, orientation),
        };
        let size = upright_size(stored, picture_orientation);
        let is_turned = is_turned_already(shown.stored, orientation, [map.width, map.height]);
        let depth = if is_turned { map } else { map.turned(orientation) };
        remarks.extend(other_shape(file, size, &depth));
        let focal_px = focal_share
            .map(|share| share * f64::from(size[0].max(size[1])))
            .or_else(|| focal_px(&Shown { stored: size, exif: shown.exif }));
        Ok(DepthPicture {
            name: self.name(),
            picture,
            size,
            depth,
            depth_file: file.into(),
            container,
            near_far_m: near_far,
            focal_px,
            remarks,
        })
    }
}

/// The size of a picture after its orientation is applied.
fn upright_size([width, height]: [u32; 2], orientation: u8) -> [u32; 2] {
    if orientation >= 5 { [height, width] } else { [width, height] }
}

/// Whether a depth map is already upright, though the picture is stored otherwise: by which of the two shapes it has.
fn is_turned_already(stored: [u32; 2], orientation: u8, depth: [u32; 2]) -> bool {
    orientation >= 5 && mismatch(upright_size(stored, orientation), depth) < mismatch(stored, depth)
}

/// The mismatch of two shapes: the logarithm of the ratio of their aspect ratios.
fn mismatch(a: [u32; 2], b: [u32; 2]) -> f64 {
    let ratio = |[width, height]: [u32; 2]| f64::from(width) / f64::from(height);
    (ratio(a) / ratio(b)).ln().abs()
}

/// A remark if a depth map has another shape than its picture, by more than rounding.
fn other_shape(file: &Path, size: [u32; 2], depth: &DepthMap) -> Option<Remark> {
    let rounding = 1.0 / f64::from(depth.width.min(depth.height).max(1));
    let differs = mismatch(size, [depth.width, depth.height]) > 0.02 + 2.0 * rounding;
    differs.then(|| {
        let (width, height) = (depth.width, depth.height);
        Remark::note(format!(
            "{}: the depth map of {width} × {height} px has another shape than the picture of {} × {} px, and is stretched over it",
            file.display(),
            size[0],
            size[1]
        ))
    })
}

/// The focal length in pixels, from that on a film of 36 × 24 mm with the same diagonal (CIPA DCG-001).
fn focal_px(shown: &Shown) -> Option<f64> {
    let film = f64::hypot(36.0, 24.0);
    let [width, height] = shown.stored.map(f64::from);
    shown.exif.focal_length_35mm.map(|focal| focal * f64::hypot(width, height) / film)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shape_of_a_depth_map_determines_its_orientation() {
        assert!(!is_turned_already([40, 30], 6, [20, 15]));
        assert!(is_turned_already([40, 30], 6, [15, 20]));
        assert!(!is_turned_already([40, 30], 3, [15, 20]));
        // A square one is stored as the picture is.
        assert!(!is_turned_already([30, 30], 6, [10, 10]));
    }

    #[test]
    fn a_lens_of_43_mm_is_as_long_as_the_diagonal() {
        let exif = Exif { focal_length_35mm: Some(f64::hypot(36.0, 24.0)), ..Exif::default() };
        assert!((focal_px(&Shown { stored: [300, 400], exif }).unwrap() - 500.0).abs() < 1e-9);
        assert_eq!(focal_px(&Shown { stored: [300, 400], exif: Exif::default() }), None);
    }
}
