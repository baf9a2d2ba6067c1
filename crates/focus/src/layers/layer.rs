//! One layer of focus.

use crate::{Adjustment, BlendMode, Canvas, FocusMap, LayerMotion, Spread};
use lens::Camera;

/// A layer: its values, their weights, and how they blend with the layers below.
#[derive(Clone, Debug, PartialEq)]
pub struct FocusLayer {
    /// Its name, chosen by the user.
    pub name: String,
    /// Whether it has any effect.
    pub is_visible: bool,
    /// Its weight, in [0, 1].
    pub opacity: f64,
    /// How it blends with the layers below.
    pub blend: BlendMode,
    /// Its values and its mask. An adjustment layer's values come from its rule, for the shot camera that it was last
    /// evaluated for; only its mask is painted.
    pub map: FocusMap,
    /// The rule of an adjustment layer.
    pub adjustment: Option<Adjustment>,
    /// What its values and mask were spread from; `None` for a layer that is as it was painted.
    pub spread: Option<Spread>,
    /// Its weight over time.
    pub motion: LayerMotion,
}

impl FocusLayer {
    /// A visible, opaque painted layer with the values of `map`, and without keys.
    pub fn from_map(name: impl Into<String>, map: FocusMap) -> Self {
        let (is_visible, opacity, blend) = (true, 1.0, BlendMode::Set);
        let (adjustment, spread, motion) = (None, None, LayerMotion::default());
        Self { name: name.into(), is_visible, opacity, blend, map, adjustment, spread, motion }
    }

    /// An adjustment layer whose values follow from `adjustment` for a shot camera.
    pub fn from_adjustment(
        name: impl Into<String>,
        adjustment: Adjustment,
        canvas: &Canvas,
        camera: &Camera,
    ) -> Self {
        let map = adjustment.evaluate(canvas, camera);
        Self { adjustment: Some(adjustment), ..Self::from_map(name, map) }
    }

    /// Whether it hides all layers below it, so that only its own values count.
    pub fn is_plain(&self) -> bool {
        self.is_visible && self.opacity == 1.0 && self.blend == BlendMode::Set && !self.map.has_mask()
    }

    /// The weight of each texel of a tile, in [0, 1]: opacity times mask. `None` if all are 0.
    pub(crate) fn tile_shares(&self, tile: usize) -> Option<impl Fn(usize) -> f32> {
        let (opacity, mask) = (self.opacity as f32, self.map.mask.as_ref().map(|mask| &mask.tiles()[tile]));
        let is_empty = mask.is_some_and(|mask| mask.iter().all(|m| *m == 0.0));
        let counts = self.is_visible && !is_empty;
        counts.then_some(move |k: usize| opacity * mask.map_or(1.0, |mask| mask[k]))
    }

    /// Computes the values anew by the layer's rule, if it has one, for a shot camera; the mask stays.
    pub fn evaluate(&mut self, canvas: &Canvas, camera: &Camera) {
        if let Some(adjustment) = &self.adjustment {
            let values = adjustment.evaluate(canvas, camera);
            (self.map.texels, self.map.background) = (values.texels, values.background);
        }
    }

    /// The layer as it is at a time, without motion. Weights by depth are evaluated for the surface positions of
    /// `canvas` as seen by `camera`.
    pub(crate) fn at_time(&self, seconds: f64, canvas: Option<&Canvas>, camera: &Camera) -> Self {
        let mut still = Self { motion: LayerMotion::default(), ..self.clone() };
        if let Some(opacity) = self.motion.opacity.span_at(seconds) {
            still.opacity = opacity.interpolate();
        }
        if let Some(canvas) = canvas {
            self.motion.apply_mask(seconds, &mut still.map, canvas, camera);
            still.evaluate(canvas, camera);
        }
        still
    }

    /// Whether all its numbers are usable.
    pub fn is_valid(&self) -> bool {
        (0.0..=1.0).contains(&self.opacity)
            && self.map.is_valid()
            && self.adjustment.as_ref().is_none_or(Adjustment::is_valid)
            && self.spread.as_ref().is_none_or(|spread| spread.is_valid_for(self.map.size()))
            && self.motion.is_valid()
    }

    /// Its map, and the strokes that it was spread from.
    pub(crate) fn maps(&self) -> impl Iterator<Item = &FocusMap> {
        [&self.map].into_iter().chain(self.spread.as_ref().map(|spread| &spread.strokes))
    }
}
