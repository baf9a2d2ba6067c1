//! How light is solved for and looked up: what a scene's file does not say.

use slf::Scattering;

/// Where the light of photographs is sampled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PhotoLookup {
    /// At the texels of an atlas, to which the photographs were resampled.
    #[default]
    Texels,
    /// In the photographs themselves, for each point.
    Direct,
}

impl PhotoLookup {
    /// All, with their names.
    pub const ALL: [(&str, Self); 2] = [("texels", Self::Texels), ("direct", Self::Direct)];

    /// The one of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(candidate, _)| *candidate == name).map(|(_, lookup)| *lookup)
    }
}

/// How the light of a scene is modelled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LightOptions {
    /// How often rough gloss scatters within a surface.
    pub scattering: Scattering,
    /// Where the light of photographs is looked up.
    pub photo_lookup: PhotoLookup,
}

/// How well light is to be solved for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightQuality {
    /// Well enough for a picture that is soon replaced; better, if better light is cached.
    Rough,
    /// As well as the cache tells it for every camera: at once, with the bias of what is cached.
    #[default]
    Fine,
    /// By paths that use what is cached as a control variate: unbiased, with noise that falls with the root of their number.
    Refined {
        /// Each is a path for a surface point that is shaded alone, four a pixel.
        passes: u32,
    },
}
