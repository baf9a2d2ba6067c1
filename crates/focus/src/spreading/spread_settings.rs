//! How the strokes of a layer are spread.

use crate::FocusMap;
use serde::{Deserialize, Serialize};
use spread::{GREATEST_REACH, LEAST_REACH};

/// The settings of a layer that is spread.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SpreadSettings {
    /// How far the strokes spread, in texels of the atlas across even surface, in [2, 32768]. Edges hold them up the
    /// longer, the clearer they are.
    pub reach: f64,
    /// How soft the borders are: 0 hard, where outcomes are equally likely; 1 as wide as the probabilities change. In
    /// [0, 1].
    pub softness: f64,
    /// The difference of colour that counts as an edge, as a fraction of the range from black to white, in [0.005, 1].
    pub contrast: f64,
}

impl Default for SpreadSettings {
    /// Far, hard, and along the edges that are seen at a glance.
    fn default() -> Self {
        Self { reach: 4096.0, softness: 0.0, contrast: 0.06 }
    }
}

impl SpreadSettings {
    /// Range of [`Self::reach`].
    pub const REACH_RANGE: [f64; 2] = [LEAST_REACH, GREATEST_REACH];
    /// Range of [`Self::contrast`].
    pub const CONTRAST_RANGE: [f64; 2] = [0.005, 1.0];

    /// Whether all numbers are in their ranges.
    pub fn is_valid(&self) -> bool {
        let is_within = |number: f64, [low, high]: [f64; 2]| (low..=high).contains(&number);
        is_within(self.reach, Self::REACH_RANGE)
            && is_within(self.softness, [0.0, 1.0])
            && is_within(self.contrast, Self::CONTRAST_RANGE)
    }
}

/// What a layer was spread from: its strokes, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct Spread {
    /// The layer's values and mask as they were painted.
    pub strokes: FocusMap,
    /// How they are spread.
    pub settings: SpreadSettings,
}

impl Spread {
    /// Whether strokes and settings are usable for a layer of this size.
    pub fn is_valid_for(&self, size: [u32; 2]) -> bool {
        self.strokes.size() == size && self.strokes.is_valid() && self.settings.is_valid()
    }
}
