//! OpenEXR files as named channels of floats.

use crate::ProjectError;
use crate::disk::{read_bytes, write_bytes};
use exr::meta::attribute::{AttributeValue, Text};
use exr::prelude as ox;
use exr::prelude::{ReadChannels, ReadLayers, WritableImage};
use half::f16;
use std::collections::BTreeMap;
use std::io::Cursor;
use std::panic::AssertUnwindSafe;
use std::path::Path;

/// The widest and highest image that is read.
const LARGEST_SIDE: usize = 32768;

/// The most samples of all channels together that are read: 4 GiB as floats.
const MOST_SAMPLES: usize = 1 << 30;

/// An image as OpenEXR holds it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct ExrImage {
    pub width: u32,
    pub height: u32,
    /// Samples by channel name, row 0 on top; channels of a named layer are called `layer.channel`.
    pub channels: BTreeMap<String, Vec<f32>>,
    /// The attributes that are no part of the format, as far as they are text or numbers.
    pub attributes: BTreeMap<String, ExrAttribute>,
}

/// An attribute of an image.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum ExrAttribute {
    Text(String),
    Number(f64),
}

/// How samples are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ExrSamples {
    Float,
    Half,
}

/// Reads an image.
pub(crate) fn read_exr(file: &Path) -> Result<ExrImage, ProjectError> {
    decode(&read_bytes(file)?).map_err(|problem| {
        ProjectError::content(
            file,
            format!("is not a readable EXR: {problem}"),
            "write it again, or take another copy",
        )
    })
}

/// Writes an image, losslessly compressed.
pub(crate) fn write_exr(file: &Path, image: &ExrImage, samples: ExrSamples) -> Result<(), ProjectError> {
    let bytes = encode(image, samples).map_err(|error| ProjectError::Write {
        file: file.to_owned(),
        source: std::io::Error::other(error),
    })?;
    write_bytes(file, &bytes)
}

fn decode(bytes: &[u8]) -> Result<ExrImage, String> {
    // The decoder is not ours: should it panic on a damaged file, that is an error like any other.
    std::panic::catch_unwind(AssertUnwindSafe(|| decode_unguarded(bytes)))
        .unwrap_or_else(|_| Err("its content contradicts itself".to_string()))
}

fn decode_unguarded(bytes: &[u8]) -> Result<ExrImage, String> {
    let text = |error: exr::error::Error| error.to_string();
    let meta = exr::meta::MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(text)?;
    let mut samples = 0usize;
    for header in &meta.headers {
        let size = header.layer_size;
        if size.width() > LARGEST_SIDE || size.height() > LARGEST_SIDE {
            return Err(format!(
                "it has {}×{} pixels, more than {LARGEST_SIDE} a side",
                size.width(),
                size.height()
            ));
        }
        if header.channels.list.iter().any(|channel| channel.sampling != ox::Vec2(1, 1)) {
            return Err("a channel is subsampled".to_string());
        }
        samples = samples.saturating_add(size.area().saturating_mul(header.channels.list.len()));
    }
    if samples > MOST_SAMPLES {
        return Err("it is larger than 4 GiB".to_string());
    }
    // Not in parallel: a panic on a worker thread could not be caught.
    let reader = ox::read().no_deep_data().largest_resolution_level().all_channels().all_layers();
    let read = reader.all_attributes().non_parallel().from_buffered(Cursor::new(bytes)).map_err(text)?;
    let first = read.layer_data.first().ok_or("it has no layer")?;
    let size = first.size;
    let mut image =
        ExrImage { width: size.width() as u32, height: size.height() as u32, ..ExrImage::default() };
    let attributes = read.attributes.other.iter().chain(&first.attributes.other);
    image.attributes =
        attributes.filter_map(|(name, value)| Some((name.to_string(), attribute(value)?))).collect();
    for (index, layer) in read.layer_data.iter().enumerate() {
        if layer.size != size {
            continue;
        }
        let prefix = match &layer.attributes.layer_name {
            Some(name) if index > 0 => format!("{name}."),
            _ => String::new(),
        };
        for channel in &layer.channel_data.list {
            let values: Vec<f32> = channel.sample_data.values_as_f32().collect();
            if values.len() != size.area() {
                return Err(format!("channel {} is incomplete", channel.name));
            }
            image.channels.entry(format!("{prefix}{}", channel.name)).or_insert(values);
        }
    }
    Ok(image)
}

fn attribute(value: &AttributeValue) -> Option<ExrAttribute> {
    match value {
        AttributeValue::Text(text) => Some(ExrAttribute::Text(text.to_string())),
        AttributeValue::I32(number) => Some(ExrAttribute::Number(*number as f64)),
        AttributeValue::F32(number) => Some(ExrAttribute::Number(*number as f64)),
        AttributeValue::F64(number) => Some(ExrAttribute::Number(*number)),
        _ => None,
    }
}

fn encode(image: &ExrImage, samples: ExrSamples) -> Result<Vec<u8>, String> {
    let channel = |(name, values): (&String, &Vec<f32>)| {
        let data = match samples {
            ExrSamples::Float => ox::FlatSamples::F32(values.clone()),
            ExrSamples::Half => ox::FlatSamples::F16(values.iter().map(|&v| f16::from_f32(v)).collect()),
        };
        ox::AnyChannel::new(name.as_str(), data)
    };
    let channels = ox::AnyChannels::sort(image.channels.iter().map(channel).collect());
    let software_name = Some(Text::from("Focus Brush"));
    let mut attributes = ox::LayerAttributes { software_name, ..ox::LayerAttributes::default() };
    for (name, value) in &image.attributes {
        let value = match value {
            ExrAttribute::Text(text) => AttributeValue::Text(Text::from(text.as_str())),
            ExrAttribute::Number(number) => AttributeValue::F64(*number),
        };
        attributes.other.insert(Text::from(name.as_str()), value);
    }
    let size = (image.width as usize, image.height as usize);
    let layer = ox::Layer::new(size, attributes, ox::Encoding::SMALL_LOSSLESS, channels);
    let mut bytes = Cursor::new(Vec::new());
    ox::Image::from_layer(layer).write().to_buffered(&mut bytes).map_err(|error| error.to_string())?;
    Ok(bytes.into_inner())
}
