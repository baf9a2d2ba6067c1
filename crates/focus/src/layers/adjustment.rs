//! Where an adjustment layer takes its values from.

use crate::{Canvas, DepthCurve, FocalPlane, FocusMap};
use lens::Camera;

/// A rule that computes the focus of every point from its position in front of the shot camera.
#[derive(Clone, Debug, PartialEq)]
pub enum Adjustment {
    /// A blur for each depth.
    Curve(DepthCurve),
    /// A plane in which everything is sharp.
    Plane(FocalPlane),
}

impl Adjustment {
    /// Whether its curve or plane is valid.
    pub fn is_valid(&self) -> bool {
        match self {
            Self::Curve(curve) => curve.is_valid(),
            Self::Plane(plane) => plane.is_valid(),
        }
    }

    /// The focus of every texel of a canvas, from its position in front of `camera`.
    pub fn evaluate(&self, canvas: &Canvas, camera: &Camera) -> FocusMap {
        match self {
            Self::Curve(curve) => curve.evaluate(canvas, camera),
            Self::Plane(plane) => plane.evaluate(canvas, camera),
        }
    }
}
