//! What the manifest of a project says of the layers of focus.

use focus::{Adjustment, BlendMode, DepthCurve, FocalPlane, LayerMotion};
use serde::{Deserialize, Serialize};

/// Whether a number may be left out.
pub(crate) fn is_zero(number: &f64) -> bool {
    *number == 0.0
}

/// The layers' part of the manifest.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct LayerEntries {
    /// Which one is painted on, counted from the bottom.
    pub active: usize,
    /// Bottom to top.
    pub layers: Vec<LayerEntry>,
}

/// A layer.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct LayerEntry {
    pub name: String,
    pub visible: bool,
    pub opacity: f64,
    pub blend: BlendMode,
    /// Of the background: t, anchor, mask.
    pub background: [f64; 3],
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curve: Option<DepthCurve>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plane: Option<FocalPlane>,
    /// Entry of the values: t and anchor of every texel.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub values: Option<String>,
    /// Of the background, where it is not 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub background_gloss: f64,
    /// Entry of the gloss: a number a texel; where all of it is not 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gloss: Option<String>,
    /// Entry of the mask: a number a texel.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mask: Option<String>,
    /// How much it counts over time; where that changes.
    #[serde(default, skip_serializing_if = "LayerMotion::is_empty")]
    pub motion: LayerMotion,
}

impl LayerEntry {
    /// Whether gloss obeys the paint anywhere.
    pub fn has_gloss(&self) -> bool {
        self.background_gloss != 0.0 || self.gloss.is_some()
    }

    /// The rule of an adjustment layer.
    pub fn adjustment(&self) -> Option<Adjustment> {
        let curve = self.curve.clone().map(Adjustment::Curve);
        curve.or_else(|| self.plane.clone().map(Adjustment::Plane))
    }
}
