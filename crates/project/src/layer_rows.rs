//! What the manifest of a project says of the layers of focus.

use focus::{Adjustment, Blend, DepthCurve, FocalPlane};
use serde::{Deserialize, Serialize};

/// The layers' part of the manifest.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct LayerRows {
    /// Which one is painted on, counted from the bottom.
    pub active: usize,
    /// Bottom to top.
    pub layers: Vec<LayerRow>,
}

/// A layer.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct LayerRow {
    pub name: String,
    pub visible: bool,
    pub opacity: f64,
    pub blend: Blend,
    /// Of the background: t, anchor, mask.
    pub background: [f64; 3],
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curve: Option<DepthCurve>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plane: Option<FocalPlane>,
    /// Entry of the values: t and anchor of every texel.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub values: Option<String>,
    /// Entry of the mask: a number a texel.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mask: Option<String>,
}

impl LayerRow {
    /// The rule of an adjustment layer.
    pub fn adjustment(&self) -> Option<Adjustment> {
        let curve = self.curve.clone().map(Adjustment::Curve);
        curve.or_else(|| self.plane.clone().map(Adjustment::Plane))
    }
}
