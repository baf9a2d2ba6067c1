//! One touch of the brush.

use crate::smooth::Smoothed;
use crate::{Brush, BrushMode, Canvas, CanvasTexel, FocusMap};
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

/// How far a product of two unit f32 normals may be off: surfaces at exactly the limit are painted.
const NORMAL_ROUNDING: f32 = 1e-5;

impl Dab {
    /// Whether the texel's side of the surface is painted.
    pub fn faces(&self, brush: &Brush, texel: &CanvasTexel) -> bool {
        match self.normal {
            Some(normal) if texel.normal != Vec3::ZERO => {
                let least = brush.normal_limit_degrees.to_radians().cos() as f32;
                normal.dot(texel.normal) >= least - NORMAL_ROUNDING
            }
            _ => true,
        }
    }

    /// Texels under the dab (indices into the canvas) and how strongly each is painted, in (0, 1]. A dab
    /// smaller than the texels takes the one that it lies in.
    pub fn covered(&self, brush: &Brush, canvas: &Canvas) -> Vec<(usize, f32)> {
        let mut covered = Vec::new();
        let mut any_within = false;
        canvas.within(self.center, self.radius, |index, distance| {
            if self.faces(brush, &canvas.texels()[index]) {
                any_within = true;
                let share = self.strength * brush.falloff(distance as f64 / self.radius);
                if share > 0.0 {
                    covered.push((index, share as f32));
                }
            }
        });
        if !any_within && self.strength > 0.0 {
            let texel = canvas.nearest(self.center, |texel| self.faces(brush, texel));
            covered.extend(texel.map(|index| (index, self.strength as f32)));
        }
        covered
    }

    /// Paints the dab. `before` is the map when the stroke began, `coverage` how strongly each texel of the
    /// canvas has been painted since; what changes is noted in `changed`.
    pub fn paint(
        &self,
        brush: &Brush,
        canvas: &Canvas,
        stroke: &mut Wash<'_>,
        map: &mut FocusMap,
        changed: &mut Vec<[u32; 2]>,
    ) {
        let covered = self.covered(brush, canvas);
        let channels = brush.channels.touches();
        match brush.mode {
            BrushMode::Set | BrushMode::Reset => {
                let target = crate::focus_map::texel_of(match brush.mode {
                    BrushMode::Reset => lens::FocusOffset::STANDARD,
                    _ => brush.target,
                });
                for (index, share) in covered {
                    if share > stroke.coverage[index] {
                        stroke.coverage[index] = share;
                        let from = canvas.value(stroke.before, index);
                        let moved = [0, 1].map(|k| toward(from[k], target[k], share));
                        write_channels(canvas, map, index, moved, channels, changed);
                    }
                }
            }
            BrushMode::Add | BrushMode::Subtract => {
                let sign = if brush.mode == BrushMode::Add { 1.0 } else { -1.0 };
                let step = [sign * (brush.target.t - 1.0), sign * brush.target.anchor];
                for (index, share) in covered {
                    let from = canvas.value(map, index);
                    let limits = [brush.offset_limits, [0.0, 1.0]];
                    let moved = [0, 1].map(|k| {
                        // What already lies outside the limits may stay, but not go further.
                        let [low, high] = limits[k].map(|limit| limit as f32);
                        let sum = (from[k] as f64 + step[k] * share as f64) as f32;
                        sum.clamp(low.min(from[k]), high.max(from[k]))
                    });
                    write_channels(canvas, map, index, moved, channels, changed);
                }
            }
            BrushMode::Smooth => {
                let smoothed = Smoothed::new(self, brush, canvas, map);
                for (index, share) in covered {
                    let from = canvas.value(map, index);
                    let mean = smoothed.at(canvas.offset_from(index, self.center), from);
                    let moved = [0, 1].map(|k| toward(from[k], mean[k], share));
                    write_channels(canvas, map, index, moved, channels, changed);
                }
            }
        }
    }
}

/// What a stroke knows of the texels: their values when it began, and how strongly they were painted since.
pub(crate) struct Wash<'a> {
    pub before: &'a FocusMap,
    pub coverage: &'a mut [f32],
}

/// `share` of the way from a to b; exactly b at 1, and exactly a where both are equal.
fn toward(a: f32, b: f32, share: f32) -> f32 {
    if share >= 1.0 { b } else { a + (b - a) * share }
}

/// Writes the touched channels of a texel.
pub(crate) fn write_channels(
    canvas: &Canvas,
    map: &mut FocusMap,
    index: usize,
    value: [f32; 2],
    touches: [bool; 2],
    changed: &mut Vec<[u32; 2]>,
) {
    let now = canvas.value(map, index);
    let kept = [0, 1].map(|k| if touches[k] { value[k] } else { now[k] });
    if kept != now {
        canvas.write(map, index, kept, changed);
    }
}
