//! Options of writing an OpenEXR file: compression, which channels are half, windows, colour space.

use crate::color_space::{Chromaticities, ColorSpace};
use exr::meta::attribute::Chromaticities as StoredChromaticities;
use exr::prelude as ox;
use glam::DVec2;
use half::f16;

/// How pixels are compressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Compression {
    /// Deflate, each line by itself: best for programs that read line by line.
    Zips,
    /// Deflate, 16 lines together.
    #[default]
    Zip,
    /// Wavelets, 32 lines together: smaller for grainy pictures.
    Piz,
    /// Cosines, 32 lines together: lossy, red, green and blue lose what is hardly visible.
    Dwaa,
    /// None.
    None,
}

impl Compression {
    /// All of them, with their names on the command line.
    pub const ALL: [(&'static str, Self); 5] = [
        ("zips", Self::Zips),
        ("zip", Self::Zip),
        ("piz", Self::Piz),
        ("dwaa", Self::Dwaa),
        ("none", Self::None),
    ];

    /// The compression with this name on the command line; `None` if there is none.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(candidate, _)| *candidate == name).map(|(_, compression)| *compression)
    }

    /// Whether pixels are read back exactly.
    pub fn is_lossless(self) -> bool {
        self != Self::Dwaa
    }

    pub(crate) fn encoding(self) -> ox::Encoding {
        let compression = match self {
            Self::Zips => ox::Compression::ZIP1,
            Self::Zip => ox::Compression::ZIP16,
            Self::Piz => ox::Compression::PIZ,
            // At the level that other programs use.
            Self::Dwaa => ox::Compression::DWAA(None),
            Self::None => ox::Compression::Uncompressed,
        };
        ox::Encoding { compression, ..ox::Encoding::SMALL_LOSSLESS }
    }
}

/// How samples are stored.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) enum ExrSamples {
    #[default]
    Float,
    /// As half for the channels, by name, for which that suffices.
    HalfIf(fn(&str) -> bool),
}

impl ExrSamples {
    /// Whether a channel with this name is stored in 16-bit floats; otherwise in 32-bit floats.
    pub fn is_half(self, channel: &str) -> bool {
        matches!(self, Self::HalfIf(suffices) if suffices(channel))
    }
}

/// How an image is written.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ExrOptions {
    pub compression: Compression,
    pub samples: ExrSamples,
    /// Number of pixels around the picture on each side: the data window is larger than the display window by this
    /// much.
    pub overscan: u32,
    /// Its colour space, if it is to be declared.
    pub color_space: Option<ColorSpace>,
}

/// In the encoder's type.
pub(crate) fn to_stored_chromaticities(chromaticities: Chromaticities) -> StoredChromaticities {
    let place = |at: DVec2| ox::Vec2(at.x as f32, at.y as f32);
    let Chromaticities { red, green, blue, white } = chromaticities;
    StoredChromaticities { red: place(red), green: place(green), blue: place(blue), white: place(white) }
}

/// From the decoder's type.
pub(crate) fn from_stored_chromaticities(stored: StoredChromaticities) -> Chromaticities {
    let place = |at: ox::Vec2<f32>| DVec2::new(at.0.into(), at.1.into());
    let StoredChromaticities { red, green, blue, white } = stored;
    Chromaticities { red: place(red), green: place(green), blue: place(blue), white: place(white) }
}

/// The nearest half; finite values beyond its range are clamped to it.
pub(crate) fn to_half(value: f32) -> f16 {
    let most = f16::MAX.to_f32();
    f16::from_f32(if value.is_finite() { value.clamp(-most, most) } else { value })
}
