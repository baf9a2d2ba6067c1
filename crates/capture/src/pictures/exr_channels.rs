//! Single channels of an OpenEXR file.
//!
//! Renderers write dozens of layers into one file; only the requested channels are kept in memory. The picture is the display window: data
//! outside it is dropped, and pixels without data are NaN. Channels of parts are called `part.channel` if their own name has no layer.

use crate::CaptureError;
use crate::files::whole_file::whole_file;
use exr::block::reader::ChunksReader;
use exr::meta::MetaData;
use exr::meta::attribute::SampleType;
use exr::prelude::{Vec2, f16};
use scene::LoadOptions;
use std::collections::HashSet;
use std::io::Cursor;
use std::panic::AssertUnwindSafe;
use std::path::Path;

/// The largest width and height of a window.
const LARGEST_SIDE: usize = 32768;

/// Layers that are the whole picture.
const PICTURES: [&str; 6] = ["combined", "image", "rgba", "rgb", "beauty", "composite"];

/// Channels of an image.
pub(crate) struct ExrChannels {
    pub size: [u32; 2],
    /// The requested channels, in their order; row 0 on top.
    pub channels: Vec<Vec<f32>>,
}

/// The names of the channels of an EXR.
pub(crate) fn exr_names(file: &Path, options: &LoadOptions) -> Result<Vec<String>, CaptureError> {
    Ok(exr_names_and_root(file, options)?.0)
}

/// The same, and the name of the first part, whose channels bear none; it may have none.
pub(crate) fn exr_names_and_root(
    file: &Path,
    options: &LoadOptions,
) -> Result<(Vec<String>, String), CaptureError> {
    let bytes = whole_file(file, options.max_memory / 2)?;
    guarded(file, || {
        let meta = meta(&bytes)?;
        let root = meta.headers[0].own_attributes.layer_name.as_ref();
        Ok((names(&meta), root.map(ToString::to_string).unwrap_or_default()))
    })
}

/// Reads the channels of these names, all of which must exist.
pub(crate) fn read_exr(
    file: &Path,
    channel_names: &[&str],
    options: &LoadOptions,
) -> Result<ExrChannels, CaptureError> {
    let bytes = whole_file(file, options.max_memory / 2)?;
    guarded(file, || decode(&bytes, channel_names, options))
}

/// The decoder is not ours: should it panic on a damaged file, that is an error like any other.
fn guarded<T>(file: &Path, read: impl FnOnce() -> Result<T, String>) -> Result<T, CaptureError> {
    let result = std::panic::catch_unwind(AssertUnwindSafe(read));
    let result = result.unwrap_or_else(|_| Err("its content contradicts itself".into()));
    result.map_err(|why| CaptureError::malformed(file, "EXR", why))
}

fn meta(bytes: &[u8]) -> Result<MetaData, String> {
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(|error| error.to_string())?;
    if meta.headers.is_empty() {
        return Err("has no part".into());
    }
    if meta.headers.iter().any(|header| header.deep) {
        return Err("has deep pixels, which cannot be read".into());
    }
    Ok(meta)
}

fn names(meta: &MetaData) -> Vec<String> {
    names_by_part(meta).concat()
}

/// The names of the channels of each part among those of all parts. Channels of the first part keep their own, unless the part is named as a
/// pass of a layer (`ViewLayer.Combined`) or as depth. Those of other parts bear the part's name, unless they begin with it, or are in a layer
/// that no part before has.
fn names_by_part(meta: &MetaData) -> Vec<Vec<String>> {
    let mut earlier = HashSet::new();
    let mut all = Vec::new();
    for (part, header) in meta.headers.iter().enumerate() {
        let own: Vec<String> = header.channels.list.iter().map(|channel| channel.name.to_string()).collect();
        let layer = header.own_attributes.layer_name.as_ref().map(ToString::to_string);
        let is_prefixed = |layer: &str, channel: &str| match (channel.contains('.'), part) {
            (false, 0) => is_picture_pass(layer) || layer.to_lowercase().contains("depth"),
            (false, _) => true,
            (true, _) => {
                let begins_so = channel.strip_prefix(layer).is_some_and(|rest| rest.starts_with('.'));
                !begins_so && earlier.contains(channel)
            }
        };
        let full = |channel: &String| match &layer {
            Some(layer) if is_prefixed(layer, channel) => format!("{layer}.{channel}"),
            _ => channel.clone(),
        };
        all.push(own.iter().map(full).collect());
        earlier.extend(own);
    }
    all
}

/// Whether a part is named as the picture of a layer.
fn is_picture_pass(part: &str) -> bool {
    part.rsplit_once('.').is_some_and(|(_, pass)| PICTURES.contains(&pass.to_lowercase().as_str()))
}

fn decode(bytes: &[u8], channel_names: &[&str], options: &LoadOptions) -> Result<ExrChannels, String> {
    let text = |error: exr::error::Error| error.to_string();
    let meta = meta(bytes)?;
    let display = meta.headers[0].shared_attributes.display_window;
    let [width, height] = [display.size.width(), display.size.height()];
    for header in &meta.headers {
        let window = header.layer_size;
        let largest = window.width().max(window.height()).max(width).max(height);
        if largest > LARGEST_SIDE {
            return Err(format!("has a window of more than {LARGEST_SIDE} px a side"));
        }
    }
    let (pixels, limit) = ((width * height) as u64, options.max_texels.min(options.max_memory / 32));
    if pixels == 0 || pixels > limit {
        return Err(format!("is of {width} × {height} px; there must be at least one, and at most {limit}"));
    }
    // The position of each requested channel: its part, and its index in the part.
    let (all_names, mut places) = (names_by_part(&meta), Vec::new());
    for name in channel_names {
        let location = all_names.iter().enumerate().find_map(|(part, names)| {
            names.iter().position(|other| other == name).map(|channel| (part, channel))
        });
        let (part, channel) = location.ok_or_else(|| format!("has no channel {name}"))?;
        if meta.headers[part].channels.list[channel].sampling != Vec2(1, 1) {
            return Err(format!("its channel {name} is subsampled"));
        }
        places.push((part, channel));
    }
    let mut channels = vec![vec![f32::NAN; width * height]; channel_names.len()];
    let is_needed = |part: usize| places.iter().any(|(index, _)| *index == part);
    let reader = exr::block::read(Cursor::new(bytes), false).map_err(text)?;
    let chunks = reader
        .filter_chunks(false, |_, tile, block| is_needed(block.layer) && tile.level_index == Vec2(0, 0))
        .map_err(text)?;
    let read = chunks.decompress_sequential(false, |meta, block| {
        let header = &meta.headers[block.index.layer];
        let corner = header.own_attributes.layer_position - display.position;
        for line in block.lines(&header.channels) {
            let at = line.location;
            for (place, channel) in places.iter().zip(&mut channels) {
                if *place != (at.layer, at.channel) {
                    continue;
                }
                let row = at.position.y() as i64 + i64::from(corner.y());
                let start = at.position.x() as i64 + i64::from(corner.x());
                let values: exr::error::Result<Vec<f32>> = match header.channels.list[at.channel].sample_type
                {
                    SampleType::F16 => line.read_samples::<f16>().map(|v| v.map(f16::to_f32)).collect(),
                    SampleType::F32 => line.read_samples::<f32>().collect(),
                    SampleType::U32 => line.read_samples::<u32>().map(|v| v.map(|v| v as f32)).collect(),
                };
                let values = values?;
                for (value, column) in values.into_iter().zip(start..) {
                    if (0..height as i64).contains(&row) && (0..width as i64).contains(&column) {
                        channel[row as usize * width + column as usize] = value;
                    }
                }
            }
        }
        Ok(())
    });
    read.map_err(text)?;
    Ok(ExrChannels { size: [width as u32, height as u32], channels })
}

/// The colour channels, red first: those without a layer, or of the layer that is the picture; `None` if there are
/// none.
pub(crate) fn color_channels(names: &[String]) -> Option<[String; 3]> {
    let layer = |name: &str| {
        let (layer, channel) = name.rsplit_once('.').unwrap_or(("", name));
        channel.eq_ignore_ascii_case("r").then(|| layer.to_owned())
    };
    let rank = |layer: &String| {
        let last = layer.rsplit('.').next().unwrap_or_default().to_lowercase();
        let layer_rank = PICTURES.iter().position(|picture| last == *picture).map(|rank| rank + 1);
        if layer.is_empty() { Some(0) } else { layer_rank }
    };
    let channels_in = |layer: &String| {
        let named = |channel: &str| {
            let full = if layer.is_empty() { channel.to_owned() } else { format!("{layer}.{channel}") };
            names.iter().find(|name| name.eq_ignore_ascii_case(&full)).cloned()
        };
        Some([named("R")?, named("G")?, named("B")?])
    };
    let mut layers: Vec<_> =
        names.iter().filter_map(|name| layer(name)).filter(|layer| rank(layer).is_some()).collect();
    layers.sort_by_key(rank);
    layers.iter().find_map(channels_in)
}

/// The depth channel: `Z`; `depth.Z`, `ViewLayer.Depth.Z`, `Depth.V` …; `depth`, `ZDepth`; `None` if there is none.
pub(crate) fn depth_channel(names: &[String]) -> Option<String> {
    let rank = |name: &str| {
        let lower = name.to_lowercase();
        let (layer, channel) = lower.rsplit_once('.').unwrap_or(("", &lower));
        let last = layer.rsplit('.').next().unwrap_or_default();
        let is_depth = last.contains("depth") || last == "z" || last == "zdepth";
        match () {
            () if lower == "z" => Some(0),
            () if is_depth && channel == "z" => Some(1),
            () if is_depth && ["v", "y", "r", "d", "depth"].contains(&channel) => Some(2),
            () if ["depth", "zdepth", "z"].contains(&channel)
                && (channel != "z" || !is_vector(names, name)) =>
            {
                Some(3)
            }
            () => None,
        }
    };
    names.iter().filter_map(|name| Some((rank(name)?, name))).min().map(|(_, name)| name.clone())
}

/// Whether a channel `….Z` is that of a position or normal.
fn is_vector(names: &[String], name: &str) -> bool {
    let layer = &name[..name.len() - 1];
    names.iter().any(|other| other.eq_ignore_ascii_case(&format!("{layer}x")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn owned(names: &[&str]) -> Vec<String> {
        names.iter().map(|name| name.to_string()).collect()
    }

    #[test]
    fn the_names_that_programs_use() {
        for (names, color, depth) in [
            (&["A", "B", "G", "R", "Z"][..], Some("R"), Some("Z")),
            (&["R", "G", "B", "depth.Z"], Some("R"), Some("depth.Z")),
            (
                &[
                    "ViewLayer.Combined.R",
                    "ViewLayer.Combined.G",
                    "ViewLayer.Combined.B",
                    "ViewLayer.Depth.Z",
                    "ViewLayer.Normal.X",
                    "ViewLayer.Normal.Z",
                ],
                Some("ViewLayer.Combined.R"),
                Some("ViewLayer.Depth.Z"),
            ),
            (&["Image.R", "Image.G", "Image.B", "Depth.V"], Some("Image.R"), Some("Depth.V")),
            (&["r", "g", "b", "ZDepth"], Some("r"), Some("ZDepth")),
            (&["R", "G", "B", "N.X", "N.Y", "N.Z"], Some("R"), None),
            (&["R", "G", "B", "P.x", "P.y", "P.z", "ZDepth.Z"], Some("R"), Some("ZDepth.Z")),
            (&["Depth.R", "Depth.G", "Depth.B"], None, Some("Depth.R")),
            (&["diffuse.R", "diffuse.G", "diffuse.B"], None, None),
        ] {
            let names = owned(names);
            assert_eq!(color_channels(&names).map(|[red, ..]| red).as_deref(), color, "{names:?}");
            assert_eq!(depth_channel(&names).as_deref(), depth, "{names:?}");
        }
    }
}
