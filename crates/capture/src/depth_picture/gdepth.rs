//! GDepth: a depth map in the XMP of a JPEG, as base64; with it, in GImage, often the sharp original of a blurred picture.
//! (Depthmap Metadata, Google 2014: <https://developers.google.com/depthmap-metadata/reference>.)

use super::base64_text::decoded;
use super::depth_range::{DepthRange, Unit};
use super::embedded::Embedded;
use super::jpeg::is_picture;
use super::xmp::find_property;
use roxmltree::Document;
use scene::LoadOptions;

const DEPTH: &str = "photos/1.0/depthmap";
const IMAGE: &str = "photos/1.0/image";

/// Reads the GDepth of a picture's XMP; `None` if it has none.
pub(super) fn read_gdepth(
    documents: &[Document<'_>],
    options: &LoadOptions,
) -> Option<Result<Embedded, String>> {
    let data = find_property(documents, DEPTH, "Data")?;
    Some(read(documents, data, options))
}

fn read(documents: &[Document<'_>], data: &str, options: &LoadOptions) -> Result<Embedded, String> {
    let depth = |name| find_property(documents, DEPTH, name);
    let bytes = decoded(data).map_err(|why| format!("GDepth:Data: {why}"))?;
    let unit = Unit::named(depth("Units"));
    let range = DepthRange::parse(depth("Format"), depth("Near"), depth("Far"), unit)
        .map_err(|why| format!("GDepth: {why}"))?;
    let mut embedded =
        Embedded::decode(&bytes, range, options).map_err(|why| format!("GDepth:Data: {why}"))?;
    if depth("MeasureType").is_some_and(|kind| kind.trim() == "OpticRay") {
        embedded.notes.push("measures depth along rays; it is treated as depth along the axis".into());
    }
    if let Some(data) = find_property(documents, IMAGE, "Data") {
        match decoded(data) {
            Ok(bytes) if is_picture(&bytes) => embedded.original = Some(bytes),
            Ok(_) => embedded
                .notes
                .push("has GImage:Data that is not a picture; the displayed picture is used".into()),
            Err(why) => embedded
                .notes
                .push(format!("has GImage:Data that cannot be read ({why}); the displayed picture is used")),
        }
    }
    Ok(embedded)
}
