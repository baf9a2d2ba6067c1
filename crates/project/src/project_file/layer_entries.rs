//! The layers of focus in a project.
//!
//! Each layer has an entry in the manifest and, where it has them, an entry of the container for its values and one
//! for its mask; one that was spread has the same for its strokes. An adjustment layer has no values of its own: they follow from its curve and the camera. The
//! composite of the layers is saved as the focus map as well, so that programs which only render need not support
//! layers.

use crate::ProjectError;
use crate::project_file::container::Container;
use crate::project_file::layer_rows::{LayerEntries, LayerEntry, LayerMapEntry, SpreadEntry};
use crate::project_file::manifest::{MANIFEST, Manifest, MapEntry};
use crate::project_file::texel_bytes::{bytes_from_floats, floats_from_bytes, pairs_from_bytes};
use focus::{Adjustment, FocusLayer, FocusMap, LayerStack, Spread};
use lens::FocusOffset;
use std::path::Path;

/// The manifest's entries for the layers; the layers' data is appended to `entries`.
pub(crate) fn write(layers: &LayerStack, entries: &mut Vec<(String, Vec<u8>)>) -> LayerEntries {
    let mut row = |(index, layer): (usize, &FocusLayer)| {
        let (curve, plane) = match layer.adjustment.clone() {
            Some(Adjustment::Curve(curve)) => (Some(curve), None),
            Some(Adjustment::Plane(plane)) => (None, Some(plane)),
            None => (None, None),
        };
        let map = write_map(&layer.map, &format!("layers/{index}"), layer.adjustment.is_none(), entries);
        let spread = layer.spread.as_ref().map(|spread| SpreadEntry {
            strokes: write_map(&spread.strokes, &format!("layers/{index}.strokes"), true, entries),
            settings: spread.settings,
        });
        LayerEntry {
            name: layer.name.clone(),
            visible: layer.is_visible,
            opacity: layer.opacity,
            blend: layer.blend,
            map,
            spread,
            curve,
            plane,
            motion: layer.motion.clone(),
        }
    };
    LayerEntries {
        active: layers.active_index(),
        layers: layers.layers().iter().enumerate().map(&mut row).collect(),
    }
}

/// The manifest's entry for a map; its data is appended to `entries`, under names that begin with `stem`.
fn write_map(
    map: &FocusMap,
    stem: &str,
    has_values: bool,
    entries: &mut Vec<(String, Vec<u8>)>,
) -> LayerMapEntry {
    let mut add_entry = |name: String, bytes: Vec<u8>| {
        entries.push((name.clone(), bytes));
        name
    };
    let values = has_values.then(|| {
        let bytes = map.to_rows().iter().flatten().flat_map(|value| value.to_le_bytes()).collect();
        add_entry(format!("{stem}.f32"), bytes)
    });
    let mask = map.mask_rows().map(|mask| add_entry(format!("{stem}.mask.f32"), bytes_from_floats(&mask)));
    let gloss =
        map.gloss_rows().map(|gloss| add_entry(format!("{stem}.gloss.f32"), bytes_from_floats(&gloss)));
    let FocusOffset { t, anchor, gloss: background_gloss } = map.background;
    let background = [t, anchor, f64::from(map.background_mask)];
    LayerMapEntry { background, values, background_gloss, gloss, mask }
}

/// Reads the layers; `size` is that of the focus map. The values of adjustment layers are yet to be evaluated.
pub(crate) fn read(
    file: &Path,
    rows: &LayerEntries,
    size: &MapEntry,
    manifest: &Manifest,
    container: &mut Container<'_>,
) -> Result<LayerStack, ProjectError> {
    let mut layers = Vec::new();
    for row in &rows.layers {
        let mut map_of = |entry: &LayerMapEntry| read_map(file, entry, size, manifest, container);
        let map = map_of(&row.map)?;
        let spread = match &row.spread {
            Some(entry) => Some(Spread { strokes: map_of(&entry.strokes)?, settings: entry.settings }),
            None => None,
        };
        layers.push(FocusLayer {
            name: row.name.clone(),
            is_visible: row.visible,
            opacity: row.opacity,
            blend: row.blend,
            map,
            adjustment: row.adjustment(),
            spread,
            motion: row.motion.clone(),
        });
    }
    LayerStack::new(layers, rows.active)
        .ok_or_else(|| container.error(MANIFEST, "has layers that cannot be used"))
}

/// Reads a map of the size of the focus map.
fn read_map(
    file: &Path,
    row: &LayerMapEntry,
    size: &MapEntry,
    manifest: &Manifest,
    container: &mut Container<'_>,
) -> Result<FocusMap, ProjectError> {
    let texels = size.width as u64 * size.height as u64;
    let [t, anchor, background_mask] = row.background;
    let background = FocusOffset::new(t, anchor).with_gloss(row.background_gloss);
    let wrong_size = "does not have the size given in the manifest";
    let mut map = match &row.values {
        Some(entry) => {
            let bytes = manifest.read_entry(file, container, entry, texels * 8)?;
            FocusMap::from_rows(size.width, size.height, &pairs_from_bytes(&bytes), background)
                .ok_or_else(|| container.error(entry, wrong_size))?
        }
        None => FocusMap::new(size.width, size.height, FocusOffset::STANDARD),
    };
    if let Some(entry) = &row.gloss {
        let bytes = manifest.read_entry(file, container, entry, texels * 4)?;
        if !map.set_gloss_rows(&floats_from_bytes(&bytes)) {
            return Err(container.error(entry, wrong_size));
        }
    }
    if let Some(entry) = &row.mask {
        let bytes = manifest.read_entry(file, container, entry, texels * 4)?;
        if !map.set_mask_rows(Some(&floats_from_bytes(&bytes))) {
            return Err(container.error(entry, wrong_size));
        }
        map.background_mask = background_mask as f32;
    }
    map.background = background;
    Ok(map)
}
