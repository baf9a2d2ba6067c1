//! OpenEXR files as named channels of floats.

use crate::ProjectError;
use crate::color_space::Chromaticities;
use crate::disk::{read_bytes, write_bytes};
use crate::openexr::header;
use crate::openexr::options::{ExrOptions, from_stored_chromaticities, to_half, to_stored_chromaticities};
use crate::openexr::window::Window;
use exr::meta::attribute::{AttributeValue, Text};
use exr::prelude as ox;
use exr::prelude::{ReadChannels, ReadLayers, WritableImage};
use std::collections::BTreeMap;
use std::io::Cursor;
use std::panic::AssertUnwindSafe;
use std::path::Path;

/// Maximum width and height of an image that is read.
const MAX_SIDE: usize = 32768;

/// Maximum number of samples of all channels together: 4 GiB as floats.
const MAX_SAMPLES: usize = 1 << 30;

/// Maximum number of samples, of all channels together, that lie in the display window but not in the file: 1 GiB as
/// floats, which a file of a few bytes could otherwise request.
const MAX_ABSENT_SAMPLES: usize = 1 << 28;

/// An OpenEXR image.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct ExrImage {
    pub width: u32,
    pub height: u32,
    /// Samples by channel name, row 0 on top; channels of all parts but the first are named `part.channel`.
    pub channels: BTreeMap<String, Vec<f32>>,
    /// The attributes that are not part of the format, if they are text or numbers.
    pub attributes: BTreeMap<String, ExrAttribute>,
    /// The primaries and white of its colours, if a file that is read gives them.
    pub chromaticities: Option<Chromaticities>,
}

/// An attribute of an image.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum ExrAttribute {
    Text(String),
    Number(f64),
}

/// Reads an image within its display window: pixels outside it are dropped, and where the file has none, a channel
/// has the value that `absent` returns for its name.
pub(crate) fn read_exr(file: &Path, absent: fn(&str) -> f32) -> Result<ExrImage, ProjectError> {
    decode(&read_bytes(file)?, absent).map_err(|problem| {
        ProjectError::content(
            file,
            format!("is not a readable EXR: {problem}"),
            "write it again, or take another copy",
        )
    })
}

/// Writes an image.
pub(crate) fn write_exr(file: &Path, image: ExrImage, form: ExrOptions) -> Result<(), ProjectError> {
    let bytes = encode(image, form).map_err(|error| ProjectError::Write {
        file: file.to_owned(),
        source: std::io::Error::other(error),
    })?;
    write_bytes(file, &bytes)
}

fn decode(bytes: &[u8], absent: fn(&str) -> f32) -> Result<ExrImage, String> {
    // The decoder is third-party code: should it panic on a damaged file, report that as an error.
    std::panic::catch_unwind(AssertUnwindSafe(|| decode_unguarded(bytes, absent)))
        .unwrap_or_else(|_| Err("its content contradicts itself".to_string()))
}

fn decode_unguarded(bytes: &[u8], absent: fn(&str) -> f32) -> Result<ExrImage, String> {
    let text = |error: exr::error::Error| error.to_string();
    let meta = exr::meta::MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(text)?;
    if let Some(window) = header::empty_window(bytes) {
        return Err(format!("its {window} holds no pixel"));
    }
    check_size(&meta)?;
    // Not in parallel: a panic on a worker thread could not be caught.
    let reader = ox::read().no_deep_data().largest_resolution_level().all_channels().all_layers();
    let read = reader.all_attributes().non_parallel().from_buffered(Cursor::new(bytes)).map_err(text)?;
    let display = Window::from_bounds(read.attributes.display_window);
    let [width, height] = display.size;
    let chromaticities = read.attributes.chromaticities.map(from_stored_chromaticities);
    let (width, height) = (width as u32, height as u32);
    let mut image = ExrImage { width, height, chromaticities, ..ExrImage::default() };
    let part_attributes = read.layer_data.iter().flat_map(|part| &part.attributes.other);
    for (name, value) in read.attributes.other.iter().chain(part_attributes) {
        if let Some(value) = readable_attribute(value) {
            image.attributes.entry(name.to_string()).or_insert(value);
        }
    }
    for (index, part) in read.layer_data.into_iter().enumerate() {
        let data = Window {
            corner: [part.attributes.layer_position.x(), part.attributes.layer_position.y()],
            size: [part.size.width(), part.size.height()],
        };
        for channel in part.channel_data.list {
            let values: Vec<f32> = channel.sample_data.values_as_f32().collect();
            if values.len() != part.size.area() {
                return Err(format!("channel {} is incomplete", channel.name));
            }
            let name = match &part.attributes.layer_name {
                Some(part) if index > 0 => full_channel_name(&part.to_string(), &channel.name.to_string()),
                _ => channel.name.to_string(),
            };
            let absent = absent(&name);
            image.channels.entry(name).or_insert_with(|| display.crop(data, values, absent));
        }
    }
    Ok(image)
}

/// The name of a part's channel among those of all parts. Some programs write it in full, others omit the part's
/// name.
fn full_channel_name(part: &str, channel: &str) -> String {
    if channel.contains('.') { channel.to_string() } else { format!("{part}.{channel}") }
}

/// Rejects images that are too large or subsampled.
fn check_size(meta: &exr::meta::MetaData) -> Result<(), String> {
    let (mut samples, mut absent) = (0, 0);
    for header in &meta.headers {
        let (data, display) = (
            Window::from_bounds(header.data_window()),
            Window::from_bounds(header.shared_attributes.display_window),
        );
        for window in [data, display] {
            let [width, height] = window.size;
            if width.max(height) > MAX_SIDE {
                return Err(format!(
                    "it has a window of {width}×{height} pixels, more than {MAX_SIDE} a side"
                ));
            }
        }
        if let Some(channel) = header.channels.list.iter().find(|c| c.sampling != ox::Vec2(1, 1)) {
            return Err(format!("channel {} is subsampled", channel.name));
        }
        let channels = header.channels.list.len();
        samples += channels.saturating_mul(data.area().max(display.area()));
        absent += channels.saturating_mul(display.area().saturating_sub(display.shared_area(data)));
    }
    if samples > MAX_SAMPLES {
        return Err("it is larger than 4 GiB".to_string());
    }
    if absent > MAX_ABSENT_SAMPLES {
        return Err("nearly all of its display window lies outside its data window".to_string());
    }
    Ok(())
}

fn readable_attribute(value: &AttributeValue) -> Option<ExrAttribute> {
    match value {
        AttributeValue::Text(text) => Some(ExrAttribute::Text(text.to_string())),
        AttributeValue::I32(number) => Some(ExrAttribute::Number(*number as f64)),
        AttributeValue::F32(number) => Some(ExrAttribute::Number(*number as f64)),
        AttributeValue::F64(number) => Some(ExrAttribute::Number(*number)),
        _ => None,
    }
}

fn encode(image: ExrImage, form: ExrOptions) -> Result<Vec<u8>, String> {
    let channel = |(name, values): (String, Vec<f32>)| {
        let data = match form.samples {
            samples if samples.is_half(&name) => {
                ox::FlatSamples::F16(values.into_iter().map(to_half).collect())
            }
            _ => ox::FlatSamples::F32(values),
        };
        ox::AnyChannel::new(name.as_str(), data)
    };
    let channels = ox::AnyChannels::sort(image.channels.into_iter().map(channel).collect());
    let size = [image.width, image.height];
    let (image_attributes, layer_attributes) = all_attributes(size, &image.attributes, &form)?;
    let size = (size[0] as usize, size[1] as usize);
    let layer = ox::Layer::new(size, layer_attributes, form.compression.encoding(), channels);
    let mut bytes = Cursor::new(Vec::new());
    let written = ox::Image::new(image_attributes, layer).write().to_buffered(&mut bytes);
    written.map_err(|error| error.to_string())?;
    let mut bytes = bytes.into_inner();
    header::sort_attributes(&mut bytes);
    Ok(bytes)
}

/// The attributes of an image of this width and height, and of its only part: the requested ones and those of `form`.
pub(crate) fn all_attributes(
    size: [u32; 2],
    requested: &BTreeMap<String, ExrAttribute>,
    form: &ExrOptions,
) -> Result<(ox::ImageAttributes, ox::LayerAttributes), String> {
    let overscan = form.overscan as i32;
    let mut attributes = ox::LayerAttributes {
        software_name: Some(Text::from("Focus Brush")),
        layer_position: ox::Vec2(-overscan, -overscan),
        ..ox::LayerAttributes::default()
    };
    let mut write = |name: &str, value| attributes.other.insert(Text::from(name), value);
    for (name, value) in requested {
        let value = match value {
            ExrAttribute::Text(value) => AttributeValue::Text(attribute_text(name, value)?),
            ExrAttribute::Number(number) => AttributeValue::F64(*number),
        };
        write(name, value);
    }
    if let Some(space) = form.color_space {
        write("colorInteropID", AttributeValue::Text(Text::from(space.interop_id())));
    }
    let frame = size.map(|side| side.saturating_sub(2 * form.overscan) as usize);
    let chromaticities = form.color_space.map(|space| to_stored_chromaticities(space.chromaticities()));
    let image_attributes =
        ox::ImageAttributes { chromaticities, ..ox::ImageAttributes::with_size((frame[0], frame[1])) };
    Ok((image_attributes, attributes))
}

/// An attribute's text, if it has only characters that the format can hold.
fn attribute_text(name: &str, value: &str) -> Result<Text, String> {
    Text::new_or_none(value).ok_or_else(|| format!("attribute {name} has a character beyond U+00FF"))
}
