//! The same value over a whole piece of the scene.

use crate::dab::write_channels;
use crate::focus_map::texel_of;
use crate::{Canvas, Changed, Channels, FocusError, FocusMap};
use lens::FocusOffset;

/// What is filled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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

/// Fills `target` with `value` on the given channels. Returns what changed; the background's value, which has
/// no texel, shows in the map alone.
pub fn fill(
    map: &mut FocusMap,
    canvas: &Canvas,
    target: FillTarget,
    value: FocusOffset,
    channels: Channels,
) -> Result<Changed, FocusError> {
    if !value.is_valid() {
        return Err(FocusError::BadValue { entry: "fill".to_string() });
    }
    if map.size() != canvas.size() {
        return Err(FocusError::SizesDiffer { map: map.size(), canvas: canvas.size() });
    }
    let touches = channels.touches();
    if target == FillTarget::Background {
        let [t, anchor, _] = touches;
        map.background_mask = 1.0;
        map.background.t = if t { value.t } else { map.background.t };
        map.background.anchor = if anchor { value.anchor } else { map.background.anchor };
    }
    let [t, anchor] = texel_of(value);
    let mut changed = Vec::new();
    for (index, texel) in canvas.texels().iter().enumerate() {
        let inside = match target {
            FillTarget::Node(node) => canvas.node_of(texel) == node,
            FillTarget::Material(material) => canvas.material_of(texel) == material,
            FillTarget::Part(part) => texel.part == part,
            FillTarget::Chart(chart) => texel.chart == chart,
            FillTarget::Everything => true,
            FillTarget::Background => false,
        };
        if inside {
            write_channels(canvas, map, index, [t, anchor, 1.0], touches, &mut changed);
        }
    }
    Ok(Changed::new(changed))
}
