//! How light is solved for and looked up: settings that a scene's file does not have.

use slf::Scattering;

/// Where light from photographs is sampled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PhotoLookup {
    /// At the texels of an atlas, to which the photographs are resampled.
    #[default]
    Texels,
    /// In the photographs themselves, separately for each point.
    Direct,
}

impl PhotoLookup {
    /// All variants with their names.
    pub const ALL: [(&str, Self); 2] = [("texels", Self::Texels), ("direct", Self::Direct)];

    /// The variant with this name on the command line; `None` if there is none.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(candidate, _)| *candidate == name).map(|(_, lookup)| *lookup)
    }
}

/// How the light of a scene is modelled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LightOptions {
    /// How often rough gloss scatters within a surface.
    pub scattering: Scattering,
    /// Where light from photographs is looked up.
    pub photo_lookup: PhotoLookup,
}

/// How accurately light is to be solved for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightQuality {
    /// Accurately enough for a picture that is soon replaced; cached light may be better.
    Rough,
    /// From the irradiance that is cached for every camera: fast, with the cache's bias.
    #[default]
    Fine,
    /// By paths with the cached irradiance as a control variate: unbiased, with noise that falls with the square root of their number.
    Refined {
        /// Paths per surface point; a pixel shades four points.
        passes: u32,
    },
}

impl LightQuality {
    /// Light for a picture that is refined by so many passes; 0: not at all.
    pub fn from_passes(passes: u32) -> Self {
        if passes == 0 { Self::Fine } else { Self::Refined { passes } }
    }
}
