//! A layer's weight over time.

use super::keys::{KeySpan, Keys, mix};
use crate::{Canvas, Curve, FocusMap};
use lens::Camera;
use serde::{Deserialize, Serialize};

/// A layer's weight over time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LayerMotion {
    /// Its opacity, in [0, 1], in place of the layer's own.
    #[serde(default, skip_serializing_if = "Keys::is_empty")]
    pub opacity: Keys<f64>,
    /// Its weight over the logarithm of depth in the shot camera (in scene units): multiplied into the painted mask.
    /// Values outside [0, 1] are clamped.
    #[serde(default, skip_serializing_if = "Keys::is_empty")]
    pub mask: Keys<Curve>,
}

impl LayerMotion {
    /// Whether nothing is animated.
    pub fn is_empty(&self) -> bool {
        self.opacity.is_empty() && self.mask.is_empty()
    }

    /// Whether all its keys are valid: opacities in [0, 1], masks finite.
    pub fn is_valid(&self) -> bool {
        self.opacity.is_valid(|opacity| (0.0..=1.0).contains(opacity)) && self.mask.is_valid(Curve::is_valid)
    }

    /// The times of all keys, s; some may occur twice.
    pub fn times(&self) -> impl Iterator<Item = f64> {
        let opacity = self.opacity.keys().iter().map(|key| key.seconds);
        opacity.chain(self.mask.keys().iter().map(|key| key.seconds))
    }

    /// Multiplies the depth mask at a time into that of a map, for the surface positions of `canvas` as seen by
    /// `camera`.
    pub(crate) fn apply_mask(&self, seconds: f64, map: &mut FocusMap, canvas: &Canvas, camera: &Camera) {
        let Some(span) = self.mask.span_at(seconds) else { return };
        let [width, height] = map.size();
        let mut rows = map.mask_rows().unwrap_or_else(|| vec![1.0; width as usize * height as usize]);
        let mut scale =
            |[x, y]: [u32; 2], share: f32| rows[y as usize * width as usize + x as usize] *= share;
        for (index, texel) in canvas.texels().enumerate() {
            let share = share_at(&span, camera.camera_from_world(texel.position).z);
            scale([texel.x, texel.y], share);
            canvas.gutters_of(index).iter().for_each(|&gutter| scale(gutter, share));
        }
        let background = map.background_mask * share_at(&span, f64::INFINITY);
        let _ = map.set_mask_rows(Some(&rows));
        map.background_mask = background;
    }
}

/// The weight at a depth; depths behind the camera count as the nearest.
fn share_at(span: &KeySpan<'_, Curve>, depth: f64) -> f32 {
    let at = depth.max(f64::MIN_POSITIVE).ln();
    mix(span.from.evaluate(at), span.to.evaluate(at), span.share).clamp(0.0, 1.0) as f32
}
