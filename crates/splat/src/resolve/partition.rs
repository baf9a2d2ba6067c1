//! Who gets which part of a standard picture's pixel.
//!
//! Every ray of a standard camera ends on exactly one surface: the coverage of the standard picture is 1. Samples that
//! see the whole aperture cover their part of it exactly. What they leave belongs to the samples that are partly
//! occluded, whose visibility is known only cell by cell of the aperture: alone they would bleed over the outlines of what
//! occludes them, and fall short beside them. So the unpainted ones among them are summed apart, and share, pixel by pixel,
//! what the open ones leave:
//!
//! ```text
//! picture(q) = even(q)·(free(q) + share(q)·sharing(q)),    share(q) = (1 − open(q)) / partial(q)
//! ```
//!
//! with `open` and `partial` the coverage of the *standard* picture by either kind. A ray's share does not depend on
//! paint: paint that moves other rays to or from q leaves it as it is. Painted samples are summed with the visibility of
//! their cells as it stands. What then still keeps the standard picture's coverage from 1, the ripple of finite samples,
//! is taken out by `even`, which is 1 to within a
//! tenth: a pixel that lacks more has a hole. Where anything is painted it is 1: coverage then has a shape of its own.
//!
//! Light that either takes from a surface is given back nearby ([`crate::resolve::balance`]): none is made or lost.

use crate::fixed::{floored, ratio};
use crate::resolve::Light;
use numerics::with_widest_simd;

/// A pixel's factors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share {
    /// Of the partly occluded samples.
    pub partial: f32,
    /// Of all, if nothing is painted.
    pub even: f32,
}

impl Share {
    /// Before the standard picture has been summed.
    pub const NONE: Self = Self { partial: 1.0, even: 1.0 };

    /// The factors of a pixel whose standard coverage is `open` + `partial`.
    ///
    /// The share of partial samples stays within [0, 8]: where almost nothing partial lies, what is left is the error of
    /// the open ones, and is not blown up.
    #[inline(always)]
    pub fn new(open: f32, partial: f32) -> Self {
        // Divided in integers: graphics cards round quotients of floats differently.
        let fixed = |covered: f32| floored((covered * (COVERAGE_ONE as f32)).clamp(0.0, MAX_QUANTA).into());
        let share = if partial < MIN_PARTIAL {
            1.0
        } else {
            (ratio(COVERAGE_ONE.saturating_sub(fixed(open)), fixed(partial), LARGEST_SHARE) >> 3) as f32
                / (1 << 21) as f32
        };
        let covered = open + share * partial;
        let even = if (covered - 1.0).abs() <= RIPPLE {
            (ratio(COVERAGE_ONE, fixed(covered), 2) >> 1) as f32 / (1 << 23) as f32
        } else {
            1.0
        };
        Self { partial: share, even }
    }
}

/// Some pixels of a row of the sums: what is free, and what shares the rest.
#[derive(Clone, Copy)]
pub struct Parts<'a> {
    /// The light of free samples.
    pub free: &'a [Light],
    /// The light of sharing samples.
    pub sharing: &'a [Light],
}

impl Parts<'_> {
    /// Finds the factors, in `shares`, by which the pixels of a standard picture are shared.
    pub fn find_shares(self, shares: &mut [Share]) {
        with_widest_simd(
            #[inline(always)]
            || {
                for (share, (free, sharing)) in shares.iter_mut().zip(self.free.iter().zip(self.sharing)) {
                    *share = Share::new(free[3], sharing[3]);
                }
            },
        );
    }
}

/// The share of partial samples is at most this.
pub const LARGEST_SHARE: u32 = 8;

/// Pixels that partial samples cover by less than this keep them as they are.
pub const MIN_PARTIAL: f32 = 1e-3;

/// Coverage that differs from 1 by no more than this is evened out.
pub const RIPPLE: f32 = 0.1;

/// A coverage of 1.
pub const COVERAGE_ONE: u32 = 1 << 22;

/// More than any pixel is covered by a standard picture.
pub const MAX_QUANTA: f32 = ((1u32 << 26) - 1) as f32;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_is_shared() {
        assert_eq!(Share::new(0.25, 0.5), Share { partial: 1.5, even: 1.0 });
        assert_eq!(Share::new(0.0, 0.01).partial, 8.0);
        assert_eq!(Share::new(0.5, 0.0), Share::NONE, "a hole is no ripple");
        let evened = Share::new(1.005, 0.5);
        assert!(evened.partial == 0.0 && (evened.even * 1.005 - 1.0).abs() < 1e-6, "{evened:?}");
    }
}
