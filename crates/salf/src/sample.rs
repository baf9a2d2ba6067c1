//! What the light field holds.

use glam::{Vec2, Vec3};
use lens::FocusOffset;
use surface::{SurfaceField, SurfacePoint};

/// A patch of surface, as seen from the aperture.
///
/// Toward the aperture point U = R·(u, v) of the baked camera it has the weight (design: `w(P, U)`, here in
/// px² of picture area)
///
/// ```text
/// w(u, v) = max(0, weight + tilt·(u, v))
/// ```
///
/// which is exact: |n·(P − U)| is linear in U as long as the aperture does not cross the patch's plane, and
/// where it does, each side of the patch is a sample of its own.
///
/// What a patch sends need not be one sample: its own and its carried light are two, which share its weight; where something
/// half there covers part of its view, or where its light changes over the aperture, samples that see disjoint parts of the
/// aperture stand for it, each with its weight and its radiance.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// Centre of its footprint in the pinhole picture, px (x right, y down, the frame's corner at 0).
    pub center: Vec2,
    /// Half the footprint's sides, px.
    pub half_size: Vec2,
    /// 1/z, z the depth; 0 for the background.
    pub inverse_depth: f32,
    /// w toward the aperture's centre, px².
    pub weight: f32,
    /// ∂w/∂u and ∂w/∂v, px².
    pub tilt: Vec2,
    /// Linear RGB radiance toward the aperture.
    pub radiance: Vec3,
    /// Its address on the surface (and so in the atlas); `None` for the background.
    pub surface: Option<SurfacePoint>,
    /// Whether its light is carried: mirrored or let through, so that it is focused as [`FocusOffset::of_carried`] says: by the
    /// ordinary lens, but where the paint says that gloss obeys it.
    pub is_carried: bool,
    /// The visible part of the aperture.
    pub visibility: Visibility,
}

impl Sample {
    /// The address at which paint for it is looked up.
    pub fn address(&self) -> Address {
        Address { surface: self.surface, is_carried: self.is_carried }
    }
}

/// The address at which paint for a sample is looked up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Address {
    /// See [`Sample::surface`].
    pub surface: Option<SurfacePoint>,
    /// See [`Sample::is_carried`].
    pub is_carried: bool,
}

/// A focus paint as it applies to samples: carried light is looked up only if the paint affects it.
#[derive(Clone, Copy)]
pub struct SampleFocus<'a> {
    paint: &'a dyn SurfaceField<FocusOffset>,
    affects_carried: bool,
}

impl<'a> SampleFocus<'a> {
    /// Looks up how `paint` focuses samples.
    pub fn new(paint: &'a dyn SurfaceField<FocusOffset>) -> Self {
        Self { paint, affects_carried: paint.affects_carried_light() }
    }

    /// How the paint focuses the light that is sent from an address.
    pub fn offset(&self, address: Address) -> FocusOffset {
        if address.is_carried && !self.affects_carried {
            return FocusOffset::STANDARD;
        }
        let painted = address.surface.map_or_else(|| self.paint.at_infinity(), |point| self.paint.at(point));
        if address.is_carried { painted.of_carried() } else { painted }
    }
}

/// The part of the square aperture [−R, R]² that is visible from a sample.
#[derive(Clone, Debug, PartialEq)]
pub enum Visibility {
    /// All of it.
    Open,
    /// Part of it.
    Cells {
        /// n × n cells, a bit each, row 0 at v = −R, column 0 at u = −R; n is 8 (one word) or 16
        /// (four words).
        words: Box<[u64]>,
    },
}

impl Visibility {
    /// The visibility that the bits of these cells make up: 1 word for 8 × 8 cells, 4 words for 16 × 16.
    pub fn from_words(words: &[u64]) -> Self {
        match words.iter().all(|&word| word == u64::MAX) {
            true => Self::Open,
            false => Self::Cells { words: words.into() },
        }
    }

    /// The part of the aperture that is visible in both; `None` if it is empty.
    pub fn intersection(&self, other: &Self) -> Option<Self> {
        let (Self::Cells { words: a }, Self::Cells { words: b }) = (self, other) else {
            return Some(if *self == Self::Open { other.clone() } else { self.clone() });
        };
        let finer = |words: &[u64], other: &[u64]| match *words {
            [word] if other.len() == 4 => finer(word).into(),
            _ => words.to_vec(),
        };
        let words: Box<[u64]> = finer(a, b).iter().zip(finer(b, a)).map(|(a, b)| a & b).collect();
        words.iter().any(|&word| word != 0).then_some(Self::Cells { words })
    }

    /// The number of cells a side (8 or 16) of a field of cells.
    pub fn side_of(words: &[u64]) -> usize {
        8 * words.len().isqrt()
    }

    /// The bits of row `row` of a field of cells, column 0 the lowest.
    pub fn row(words: &[u64], row: usize) -> u64 {
        let side = Self::side_of(words);
        let rows_a_word = 64 / side;
        words[row / rows_a_word] >> (row % rows_a_word * side) & (u64::MAX >> (64 - side))
    }
}

/// 8 × 8 cells as 16 × 16.
pub(crate) fn finer(word: u64) -> [u64; 4] {
    let mut words = [0u64; 4];
    for row in 0..16 {
        let bits = word >> (row / 2 * 8) & 0xFF;
        let doubled = (0..8).map(|k| (bits >> k & 1) * (3 << (2 * k))).sum::<u64>();
        words[row / 4] |= doubled << (row % 4 * 16);
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coarse_cells_become_four_each() {
        assert_eq!(
            finer(1 | 1 << 15 | 1 << 63),
            [3 | 3 << 16 | (3 << 14) << 32 | (3 << 14) << 48, 0, 0, 0xC000_C000 << 32]
        );
        for word in [0, u64::MAX, 0x0123_4567_89AB_CDEF] {
            assert_eq!(finer(word).iter().map(|w| w.count_ones()).sum::<u32>(), 4 * word.count_ones());
        }
    }

    #[test]
    fn what_both_see() {
        let cells = |words: &[u64]| Visibility::Cells { words: words.into() };
        assert_eq!(Visibility::Open.intersection(&cells(&[5])), Some(cells(&[5])));
        assert_eq!(cells(&[5]).intersection(&Visibility::Open), Some(cells(&[5])));
        assert_eq!(cells(&[5]).intersection(&cells(&[6])), Some(cells(&[4])));
        assert_eq!(cells(&[5]).intersection(&cells(&[2])), None);
        assert_eq!(
            cells(&[1]).intersection(&cells(&[2 | 1 << 17, 0, 7, 0])),
            Some(cells(&[2 | 1 << 17, 0, 0, 0]))
        );
    }

    #[test]
    fn rows_of_bits() {
        let mut words = [0u64; 4];
        words[1] = 0xABCD << 16;
        assert_eq!(Visibility::side_of(&words), 16);
        assert_eq!(Visibility::row(&words, 5), 0xABCD);
        assert_eq!(Visibility::row(&words, 4), 0);
        assert_eq!(Visibility::row(&[0x1200], 1), 0x12);
        assert_eq!(Visibility::side_of(&[0]), 8);
    }
}
