//! The layers of an OpenEXR file that are a picture each, with or without its depth.
//!
//! Blender writes all its view layers into one file, `ViewLayer.Combined.R`, `ViewLayer.Depth.Z`, `ViewLayer_001.Combined.R` …; other programs
//! give each a part, with channels `R`, `G`, `B` and `Z`. A picture and its depth belong to the same layer.

use crate::pictures::exr_channels::{color_channels, depth_channel};
use std::cmp::Reverse;
use std::collections::{BTreeMap, HashMap};

/// A picture among the channels of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct ExrLayer {
    /// Its name; for channels that belong to no layer that of the first part, or nothing.
    pub name: String,
    /// Red, green and blue.
    pub color: [String; 3],
    /// Its depth, if it has one.
    pub depth: Option<String>,
}

/// The layers, the one without a name first, then as in the file. `root` is the name of the first part, if it has one.
pub(crate) fn exr_layers(names: &[String], root: &str) -> Vec<ExrLayer> {
    // For each prefix the channels below it, and those of its passes, a name further below.
    let mut groups: Vec<(&str, Vec<&str>)> = vec![("", Vec::new())];
    let mut places = HashMap::from([("", 0)]);
    for name in names {
        for prefix in [Some(outside(name)), pass_layer(name)].into_iter().flatten() {
            let place = *places.entry(prefix).or_insert_with(|| {
                groups.push((prefix, Vec::new()));
                groups.len() - 1
            });
            groups[place].1.push(name);
        }
    }
    // A layer's channels are not those of a pass of the layer around it, so the inner ones come first.
    let level = |prefix: &str| if prefix.is_empty() { 0 } else { 1 + prefix.matches('.').count() };
    let mut inner_first: Vec<usize> = (0..groups.len()).collect();
    inner_first.sort_by_key(|place| Reverse(level(groups[*place].0)));
    let mut layers: BTreeMap<usize, ExrLayer> = BTreeMap::new();
    for place in inner_first {
        let (prefix, own) = &groups[place];
        let is_free = |name: &&&str| outside(name) == *prefix || !layers.contains_key(&places[outside(name)]);
        let inner =
            |name: &str| if prefix.is_empty() { name.into() } else { name[prefix.len() + 1..].into() };
        let own: Vec<String> = own.iter().filter(is_free).map(|name| inner(name)).collect();
        let full = |name: String| if prefix.is_empty() { name } else { format!("{prefix}.{name}") };
        let Some(color) = color_channels(&own) else { continue };
        let depth = depth_channel(&own).map(full);
        // Colours alone are one of a layer's many passes, unless they are named as its picture.
        if depth.is_some() || color[0].contains('.') || prefix.is_empty() {
            let name = if prefix.is_empty() { root } else { prefix };
            layers.insert(place, ExrLayer { name: name.into(), color: color.map(full), depth });
        }
    }
    if !layers.values().any(|layer| layer.depth.is_some())
        && let (Some(color), Some(depth)) = (color_channels(names), depth_channel(names))
    {
        // The only depth is not where the picture is.
        return vec![ExrLayer { name: root.into(), color, depth: Some(depth) }];
    }
    layers.into_values().collect()
}

/// What stands before a channel's own name.
fn outside(name: &str) -> &str {
    name.rsplit_once('.').map_or("", |(outside, _)| outside)
}

/// The layer of the pass that a channel belongs to.
fn pass_layer(name: &str) -> Option<&str> {
    let pass = outside(name);
    (!pass.is_empty()).then(|| outside(pass))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layers(names: &[&str]) -> Vec<(String, String, Option<String>)> {
        let names: Vec<String> = names.iter().flat_map(|name| with_colors(name)).collect();
        exr_layers(&names, "first")
            .into_iter()
            .map(|layer| (layer.name, layer.color[0].clone(), layer.depth))
            .collect()
    }

    /// `a.RGB` stands for three channels.
    fn with_colors(name: &str) -> Vec<String> {
        match name.strip_suffix("RGB") {
            Some(layer) => ["R", "G", "B"].map(|channel| format!("{layer}{channel}")).into(),
            None => vec![name.into()],
        }
    }

    fn layer(name: &str, red: &str, depth: &str) -> (String, String, Option<String>) {
        (name.into(), red.into(), (!depth.is_empty()).then(|| depth.into()))
    }

    #[test]
    fn view_layers_of_blender() {
        let names = [
            "Composite.Combined.RGB",
            "ViewLayer.Combined.RGB",
            "ViewLayer.Depth.Z",
            "ViewLayer.DiffCol.RGB",
            "ViewLayer.Normal.X",
            "ViewLayer.Normal.Z",
            "ViewLayer_001.Combined.RGB",
            "ViewLayer_001.Depth.Z",
        ];
        let expected = [
            layer("Composite", "Composite.Combined.R", ""),
            layer("ViewLayer", "ViewLayer.Combined.R", "ViewLayer.Depth.Z"),
            layer("ViewLayer_001", "ViewLayer_001.Combined.R", "ViewLayer_001.Depth.Z"),
        ];
        assert_eq!(layers(&names), expected);
    }

    #[test]
    fn parts_with_a_picture_each() {
        let expected = [layer("first", "R", "Z"), layer("second", "second.R", "second.Z")];
        assert_eq!(layers(&["RGB", "Z", "second.RGB", "second.Z"]), expected);
        // The depth of the second is not that of the first.
        let expected = [layer("first", "R", ""), layer("second", "second.R", "second.Z")];
        assert_eq!(layers(&["RGB", "second.RGB", "second.Z"]), expected);
    }

    #[test]
    fn a_single_picture_with_its_passes() {
        assert_eq!(
            layers(&["RGB", "depth.Z", "N.X", "N.Y", "N.Z", "albedo.RGB"]),
            [layer("first", "R", "depth.Z")]
        );
        assert_eq!(layers(&["Image.RGB", "Depth.V"]), [layer("first", "Image.R", "Depth.V")]);
        assert_eq!(layers(&["RGB", "Depth.RGB"]), [layer("first", "R", "Depth.R")]);
        assert_eq!(layers(&["ViewLayer.Combined.RGB", "Z"]), [layer("first", "ViewLayer.Combined.R", "Z")]);
        assert!(layers(&["Depth.RGB", "diffuse.RGB"]).is_empty());
        assert_eq!(layers(&["RGB"]), [layer("first", "R", "")]);
    }
}
