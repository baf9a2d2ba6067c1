//! How an OpenEXR file is written: its compression, which channels are half, its windows, whose colours it has.

use crate::color_space::{Chromaticities, ColorSpace};
use exr::meta::attribute::Chromaticities as StoredChromaticities;
use exr::prelude as ox;
use glam::DVec2;
use half::f16;

/// How pixels are compressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Compression {
    /// Deflate, each line by itself: what reads a file line by line wants.
    Zips,
    /// Deflate, 16 lines together.
    #[default]
    Zip,
    /// Wavelets, 32 lines together: smaller where there is grain.
    Piz,
    /// Cosines, 32 lines together: red, green and blue lose what is hardly seen.
    Dwaa,
    /// None.
    None,
}

impl Compression {
    /// All of them, by the names that the command line knows.
    pub const ALL: [(&'static str, Self); 5] = [
        ("zips", Self::Zips),
        ("zip", Self::Zip),
        ("piz", Self::Piz),
        ("dwaa", Self::Dwaa),
        ("none", Self::None),
    ];

    /// The one of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(candidate, _)| *candidate == name).map(|(_, compression)| *compression)
    }

    /// Whether pixels are read as they were written.
    pub fn is_lossless(self) -> bool {
        self != Self::Dwaa
    }

    pub(crate) fn encoding(self) -> ox::Encoding {
        let compression = match self {
            Self::Zips => ox::Compression::ZIP1,
            Self::Zip => ox::Compression::ZIP16,
            Self::Piz => ox::Compression::PIZ,
            // At the level that others write, too.
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
    /// As half where that suffices, told by the channel's name.
    HalfIf(fn(&str) -> bool),
}

impl ExrSamples {
    /// Whether a channel is stored as half.
    pub fn is_half(self, channel: &str) -> bool {
        matches!(self, Self::HalfIf(suffices) if suffices(channel))
    }
}

/// How an image is written.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ExrOptions {
    pub compression: Compression,
    pub samples: ExrSamples,
    /// How many pixels on each side lie around the picture: the data window is that much larger than the display window.
    pub overscan: u32,
    /// Whose its colours are, if that is told.
    pub color_space: Option<ColorSpace>,
}

/// As the encoder has them.
pub(crate) fn to_stored_chromaticities(chromaticities: Chromaticities) -> StoredChromaticities {
    let place = |at: DVec2| ox::Vec2(at.x as f32, at.y as f32);
    let Chromaticities { red, green, blue, white } = chromaticities;
    StoredChromaticities { red: place(red), green: place(green), blue: place(blue), white: place(white) }
}

/// As the decoder has them.
pub(crate) fn from_stored_chromaticities(stored: StoredChromaticities) -> Chromaticities {
    let place = |at: ox::Vec2<f32>| DVec2::new(at.0.into(), at.1.into());
    let StoredChromaticities { red, green, blue, white } = stored;
    Chromaticities { red: place(red), green: place(green), blue: place(blue), white: place(white) }
}

/// The nearest half; light that none holds is as bright as one can be.
pub(crate) fn to_half(value: f32) -> f16 {
    let most = f16::MAX.to_f32();
    f16::from_f32(if value.is_finite() { value.clamp(-most, most) } else { value })
}
