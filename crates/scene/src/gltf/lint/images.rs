//! Images and the textures that use them: declared and actual formats.

use crate::gltf::container::data_uri::strip_data_scheme;
use crate::gltf::container::json_object::Object;
use crate::gltf::document::Document;
use crate::gltf::extension;
use crate::gltf::materials::image_file::mime_type;
use image::ImageReader;
use std::borrow::Cow;
use std::io::Cursor;

const WEBP: &str = "EXT_texture_webp";

pub(super) fn lint(document: &Document<'_>) {
    let webp_is_declared = extension::used(document).any(|name| name == WEBP);
    let mut formats = Vec::new();
    for index in 0..document.len("images") {
        let image = document.item("images", index, "").ok();
        formats.push(image.and_then(|image| lint_format(document, index, &image, webp_is_declared)));
    }
    for index in 0..document.len("textures") {
        let Ok(texture) = document.item("textures", index, "") else { continue };
        let format = |source: usize| formats.get(source).copied().flatten();
        if let Ok(Some(source)) = texture.index("source")
            && format(source).is_some_and(|format| format == "image/webp")
        {
            document.warn(format!("{}/source: is image/webp, not PNG or JPEG", texture.place));
        }
        let Ok(Some(webp)) = texture.extension(WEBP) else { continue };
        if let Ok(Some(source)) = webp.index("source")
            && let Some(format) = format(source).filter(|&format| format != "image/webp")
        {
            document.warn(format!("{}/source: is {format}, not WebP", webp.place));
        }
    }
}

/// The format of an image, from its first bytes; warns if the document declares another.
fn lint_format(
    document: &Document<'_>,
    index: usize,
    image: &Object<'_>,
    webp_is_declared: bool,
) -> Option<&'static str> {
    if let Ok(Some(view)) = image.index("bufferView") {
        let strided =
            document.item("bufferViews", view, "").is_ok_and(|view| view.get("byteStride").is_some());
        if strided {
            document.warn(format!("{}/bufferView: a view of an image cannot have a byteStride", image.place));
        }
    }
    if image.get("uri").is_none() && image.get("bufferView").is_none() {
        return None;
    }
    if !document.budget.try_take_checks(64) {
        return None;
    }
    let bytes = match document.image_bytes(index, "") {
        Ok(bytes) => bytes,
        Err(fault) => {
            document.warn(fault.to_string());
            return None;
        }
    };
    let in_time = document.budget.try_take_checks(64 + bytes.len() / 16);
    let format = mime_type(&bytes).filter(|_| in_time);
    match format {
        None if in_time => document.warn(format!("{}: its format is not recognised", image.place)),
        None => {}
        Some(format) => {
            let declared = image.text("mimeType").ok().flatten().or_else(|| declared_by_data(image));
            if let Some(declared) = declared.filter(|&declared| declared != format) {
                document.warn(format!("{}: is {format}, but declared as {declared}", image.place));
            }
            if format == "image/webp" && !webp_is_declared {
                document.warn(format!("{}: is WebP, which needs the extension {WEBP}", image.place));
            }
            let reader = ImageReader::new(Cursor::new(&bytes[..])).with_guessed_format();
            let has_decoder = format != "image/ktx2";
            if let Some(Err(error)) = reader.ok().filter(|_| has_decoder).map(ImageReader::into_dimensions) {
                document.warn(format!("{}: cannot be decoded: {error}", image.place));
            }
        }
    }
    if let Cow::Owned(bytes) = bytes {
        document.budget.release_memory(bytes.len() as u64);
    }
    format
}

/// The media type that a data URI declares, if it is an image's.
fn declared_by_data<'a>(image: &Object<'a>) -> Option<&'a str> {
    let header = strip_data_scheme(image.text("uri").ok()??)?.split([';', ',']).next()?;
    header.starts_with("image/").then_some(header)
}
