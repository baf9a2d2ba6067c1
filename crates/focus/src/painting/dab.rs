//! One touch of the brush.

use crate::{Brush, Canvas, CanvasTexel, Selection};
use glam::{DVec3, Vec3};

/// A sphere of paint: where the brush touches, and how strongly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Dab {
    /// Centre, world.
    pub center: DVec3,
    /// Geometric normal of the surface under the pen; `None` paints every side.
    pub normal: Option<Vec3>,
    /// Radius, world units.
    pub radius: f64,
    /// Strength at the centre, in [0, 1].
    pub strength: f64,
}

/// Tolerance for the dot product of two f32 unit normals: surfaces exactly at the limit are painted.
const NORMAL_ROUNDING: f32 = 1e-5;

impl Dab {
    /// Whether the texel faces a side that the brush paints: within its normal limit of the dab's normal.
    pub fn accepts_normal(&self, brush: &Brush, texel: &CanvasTexel) -> bool {
        match self.normal {
            Some(normal) if texel.normal != Vec3::ZERO => {
                let least = brush.normal_limit_degrees.to_radians().cos() as f32;
                normal.dot(texel.normal) >= least - NORMAL_ROUNDING
            }
            _ => true,
        }
    }

    /// Texels under the dab (indices into the canvas) with the brush's falloff at each, in (0, 1]. A dab smaller than
    /// the texels takes the texel that it lies in.
    pub fn covered_texels(
        &self,
        brush: &Brush,
        canvas: &Canvas,
        selection: Option<&Selection>,
    ) -> Vec<(usize, f32)> {
        let mut covered = Vec::new();
        let mut any_within = false;
        let is_selected = |index: usize| selection.is_none_or(|selection| selection.contains(index));
        canvas.visit_within(self.center, self.radius, |index, distance| {
            if self.accepts_normal(brush, &canvas.texel(index)) {
                any_within = true;
                let share = brush.falloff(distance as f64 / self.radius);
                if share > 0.0 && is_selected(index) {
                    covered.push((index, share as f32));
                }
            }
        });
        if !any_within {
            let texel = canvas.nearest(self.center, |texel| self.accepts_normal(brush, texel));
            covered.extend(texel.filter(|&index| is_selected(index)).map(|index| (index, 1.0)));
        }
        covered
    }
}
