//! Writing OpenEXR files with only some rows at a time in memory.

use crate::ProjectError;
use crate::openexr::header;
use crate::openexr::image::{ExrAttribute, all_attributes};
use crate::openexr::options::{ExrOptions, to_half};
use atomic_file::AtomicFile;
use exr::block::BlockIndex;
use exr::image::write::channels::{ChannelsWriter, WritableChannels};
use exr::math::RoundingMode;
use exr::meta::attribute::{ChannelList, LevelMode};
use exr::meta::header::Header;
use exr::prelude as ox;
use exr::prelude::WritableImage;
use std::collections::{BTreeMap, BTreeSet};
use std::io::{BufWriter, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// An image without its samples.
pub(crate) struct ExrHead {
    /// Columns and rows.
    pub size: [u32; 2],
    /// The names of its channels.
    pub channels: BTreeSet<String>,
    pub attributes: BTreeMap<String, ExrAttribute>,
    pub form: ExrOptions,
}

/// Samples of some rows by channel name, row by row.
type Band = BTreeMap<String, Vec<f32>>;

/// Writes an image; `band` returns the samples of the given rows and is called from top to bottom. The file is
/// replaced only once it is complete.
pub(crate) fn write_exr_in_bands<E: From<ProjectError> + Send>(
    file: &Path,
    head: &ExrHead,
    band: impl FnMut(Range<u32>) -> Result<Band, E> + Send,
) -> Result<(), E> {
    let error = |source| ProjectError::Write { file: file.to_owned(), source };
    let other = |problem: String| error(std::io::Error::other(problem));
    let (image_attributes, layer_attributes) =
        all_attributes(head.size, &head.attributes, &head.form).map_err(other)?;
    let channels = BandChannels { head, source: Mutex::new(BandSource { band, failed: None }) };
    let size = (head.size[0] as usize, head.size[1] as usize);
    let layer = ox::Layer::new(size, layer_attributes, head.form.compression.encoding(), channels);
    let image = ox::Image::new(image_attributes, layer);
    let mut new = AtomicFile::create(file).map_err(error)?;
    let written = image.write().to_buffered(BufWriter::new(&mut new));
    let source = image.layer_data.channel_data.source.into_inner().unwrap_or_else(PoisonError::into_inner);
    if let Some(failed) = source.failed {
        return Err(failed);
    }
    written.map_err(|problem| match problem {
        exr::error::Error::Io(source) => error(source),
        problem => other(problem.to_string()),
    })?;
    sort_attributes(&mut new).and_then(|()| new.commit()).map_err(error)?;
    Ok(())
}

/// [`header::sort_attributes`](super::header::sort_attributes) in a file.
fn sort_attributes(file: &mut (impl Read + Write + Seek)) -> std::io::Result<()> {
    /// Maximum length of a header, whose longest attribute is a list of names.
    const MAX_HEADER_BYTES: u64 = 64 << 20;
    file.seek(SeekFrom::Start(0))?;
    let mut bytes = Vec::new();
    Read::by_ref(file).take(MAX_HEADER_BYTES).read_to_end(&mut bytes)?;
    header::sort_attributes(&mut bytes);
    file.seek(SeekFrom::Start(0))?;
    file.write_all(&bytes)?;
    file.seek(SeekFrom::End(0)).map(|_| ())
}

/// Channels whose samples are requested band by band.
struct BandChannels<'a, F, E> {
    head: &'a ExrHead,
    source: Mutex<BandSource<F, E>>,
}

/// The source of the samples, and its error if it failed.
struct BandSource<F, E> {
    band: F,
    failed: Option<E>,
}

impl<'slf, F, E> WritableChannels<'slf> for BandChannels<'_, F, E>
where
    F: FnMut(Range<u32>) -> Result<Band, E> + Send + 'slf,
    E: Send + 'slf,
    Self: 'slf,
{
    type Writer = &'slf Self;

    fn infer_channel_list(&self) -> ChannelList {
        let channel = |name: &String| {
            let samples = match self.head.form.samples.is_half(name) {
                true => ox::FlatSamples::F16(Vec::new()),
                false => ox::FlatSamples::F32(Vec::new()),
            };
            ox::AnyChannel::new(name.as_str(), samples)
        };
        ox::AnyChannels::sort(self.head.channels.iter().map(channel).collect()).infer_channel_list()
    }

    fn infer_level_modes(&self) -> (LevelMode, RoundingMode) {
        (LevelMode::Singular, RoundingMode::Down)
    }

    fn create_writer(&'slf self, _header: &Header) -> Self::Writer {
        self
    }
}

impl<F, E> ChannelsWriter for &BandChannels<'_, F, E>
where
    F: FnMut(Range<u32>) -> Result<Band, E> + Send,
    E: Send,
{
    fn extract_uncompressed_block(&self, header: &Header, block: BlockIndex) -> Vec<u8> {
        let (width, rows) = (block.pixel_size.width(), block.pixel_size.height());
        let first = block.pixel_position.y() as u32;
        let mut bytes = Vec::with_capacity(width * rows * header.channels.bytes_per_pixel);
        let mut source = self.source.lock().unwrap_or_else(PoisonError::into_inner);
        let BandSource { band, failed } = &mut *source;
        let band_values = match failed {
            Some(_) => Band::new(),
            None => band(first..first + rows as u32).unwrap_or_else(|error| {
                *failed = Some(error);
                Band::new()
            }),
        };
        for row in 0..rows {
            for channel in &header.channels.list {
                let name = channel.name.to_string();
                let Some(line) =
                    band_values.get(&name).and_then(|samples| samples.get(row * width..(row + 1) * width))
                else {
                    bytes.resize(bytes.len() + width * channel.sample_type.bytes_per_sample(), 0);
                    continue;
                };
                // The encoder expects native byte order.
                if self.head.form.samples.is_half(&name) {
                    bytes.extend(line.iter().flat_map(|value| to_half(*value).to_ne_bytes()));
                } else {
                    bytes.extend(line.iter().flat_map(|value| value.to_ne_bytes()));
                }
            }
        }
        bytes
    }
}
