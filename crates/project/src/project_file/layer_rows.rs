//! The layers of focus in the manifest of a project.

use focus::{Adjustment, BlendMode, DepthCurve, FocalPlane, LayerMotion, SpreadSettings};
use serde::{Deserialize, Serialize};

/// Whether a number can be omitted.
pub(crate) fn is_zero(number: &f64) -> bool {
    *number == 0.0
}

/// The layers' part of the manifest.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct LayerEntries {
    /// Index of the layer that is painted on, counted from the bottom.
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
    #[serde(flatten)]
    pub map: LayerMapEntry,
    /// What its values and mask were spread from, if they were.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spread: Option<SpreadEntry>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curve: Option<DepthCurve>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plane: Option<FocalPlane>,
    /// Its weight over time, if animated.
    #[serde(default, skip_serializing_if = "LayerMotion::is_empty")]
    pub motion: LayerMotion,
}

/// The values and the mask of a layer, or of the strokes that it was spread from.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct LayerMapEntry {
    /// The background's t, anchor and mask.
    pub background: [f64; 3],
    /// Container entry of the values: t and anchor of every texel.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub values: Option<String>,
    /// The background's gloss, if not 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub background_gloss: f64,
    /// Container entry of the gloss: one number per texel; absent if all are 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gloss: Option<String>,
    /// Container entry of the mask: one number per texel.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mask: Option<String>,
}

/// What a layer was spread from.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct SpreadEntry {
    pub strokes: LayerMapEntry,
    pub settings: SpreadSettings,
}

impl LayerMapEntry {
    fn has_gloss(&self) -> bool {
        self.background_gloss != 0.0 || self.gloss.is_some()
    }
}

impl LayerEntry {
    /// Whether gloss obeys the paint anywhere.
    pub fn has_gloss(&self) -> bool {
        self.map.has_gloss() || self.spread.as_ref().is_some_and(|spread| spread.strokes.has_gloss())
    }

    /// The rule of an adjustment layer; `None` for a painted layer.
    pub fn adjustment(&self) -> Option<Adjustment> {
        let curve = self.curve.clone().map(Adjustment::Curve);
        curve.or_else(|| self.plane.clone().map(Adjustment::Plane))
    }
}
