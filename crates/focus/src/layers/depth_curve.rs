//! A focal surface drawn as a curve: a blur for each depth.

use crate::{Canvas, Curve, FocusMap};
use lens::{Camera, FocusOffset};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// t as a curve over the logarithm of depth, the same for all points at one depth in the shot camera.
///
/// With anchor 1 the curve is the blur itself: wherever it is at t = 1, everything is sharp. The single plane of
/// focus of an ordinary lens becomes as many planes, or as deep a zone, as are drawn. With anchor 0 the curve shifts
/// the lens's own focus.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DepthCurve {
    /// ln(depth in scene units) to t.
    pub curve: Curve,
    /// Its anchor, in [0, 1].
    pub anchor: f64,
}

impl DepthCurve {
    /// Sharp at every depth between two depths (both above 0): the curve to start drawing from.
    pub fn sharp_between(nearest: f64, farthest: f64) -> Option<Self> {
        let curve = Curve::new([nearest, farthest].map(|depth| [depth.ln(), 1.0]))?;
        Some(Self { curve, anchor: 1.0 })
    }

    /// Whether its curve is valid and its anchor in [0, 1].
    pub fn is_valid(&self) -> bool {
        self.curve.is_valid() && (0.0..=1.0).contains(&self.anchor)
    }

    /// The focus at a depth. Infinity lies beyond the last point; depths behind the camera count as the nearest.
    pub fn at_depth(&self, depth: f64) -> FocusOffset {
        FocusOffset::new(self.curve.evaluate(depth.max(f64::MIN_POSITIVE).ln()), self.anchor)
    }

    /// The focus of every texel of a canvas, by its depth in front of `camera`.
    pub fn evaluate(&self, canvas: &Canvas, camera: &Camera) -> FocusMap {
        let values: Vec<[f32; 2]> = canvas
            .par_texels()
            .map(|texel| {
                crate::focus_map::to_texel(self.at_depth(camera.camera_from_world(texel.position).z))
            })
            .collect();
        canvas.map_from_values(&values, self.at_depth(f64::INFINITY))
    }
}
