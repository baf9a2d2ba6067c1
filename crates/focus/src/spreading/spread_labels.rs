//! Which values the strokes of a layer have, and where.

use crate::focus_map::to_numbers;
use crate::{Canvas, FocusMap};
use lens::FocusOffset;
use spread::MAX_LABELS;
use std::collections::BTreeMap;

/// The values that are painted on a layer, and the texels that have each.
///
/// Where the ordinary lens is painted, nothing is to be spread: that value keeps the others out.
#[derive(Clone, Debug, PartialEq)]
pub struct SpreadLabels {
    /// [t, anchor, gloss] of each label; `None` keeps out.
    values: Vec<Option<[f32; 3]>>,
    /// (texel, label), ascending.
    seeds: Vec<(u32, u8)>,
}

/// A texel is painted if its mask is at least this.
const PAINTED_MASK: f32 = 0.5;

/// Values that differ by no more than this in t, anchor or gloss are one.
const VALUE_TOLERANCE: f32 = 1.0 / 256.0;

/// A value on fewer texels than this share of the commonest one's is the soft rim of a stroke, not a stroke.
const LEAST_SHARE: f64 = 0.02;

impl SpreadLabels {
    /// The labels of a layer's strokes: of a map with a mask, where that is at least one half; of one without, where it
    /// differs from the ordinary lens. At most [`MAX_LABELS`], those on the most texels.
    pub fn from_strokes(canvas: &Canvas, strokes: &FocusMap) -> Self {
        let standard = to_numbers(FocusOffset::STANDARD);
        let painted: Vec<(u32, [f32; 3])> = (0u32..)
            .zip(canvas.texels())
            .filter_map(|(index, texel)| {
                let [t, anchor] = strokes.texel(texel.x, texel.y);
                let value = [t, anchor, strokes.gloss_at(texel.x, texel.y)];
                let is_painted = match strokes.has_mask() {
                    true => strokes.mask_at(texel.x, texel.y) >= PAINTED_MASK,
                    false => value != standard,
                };
                is_painted.then_some((index, value))
            })
            .collect();
        let mut counts: BTreeMap<[u32; 3], usize> = BTreeMap::new();
        for (_, value) in &painted {
            *counts.entry(value.map(f32::to_bits)).or_default() += 1;
        }
        let mut by_count: Vec<_> = counts.into_iter().collect();
        by_count.sort_by_key(|(bits, count)| (std::cmp::Reverse(*count), *bits));
        let most = by_count.first().map_or(0, |(_, count)| *count);
        let mut values: Vec<[f32; 3]> = Vec::new();
        for (bits, count) in by_count {
            let value = bits.map(f32::from_bits);
            let is_new = !values.iter().any(|label| is_same_value(*label, value));
            if is_new && values.len() < MAX_LABELS && count as f64 >= LEAST_SHARE * most as f64 {
                values.push(value);
            }
        }
        let seed = |&(index, value): &(u32, [f32; 3])| {
            let label = values.iter().position(|label| is_same_value(*label, value))?;
            Some((index, label as u8))
        };
        let seeds = painted.iter().filter_map(seed).collect();
        let values = values.into_iter().map(|value| (value != standard).then_some(value)).collect();
        Self { values, seeds }
    }

    /// [t, anchor, gloss] of each label; `None` for the one that keeps the others out.
    pub fn values(&self) -> &[Option<[f32; 3]>] {
        &self.values
    }

    /// The texels that are painted, by index in the canvas, each with its label.
    pub fn seeds(&self) -> &[(u32, u8)] {
        &self.seeds
    }
}

fn is_same_value(a: [f32; 3], b: [f32; 3]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= VALUE_TOLERANCE)
}
