//! Files that hold a light field or depth which another program has to export first: the error for each describes
//! how.

use crate::CaptureError;
use crate::files::folder::extension;
use crate::files::whole_file::head;
use std::path::Path;

/// The error for a file in such a format, if it is one.
pub(crate) fn unsupported_format_error(file: &Path) -> Option<CaptureError> {
    let start = head(file, 64 << 10);
    let extension = extension(file);
    let error = |what: String, cure| Some(CaptureError::UnsupportedFormat { file: file.into(), what, cure });
    if start.starts_with(b"\x89LFP") || ["lfp", "lfr", "lfx"].contains(&extension.as_str()) {
        let text = String::from_utf8_lossy(&start);
        let inside = match () {
            () if text.contains("refocusStack") => "a stack of refocused pictures without views",
            () if text.contains("accelerationArray") && text.contains("depthMap") => {
                "a depth map without picture or views"
            }
            () if text.contains("rawImage") || text.contains("pixelPacking") || text.contains("image\":") => {
                "a raw picture from behind the micro-lenses"
            }
            () => "a raw picture from behind the micro-lenses, or what Lytro Desktop made of one",
        };
        return error(
            format!("one of Lytro's own files, and holds {inside}"),
            "export views from the camera's .lfp or .lfr: with PlenoptiCam, which writes a folder viewpoints_Npx, or with Lytro's Desktop or \
             Power Tools as an ESLF picture, a PNG, with its depth map; then open that folder or picture",
        );
    }
    let is_heif = start.get(4..8) == Some(b"ftyp")
        && start.get(8..12).is_some_and(|brand| {
            [b"heic", b"heix", b"mif1", b"msf1", b"avif"].iter().any(|heif_brand| brand == *heif_brand)
        });
    if is_heif || ["heic", "heif", "hif"].contains(&extension.as_str()) {
        return error(
            "an HEIC picture, which cannot be read".into(),
            "extract picture and depth with libheif: heif-convert --with-aux PICTURE.heic PICTURE.png, rename the auxiliary picture \
             of the depth to PICTURE_depth.png, and open PICTURE.png with --near white; a conversion to JPEG alone drops the depth",
        );
    }
    None
}
