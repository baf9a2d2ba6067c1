//! A change of the layers of focus.

use crate::{
    Adjustment, BlendMode, Canvas, DepthCurve, FocalPlane, FocusError, FocusLayer, FocusMap, LayerMotion,
    LayerStack,
};
use lens::Camera;
use serde::{Deserialize, Serialize};

/// A change of the layers of focus; layers are counted from the bottom. Each change is one step of undo, and so is a
/// run of edits of one kind (a dragged slider).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LayerEdit {
    /// An empty layer to paint on, above the active one; it becomes the active one.
    AddPaint,
    /// A depth-curve adjustment layer, above the active one; it becomes the active one.
    AddCurve,
    /// A focal-plane adjustment layer, above the active one; it becomes the active one.
    AddPlane,
    /// A copy of a layer, above the active one; it becomes the active one.
    Duplicate(usize),
    /// Removes a layer; the last one cannot be removed.
    Remove(usize),
    /// Renames a layer.
    Rename(usize, String),
    /// Shows or hides a layer.
    Visible(usize, bool),
    /// Sets its weight, in [0, 1].
    Opacity(usize, f64),
    /// Sets how it blends with the layers below.
    Blend(usize, BlendMode),
    /// Moves a layer.
    Shift {
        /// Its index before.
        from: usize,
        /// Its index afterwards.
        to: usize,
    },
    /// Replaces the curve of a depth-curve layer.
    Curve(usize, DepthCurve),
    /// Replaces the plane of a focal-plane layer.
    Plane(usize, FocalPlane),
    /// Replaces its keys over time.
    Motion(usize, LayerMotion),
    /// Adds a mask of 1 everywhere to a layer without one.
    AddMask(usize),
    /// Inverts a mask; a layer without one gets a mask of 0 everywhere.
    InvertMask(usize),
    /// Removes the mask: every texel counts fully.
    RemoveMask(usize),
}

impl LayerEdit {
    /// Its name in the undo list.
    pub fn name(&self) -> &'static str {
        match self {
            Self::AddPaint => "Add layer",
            Self::AddCurve => "Add depth curve",
            Self::AddPlane => "Add focal plane",
            Self::Duplicate(_) => "Duplicate layer",
            Self::Remove(_) => "Remove layer",
            Self::Rename(..) => "Rename layer",
            Self::Visible(..) => "Show or hide layer",
            Self::Opacity(..) => "Layer opacity",
            Self::Blend(..) => "Layer blending",
            Self::Shift { .. } => "Move layer",
            Self::Curve(..) => "Depth curve",
            Self::Plane(..) => "Focal plane",
            Self::Motion(..) => "Layer keys",
            Self::AddMask(_) => "Add mask",
            Self::InvertMask(_) => "Invert mask",
            Self::RemoveMask(_) => "Remove mask",
        }
    }

    /// The property that is being dragged: consecutive edits of the same property are one step of undo. `None` for an
    /// edit that is a step of its own.
    pub fn drag_target(&self) -> Option<(&'static str, usize)> {
        match self {
            Self::Rename(index, _)
            | Self::Opacity(index, _)
            | Self::Curve(index, _)
            | Self::Plane(index, _) => Some((self.name(), *index)),
            _ => None,
        }
    }

    /// Applies the change. New depth curves and focal planes start from what `camera` sees of the canvas.
    ///
    /// # Errors
    /// [`FocusError::BadLayerEdit`] if the layer does not exist or the value is invalid,
    /// [`FocusError::TooManyLayers`] if the stack is full.
    pub fn apply(self, layers: &mut LayerStack, canvas: &Canvas, camera: &Camera) -> Result<(), FocusError> {
        let bad = |problem| Err(FocusError::BadLayerEdit { problem });
        match self {
            Self::AddPaint => {
                let [width, height] = layers.size();
                let layer =
                    FocusLayer::from_map(unique_name(layers, "Layer"), FocusMap::transparent(width, height));
                return insert_layer(layers, layer);
            }
            Self::AddCurve => {
                let Some(curve) = default_curve(canvas, camera) else {
                    return bad("nothing is in front of the camera (turn it toward the scene)");
                };
                return insert_adjustment_layer(
                    layers,
                    "Depth curve",
                    Adjustment::Curve(curve),
                    canvas,
                    camera,
                );
            }
            Self::AddPlane => {
                let Some(plane) = default_plane(canvas, camera) else {
                    return bad("nothing is in front of the camera (turn it toward the scene)");
                };
                return insert_adjustment_layer(
                    layers,
                    "Focal plane",
                    Adjustment::Plane(plane),
                    canvas,
                    camera,
                );
            }
            Self::Duplicate(index) => {
                let Some(layer) = layers.layers().get(index) else { return bad("there is no such layer") };
                let name = unique_name(layers, &layer.name);
                let copy = FocusLayer { name, ..layer.clone() };
                return insert_layer(layers, copy);
            }
            Self::Remove(index) => {
                if !layers.remove(index) {
                    return bad("the last layer cannot be removed (reset the paint to clear it)");
                }
                return Ok(());
            }
            Self::Shift { from, to } => {
                layers.move_layer(from, to);
                return Ok(());
            }
            Self::Opacity(_, opacity) if !(0.0..=1.0).contains(&opacity) => {
                return bad("opacity must be in [0, 1]");
            }
            Self::Curve(_, ref curve) if !curve.is_valid() => {
                return bad("the curve must have points with finite numbers");
            }
            Self::Plane(_, ref plane) if !plane.is_valid() => {
                return bad("the three points lie in one line (choose them further apart)");
            }
            Self::Motion(_, ref motion) if !motion.is_valid() => {
                return bad("its keys cannot be used (times must ascend, opacities be in [0, 1])");
            }
            _ => {}
        }
        let index = match &self {
            Self::Rename(index, _)
            | Self::Visible(index, _)
            | Self::Opacity(index, _)
            | Self::Blend(index, _)
            | Self::Curve(index, _)
            | Self::Plane(index, _)
            | Self::Motion(index, _)
            | Self::AddMask(index)
            | Self::InvertMask(index)
            | Self::RemoveMask(index) => *index,
            _ => layers.active_index(),
        };
        let Some(layer) = layers.layer_mut(index) else { return bad("there is no such layer") };
        match self {
            Self::Rename(_, name) => layer.name = name,
            Self::Visible(_, visible) => layer.is_visible = visible,
            Self::Opacity(_, opacity) => layer.opacity = opacity,
            Self::Motion(_, motion) => layer.motion = motion,
            Self::Blend(_, blend) => layer.blend = blend,
            Self::Curve(_, curve) => {
                let Some(Adjustment::Curve(own)) = &mut layer.adjustment else {
                    return bad("the layer has no depth curve (add one)");
                };
                *own = curve;
                layer.evaluate(canvas, camera);
            }
            Self::Plane(_, plane) => {
                let Some(Adjustment::Plane(own)) = &mut layer.adjustment else {
                    return bad("the layer has no focal plane (add one)");
                };
                *own = plane;
                layer.evaluate(canvas, camera);
            }
            Self::AddMask(_) | Self::InvertMask(_) | Self::RemoveMask(_) if layer.spread.is_some() => {
                return bad(
                    "its mask was spread from strokes (go back to the strokes, or change how they spread)",
                );
            }
            Self::AddMask(_) => layer.map.add_mask(),
            Self::InvertMask(_) => layer.map.invert_mask(),
            Self::RemoveMask(_) => layer.map.remove_mask(),
            Self::AddPaint
            | Self::AddCurve
            | Self::AddPlane
            | Self::Duplicate(_)
            | Self::Remove(_)
            | Self::Shift { .. } => {}
        }
        Ok(())
    }
}

/// Inserts an adjustment layer with a mask of 1 everywhere above the active one.
fn insert_adjustment_layer(
    layers: &mut LayerStack,
    base_name: &str,
    adjustment: Adjustment,
    canvas: &Canvas,
    camera: &Camera,
) -> Result<(), FocusError> {
    let mut layer = FocusLayer::from_adjustment(unique_name(layers, base_name), adjustment, canvas, camera);
    layer.map.add_mask();
    insert_layer(layers, layer)
}

fn insert_layer(layers: &mut LayerStack, layer: FocusLayer) -> Result<(), FocusError> {
    let limit = LayerStack::MAX_LAYERS;
    if layers.insert(layer) { Ok(()) } else { Err(FocusError::TooManyLayers { limit }) }
}

/// `base_name` with the first number that no layer uses yet.
fn unique_name(layers: &LayerStack, base_name: &str) -> String {
    let stem = base_name.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end();
    let is_taken = |name: &str| layers.layers().iter().any(|layer| layer.name == name);
    let numbered = (1..).map(|number| format!("{stem} {number}"));
    numbered.into_iter().find(|name| !is_taken(name)).unwrap_or_else(|| stem.to_string())
}

/// The depths of the nearest and the farthest texel in front of the camera; the first is infinite if there is none.
fn depth_range(canvas: &Canvas, camera: &Camera) -> [f64; 2] {
    let depths = canvas.texels().map(|texel| camera.camera_from_world(texel.position).z);
    let before = depths.filter(|depth| *depth > 0.0);
    before.fold([f64::INFINITY, 0.0], |[near, far], depth| [depth.min(near), depth.max(far)])
}

/// A plane where the lens focuses, or at the farthest texel in front of it.
fn default_plane(canvas: &Canvas, camera: &Camera) -> Option<FocalPlane> {
    let [_, far] = depth_range(canvas, camera);
    let depth = camera.focus_distance.min(far);
    (depth > 0.0).then(|| FocalPlane::facing(camera, depth))
}

/// Sharp from the nearest to the farthest texel, with a draggable point where the lens focuses.
fn default_curve(canvas: &Canvas, camera: &Camera) -> Option<DepthCurve> {
    let [near, far] = depth_range(canvas, camera);
    let curve = DepthCurve::sharp_between(near, far)?;
    let focus = camera.focus_distance;
    let points = curve.curve.points().iter().copied();
    let focus_point = (focus > near * 1.05 && focus < far / 1.05).then_some([focus.ln(), 1.0]);
    Some(DepthCurve { curve: crate::Curve::new(points.chain(focus_point))?, ..curve })
}
