//! The channels of a layer that can be painted.

use crate::error::DocumentError;
use focus::{Channels, FocusLayer};

/// The channels of a layer that a brush with `channels` paints: only the mask of an adjustment layer can be painted.
pub(crate) fn paintable_channels(layer: &FocusLayer, channels: Channels) -> Result<Channels, DocumentError> {
    let bad_layer = |message: String| Err(DocumentError::BadInput(message));
    let name = &layer.name;
    if !layer.is_visible {
        return bad_layer(format!("{name}: the layer is hidden (show it, or choose another layer)"));
    }
    if layer.spread.is_some() {
        return bad_layer(format!("{name}: the layer is spread from strokes (show its strokes to paint on)"));
    }
    let channels = if layer.adjustment.is_some() { Channels::Mask } else { channels };
    if channels == Channels::Mask && !layer.map.has_mask() {
        return bad_layer(format!("{name}: the layer has no mask to paint (add one in the Layers panel)"));
    }
    Ok(channels)
}
