//! Dynamic Depth: a directory in the XMP of a JPEG, and the items that it lists behind the picture, one after the other.
//! (Dynamic Depth 1.0, Google 2019: <https://developer.android.com/training/camera2/Dynamic-depth-v1.0.pdf>.)
//!
//! Items lie where the lengths say, counted from the end of the picture; some writers insert data between or after them, or nest trailers
//! in trailers. So an item must begin like a picture; otherwise its position is counted from the end of the file, and failing that the
//! pictures behind the first are enumerated in order.

use super::depth_range::{DepthRange, Unit};
use super::embedded::Embedded;
use super::jpeg::{end_of_jpeg, end_of_png, is_picture};
use super::xmp::{find_property, property};
use roxmltree::{Document, Node};
use scene::LoadOptions;

/// An item of the directory.
#[derive(Debug)]
struct Item<'a> {
    /// Bytes; 0 for the picture itself, and for items that share another's.
    length: usize,
    /// Padding bytes that follow it.
    padding: usize,
    uri: Option<&'a str>,
    semantic: Option<&'a str>,
}

/// A longer directory is invalid.
const MAX_ITEMS: usize = 1000;

/// Reads the Dynamic Depth of a JPEG; `None` if it has none. `bytes` are those of the file.
pub(super) fn read_dynamic_depth(
    documents: &[Document<'_>],
    bytes: &[u8],
    options: &LoadOptions,
) -> Option<Result<Embedded, String>> {
    let nodes = || documents.iter().flat_map(|document| document.descendants());
    let items: Vec<Item> = nodes().filter_map(item).take(MAX_ITEMS).collect();
    let depth = nodes().find(|node| property(*node, "DepthURI").is_some());
    let uri = depth.and_then(|node| property(node, "DepthURI"));
    let is_depth = |item: &Item| match uri {
        Some(uri) => item.uri == Some(uri),
        None => item
            .semantic
            .is_some_and(|semantic| ["depth", "depthmap"].contains(&semantic.to_lowercase().as_str())),
    };
    let Some(index) = items.iter().position(is_depth) else {
        let uri = crate::files::text::quoted(uri?);
        return Some(Err(format!("its depth map {uri} is not in its directory of {} items", items.len())));
    };
    let read = || {
        let property_value = |name: &str| match depth {
            Some(node) => property(node, name),
            None => find_property(documents, "depthmap", name),
        };
        let unit = Unit::named(property_value("Units"));
        let range =
            DepthRange::parse(property_value("Format"), property_value("Near"), property_value("Far"), unit)?;
        let depth_bytes = located(&items, index, bytes).ok_or_else(|| {
            let behind = bytes.len() - end_of_jpeg(bytes).unwrap_or(bytes.len());
            format!("its depth map is missing: only {behind} bytes follow the picture (the file was truncated, or saved by a program that drops them)")
        })?;
        let mut embedded = Embedded::decode(depth_bytes, range, options)?;
        if unit == Unit::Dioptres
            && range.is_some()
            && property_value("Near").and_then(number) < property_value("Far").and_then(number)
        {
            embedded
                .notes
                .push("labels its distances as dioptres, which they are not: they have no scale".into());
        }
        if property_value("MeasureType").is_some_and(|kind| kind.trim() == "OpticRay") {
            embedded.notes.push("measures depth along rays; it is treated as depth along the axis".into());
        }
        // The picture before the camera blurred it.
        let original = nodes().find_map(|node| {
            let is_original = property(node, "ItemSemantic")
                .is_some_and(|semantic| semantic.eq_ignore_ascii_case("original"));
            let uri = property(node, "ItemURI").filter(|_| is_original)?;
            items.iter().position(|item| item.uri == Some(uri) && item.length > 0)
        });
        embedded.original = original.and_then(|index| located(&items, index, bytes)).map(<[u8]>::to_vec);
        embedded.focal_share = nodes().find_map(|node| {
            let focal = property(node, "FocalLengthX").and_then(number)?;
            let width = property(node, "ImageWidth").and_then(number)?;
            Some(focal / width).filter(|share| share.is_finite() && *share > 0.0)
        });
        Ok(embedded)
    };
    Some(read().map_err(|why: String| format!("Dynamic Depth: {why}")))
}

fn number(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|number: &f64| number.is_finite())
}

/// The item that a node describes: it has a MIME type, and a length, a URI or a semantic.
fn item<'a>(node: Node<'a, '_>) -> Option<Item<'a>> {
    property(node, "Mime")?;
    let [length, uri, semantic] = ["Length", "DataURI", "Semantic"].map(|name| property(node, name));
    if length.is_none() && uri.is_none() && semantic.is_none() {
        return None;
    }
    let count = |text: Option<&str>| text.and_then(|text| text.trim().parse().ok()).unwrap_or(0);
    Some(Item { length: count(length), padding: count(property(node, "Padding")), uri, semantic })
}

/// The bytes of an item of the directory, whose first is the picture.
fn located<'a>(items: &[Item<'_>], index: usize, bytes: &'a [u8]) -> Option<&'a [u8]> {
    let Item { length, .. } = items[index];
    let between = |items: &[Item<'_>]| {
        items.iter().try_fold(0usize, |sum, item| sum.checked_add(item.length)?.checked_add(item.padding))
    };
    let picture_end = end_of_jpeg(bytes);
    let at = |start: Option<usize>| {
        let start = start?;
        let slice = bytes.get(start..start.checked_add(length)?)?;
        (length > 0 && is_picture(slice)).then_some(slice)
    };
    let from_picture = || {
        let padding = items.first().map_or(0, |first| first.padding);
        picture_end?.checked_add(padding)?.checked_add(between(items.get(1..index)?)?)
    };
    let from_end = || bytes.len().checked_sub(between(&items[index..])?);
    // Pictures behind the first, in order.
    let in_order = || {
        let rank = items[1..=index].iter().filter(|item| item.length > 0).count();
        let mut rest = &bytes[picture_end?..];
        for _ in 1..rank {
            let start = first_picture(rest)?;
            rest = &rest[end_of_picture(&rest[start..])? + start..];
        }
        let picture = &rest[first_picture(rest)?..];
        Some(&picture[..end_of_picture(picture).unwrap_or(picture.len())])
    };
    at(from_picture()).or_else(|| at(from_end())).or_else(|| if index > 0 { in_order() } else { None })
}

/// The position of the first picture.
fn first_picture(bytes: &[u8]) -> Option<usize> {
    let starts = |at: &usize| is_picture(&bytes[*at..]) && bytes.get(at + 2) != Some(&0);
    (0..bytes.len()).find(starts)
}

fn end_of_picture(bytes: &[u8]) -> Option<usize> {
    end_of_jpeg(bytes).or_else(|| end_of_png(bytes))
}
