//! What the light field holds.

use glam::{Vec2, Vec3};
use scene::SurfacePoint;

/// A patch of surface as the aperture sees it.
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
    /// What of the aperture it sees.
    pub visibility: Visibility,
}

/// What of the square aperture [−R, R]² a sample sees.
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
    /// Cells a side of a field of cells.
    pub fn side_of(words: &[u64]) -> usize {
        8 * words.len().isqrt()
    }

    /// The bits of `row` of a field of cells, column 0 the lowest.
    pub fn row(words: &[u64], row: usize) -> u64 {
        let side = Self::side_of(words);
        let rows_a_word = 64 / side;
        words[row / rows_a_word] >> (row % rows_a_word * side) & (u64::MAX >> (64 - side))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
