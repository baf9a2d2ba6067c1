//! Fills a whole region of the scene with one value.

use crate::focus_map::to_numbers;
use crate::{Canvas, CanvasTexel, ChangedTexels, Channels, FocusError, FocusMap, Selection};
use lens::FocusOffset;
use serde::{Deserialize, Serialize};

/// What is filled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FillTarget {
    /// All parts of a node (an object, or one instance): index into `Scene::nodes`.
    Node(u32),
    /// All surface of a material: index into `Scene::materials`.
    Material(u32),
    /// One part: index into `Scene::parts`.
    Part(u32),
    /// One chart of the atlas: index into `Atlas::charts`.
    Chart(u32),
    /// All surface; not the background.
    Everything,
    /// The background.
    Background,
}

impl FillTarget {
    /// Whether a texel of `canvas` belongs to the target.
    pub fn contains(self, canvas: &Canvas, texel: &CanvasTexel) -> bool {
        match self {
            Self::Node(node) => canvas.node_of(texel) == node,
            Self::Material(material) => canvas.material_of(texel) == material,
            Self::Part(part) => texel.part == part,
            Self::Chart(chart) => texel.chart == chart,
            Self::Everything => true,
            Self::Background => false,
        }
    }
}

/// Fills `target` with `value` on the given channels. Returns the changed texels; the background has no texel, so its
/// change shows only in the map.
///
/// # Errors
/// [`FocusError::BadValue`] if `value` is invalid, [`FocusError::SizesDiffer`] if map and canvas differ in size.
pub fn fill(
    map: &mut FocusMap,
    canvas: &Canvas,
    target: FillTarget,
    value: FocusOffset,
    channels: Channels,
) -> Result<ChangedTexels, FocusError> {
    fill_selected(map, canvas, &[target], (value, channels), None)
}

/// Fills several targets with a value on the given channels, but only where selected (`None`: everywhere). Returns
/// the changed texels.
///
/// # Errors
/// As [`fill`].
pub fn fill_selected(
    map: &mut FocusMap,
    canvas: &Canvas,
    targets: &[FillTarget],
    (value, channels): (FocusOffset, Channels),
    selection: Option<&Selection>,
) -> Result<ChangedTexels, FocusError> {
    if !value.is_valid() {
        return Err(FocusError::BadValue { entry: "fill".to_string() });
    }
    if map.size() != canvas.size() {
        return Err(FocusError::SizesDiffer { map: map.size(), canvas: canvas.size() });
    }
    let touches = channels.write_flags();
    if targets.contains(&FillTarget::Background) {
        let [t, anchor, gloss, _] = touches;
        map.background_mask = 1.0;
        map.background.t = if t { value.t } else { map.background.t };
        map.background.anchor = if anchor { value.anchor } else { map.background.anchor };
        map.background.gloss = if gloss { value.gloss } else { map.background.gloss };
    }
    let [t, anchor, gloss] = to_numbers(value);
    let mut changed = Vec::new();
    for (index, texel) in canvas.texels().enumerate() {
        let is_inside = targets.iter().any(|target| target.contains(canvas, &texel));
        if is_inside && selection.is_none_or(|selection| selection.contains(index)) {
            canvas.write_channels(map, index, [t, anchor, gloss, 1.0], touches, &mut changed);
        }
    }
    Ok(ChangedTexels::new(changed))
}
