//! How a scene shows its Gaussian splats: where they stand, and which of them are hidden. Their file is never changed.

use gaussians::Placement;
use glam::{DMat3, DQuat, DVec3};
use std::ops::Range;
use std::sync::Arc;

/// Where splats stand, and which of them are shown. The default changes nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SplatEdit {
    /// Where they are moved, from where they stood when their file was opened.
    pub transform: SplatTransform,
    /// The lower and upper corner of the box outside of which splats are hidden, by their means (world).
    pub crop: Option<(DVec3, DVec3)>,
    /// Which are hidden by what they are.
    pub cleanup: SplatCleanup,
    /// The numbers of splats that were hidden one by one, in ascending ranges that do not touch.
    pub hidden: Arc<Vec<Range<u32>>>,
}

/// Turns, scales and moves splats about the origin, in this order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SplatTransform {
    /// Added last (world).
    pub translation: DVec3,
    /// A unit quaternion.
    pub rotation: DQuat,
    /// The same along all axes, > 0.
    pub scale: f64,
}

impl Default for SplatTransform {
    fn default() -> Self {
        Self { translation: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: 1.0 }
    }
}

impl SplatTransform {
    /// What stood at `placement`, moved.
    pub fn apply(&self, placement: &Placement) -> Placement {
        Placement {
            rotation: DMat3::from_quat(self.rotation) * placement.rotation,
            scale: self.scale * placement.scale,
            translation: self.rotation * (self.scale * placement.translation) + self.translation,
        }
    }
}

/// Hides splats by what they are. The default hides none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SplatCleanup {
    /// Splats of a smaller opacity are hidden, in [0, 1].
    pub min_opacity: f64,
    /// Splats with a larger standard deviation along their longest axis are hidden (world, > 0).
    pub max_size: Option<f64>,
    /// Splats with fewer than [`SplatCleanup::NEIGHBORS`] others within this distance are hidden (world, > 0).
    pub max_distance: Option<f64>,
}

impl SplatCleanup {
    /// As many others are near a splat that does not float. (Splats of surfaces have dozens within a few of their own sizes.)
    pub const NEIGHBORS: usize = 8;
}

impl SplatEdit {
    /// Whether all numbers are usable: see the ranges of the fields.
    pub fn is_valid(&self) -> bool {
        let SplatTransform { translation, rotation, scale } = self.transform;
        let is_positive = |x: f64| x.is_finite() && x > 0.0;
        let is_limit = |limit: Option<f64>| limit.is_none_or(is_positive);
        let is_box = |(low, high): (DVec3, DVec3)| !low.is_nan() && !high.is_nan() && low.cmple(high).all();
        translation.is_finite()
            && rotation.is_normalized()
            && is_positive(scale)
            && self.crop.is_none_or(is_box)
            && (0.0..=1.0).contains(&self.cleanup.min_opacity)
            && is_limit(self.cleanup.max_size)
            && is_limit(self.cleanup.max_distance)
            && self.hidden.iter().all(|range| range.start < range.end)
            && self.hidden.windows(2).all(|pair| pair[0].end < pair[1].start)
    }

    /// The same with further splats hidden.
    pub fn hiding(&self, further: impl IntoIterator<Item = u32>) -> Self {
        let mut all: Vec<u32> = self.hidden.iter().cloned().flatten().chain(further).collect();
        all.sort_unstable();
        all.dedup();
        let ranges = all.chunk_by(|a, b| a + 1 == *b);
        Self { hidden: Arc::new(ranges.map(|run| run[0]..run[run.len() - 1] + 1).collect()), ..self.clone() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edits_that_say_nothing_are_not_valid() {
        let of = |transform: SplatTransform| SplatEdit { transform, ..SplatEdit::default() };
        let identity = SplatTransform::default();
        assert!(of(identity).is_valid());
        assert!(!of(SplatTransform { scale: 0.0, ..identity }).is_valid());
        assert!(!of(SplatTransform { scale: f64::INFINITY, ..identity }).is_valid());
        assert!(!of(SplatTransform { translation: DVec3::NAN, ..identity }).is_valid());
        assert!(
            !of(SplatTransform { rotation: DQuat::from_xyzw(0.0, 0.0, 0.0, 2.0), ..identity }).is_valid()
        );
        assert!(!SplatEdit { crop: Some((DVec3::ONE, DVec3::ZERO)), ..SplatEdit::default() }.is_valid());
        let hidden = |ranges: Vec<Range<u32>>| SplatEdit { hidden: Arc::new(ranges), ..SplatEdit::default() };
        assert!(hidden(vec![0..2, 3..4]).is_valid() && !hidden(vec![3..4, 0..2]).is_valid());
        let cleanup = SplatCleanup { max_size: Some(f64::NAN), ..SplatCleanup::default() };
        assert!(!SplatEdit { cleanup, ..SplatEdit::default() }.is_valid());
    }
}
