//! What a dab does to the texels under it.

use crate::focus_map::to_numbers;
use crate::painting::dab::Dab;
use crate::painting::smoothed_values::SmoothedValues;
use crate::{Brush, BrushMode, Canvas, Channels, FocusMap, Selection};
use glam::DVec3;
use lens::FocusOffset;

/// What a stroke accumulates: the map as it was at the beginning, and how strongly each texel has been painted since.
pub(crate) struct StrokePainter<'a> {
    /// The map when the stroke began.
    pub before: &'a FocusMap,
    /// How strongly each texel of the canvas has been painted since, in [0, 1].
    pub coverage: &'a mut [f32],
    /// Which texels may be painted; `None`: all.
    pub selection: Option<&'a Selection>,
}

impl StrokePainter<'_> {
    /// Paints a dab on `map`; the texels that it changes (column, row) are appended to `changed`.
    pub fn paint_dab(
        &mut self,
        dab: &Dab,
        brush: &Brush,
        canvas: &Canvas,
        map: &mut FocusMap,
        changed: &mut Vec<[u32; 2]>,
    ) {
        let covered = dab.covered_texels(brush, canvas, self.selection);
        let touches = brush.channels.write_flags();
        let mut write = |map: &mut FocusMap, index, value| {
            canvas.write_channels(map, index, value, touches, changed);
        };
        match brush.mode {
            BrushMode::Set | BrushMode::Reset => {
                for (index, share) in covered {
                    let ceiling = share * dab.strength as f32;
                    let before = self.coverage[index];
                    if ceiling > before {
                        let share = before + (ceiling - before) * brush.flow as f32;
                        self.coverage[index] = share;
                        let from = canvas.value(self.before, index);
                        write(map, index, set_or_reset(brush, map.has_mask(), from, share));
                    }
                }
            }
            BrushMode::Clone => {
                let offset = DVec3::from_array(brush.clone_offset);
                for (index, share) in covered {
                    let ceiling = share * dab.strength as f32;
                    let before = self.coverage[index];
                    // The surface there may lie a little off the exact position: it need not be parallel to the one
                    // here.
                    let texel = canvas.texel(index);
                    let source =
                        canvas.nearest_within(texel.position + offset, texel.area.sqrt(), dab.radius);
                    if let Some(source) = source.filter(|_| ceiling > before) {
                        let share = before + (ceiling - before) * brush.flow as f32;
                        self.coverage[index] = share;
                        let [from, to] = [index, source].map(|index| canvas.value(self.before, index));
                        write(map, index, [0, 1, 2, 3].map(|k| lerp_toward(from[k], to[k], share)));
                    }
                }
            }
            BrushMode::Add | BrushMode::Subtract => {
                let sign = if brush.mode == BrushMode::Add { 1.0 } else { -1.0 };
                let FocusOffset { t, anchor, gloss } = brush.target;
                let step = [t - 1.0, anchor, gloss].map(|step| sign * step);
                for (index, share) in covered {
                    let share = share * (dab.strength * brush.flow) as f32;
                    let from = canvas.value(map, index);
                    let limits = [brush.offset_limits, [0.0, 1.0], [0.0, 1.0]];
                    let [t, anchor, gloss] = [0, 1, 2].map(|k| {
                        // A value already outside the limits may stay, but not move farther out.
                        let [low, high] = limits[k].map(|limit| limit as f32);
                        let sum = (from[k] as f64 + step[k] * share as f64) as f32;
                        sum.clamp(low.min(from[k]), high.max(from[k]))
                    });
                    write(map, index, [t, anchor, gloss, lerp_toward(from[3], 1.0, share)]);
                }
            }
            BrushMode::Smooth | BrushMode::Sharpen => {
                let smoothed = SmoothedValues::new(dab, brush, canvas, map);
                let [low, high] = smoothed.bounds();
                for (index, share) in covered {
                    let share = share * (dab.strength * brush.flow) as f32;
                    let from = canvas.value(map, index);
                    let mean = smoothed.value_at(canvas.offset_from(index, dab.center), from);
                    let moved = [0, 1, 2, 3].map(|k| match brush.mode {
                        // Away from the mean, but within the range of the neighbourhood: a ramp becomes a step,
                        // without a rim. A dab smaller than a texel has no neighbourhood but the texel itself.
                        BrushMode::Sharpen => {
                            let sharpened = from[k] + (from[k] - mean[k]) * share;
                            sharpened.clamp(low[k].min(from[k]), high[k].max(from[k]))
                        }
                        _ => lerp_toward(from[k], mean[k], share),
                    });
                    write(map, index, moved);
                }
            }
        }
    }
}

/// [t, anchor, gloss, mask] of a texel that was `from` when the stroke began and is painted with weight `share`.
///
/// On a map with a mask the paint lies over what is there (Porter and Duff's *over*): the mask grows to m + s(1 − m),
/// and the value moves toward the target by the fraction of it that is new paint. Reset then erases the mask; without
/// a mask it restores the ordinary lens.
fn set_or_reset(brush: &Brush, has_mask: bool, from: [f32; 4], share: f32) -> [f32; 4] {
    let [t, anchor, gloss, mask] = from;
    let resets = brush.mode == BrushMode::Reset;
    if resets && (has_mask || brush.channels == Channels::Mask) {
        return [t, anchor, gloss, lerp_toward(mask, 0.0, share)];
    }
    paint_over(from, to_numbers(if resets { FocusOffset::STANDARD } else { brush.target }), share)
}

/// [t, anchor, gloss, mask] of a texel that was `from`, with a focus of weight `share` laid over it (Porter and
/// Duff's *over*).
pub(crate) fn paint_over([t, anchor, gloss, mask]: [f32; 4], target: [f32; 3], share: f32) -> [f32; 4] {
    let grown = lerp_toward(mask, 1.0, share);
    let own = if grown > 0.0 { (share / grown).min(1.0) } else { 0.0 };
    let [t, anchor, gloss] = [(t, target[0]), (anchor, target[1]), (gloss, target[2])]
        .map(|(from, to)| lerp_toward(from, to, own));
    [t, anchor, gloss, grown]
}

/// The value at `share` of the way from a to b; exactly b at 1, and exactly a where both are equal.
fn lerp_toward(a: f32, b: f32, share: f32) -> f32 {
    if share >= 1.0 { b } else { a + (b - a) * share }
}
