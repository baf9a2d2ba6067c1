//! What of a layer a brush may touch.

use crate::error::DocumentError;
use focus::{Channels, FocusLayer};

/// What a brush with these channels touches of a layer: of an adjustment layer only its mask can be painted.
pub(crate) fn paintable_channels(layer: &FocusLayer, channels: Channels) -> Result<Channels, DocumentError> {
    let bad_layer = |what: String| Err(DocumentError::BadInput(what));
    let name = &layer.name;
    if !layer.is_visible {
        return bad_layer(format!("{name}: the layer is hidden (show it, or choose another one)"));
    }
    let channels = if layer.adjustment.is_some() { Channels::Mask } else { channels };
    if channels == Channels::Mask && !layer.map.has_mask() {
        return bad_layer(format!("{name}: the layer has no mask to paint (add one in the Layers panel)"));
    }
    Ok(channels)
}
