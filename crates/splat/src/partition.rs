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
//! Light that either takes from a surface is given back nearby ([`crate::balance`]): none is made or lost.

use crate::balance::{Gains, KnotSums, Knots, Scaled};
use crate::fixed::{floored, ratio};
use crate::resolve::Lines;
use crate::widest::with_widest_instructions;
use std::ops::Range;

/// A pixel's factors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share {
    /// Of the partly occluded samples.
    pub partial: f32,
    /// Of all, if nothing is painted.
    pub even: f32,
}

impl Share {
    /// Nothing is known of the standard picture.
    pub const NONE: Self = Self { partial: 1.0, even: 1.0 };

    /// The factors of a pixel whose standard coverage is `open` + `partial`.
    ///
    /// The share of partial samples stays within [0, 8]: where almost nothing partial lies, what is left is the error of
    /// the open ones, and is not blown up.
    #[inline(always)]
    pub fn of(open: f32, partial: f32) -> Self {
        const LARGEST: u32 = 8;
        const LEAST_PARTIAL: f32 = 1e-3;
        const RIPPLE: f32 = 0.1;
        // Divided in integers: graphics cards round quotients of floats in ways of their own.
        let fixed = |covered: f32| floored((covered * (ONE as f32)).clamp(0.0, MOST).into());
        let share = if partial < LEAST_PARTIAL {
            1.0
        } else {
            (ratio(ONE.saturating_sub(fixed(open)), fixed(partial), LARGEST) >> 3) as f32 / (1 << 21) as f32
        };
        let covered = open + share * partial;
        let even = if (covered - 1.0).abs() <= RIPPLE {
            (ratio(ONE, fixed(covered), 2) >> 1) as f32 / (1 << 23) as f32
        } else {
            1.0
        };
        Self { partial: share, even }
    }
}

/// What a pixel holds that nothing was thrown at.
const BLACK: [f32; 4] = [0.0; 4];

/// Where the pixels of lines lie among some whole rows of the picture.
#[derive(Clone)]
pub struct Strip {
    /// Pixels a row of the picture.
    pub width: usize,
    /// The picture's row that is the first of the whole ones.
    pub first: usize,
    pub rows: Range<usize>,
    pub columns: Range<usize>,
}

impl Strip {
    /// Calls `visit` with each row and its pixels of either part, free and sharing.
    fn each_row(&self, parts: &[Option<Lines>; 2], mut visit: impl FnMut(usize, &[[f32; 4]], &[[f32; 4]])) {
        let black = vec![BLACK; if parts.iter().all(Option::is_some) { 0 } else { self.columns.len() }];
        let [mut free, mut sharing] = parts.each_ref().map(|lines| lines.as_ref().map(Lines::rows));
        for row in self.rows.clone() {
            let free = free.as_mut().and_then(Iterator::next).unwrap_or(&black);
            let sharing = sharing.as_mut().and_then(Iterator::next).unwrap_or(&black);
            visit(row, free, sharing);
        }
    }
}

/// Finds the factors of the pixels of whole rows from the lines of a standard picture, free and sharing.
pub fn find_shares(parts: &[Option<Lines>; 2], strip: &Strip, shares: &mut [Share]) {
    strip.each_row(parts, |row, free, sharing| {
        let shares = &mut shares[row * strip.width..][..strip.width];
        with_widest_instructions(
            #[inline(always)]
            || {
                for (share, (free, sharing)) in shares.iter_mut().zip(free.iter().zip(sharing)) {
                    *share = Share::of(free[3], sharing[3]);
                }
            },
        );
    });
}

/// Finds what whole rows bring to each column of `knots`.
pub fn sum_rows(
    parts: &[Option<Lines>; 2],
    strip: &Strip,
    knots: &Knots,
    shares: &[Share],
    sums: &mut [KnotSums],
) {
    let columns = knots.columns();
    strip.each_row(parts, |row, free, sharing| {
        let shares = &shares[row * strip.width..][..strip.width];
        knots.sum_row([free, sharing], shares, &mut sums[row * columns..][..columns]);
    });
}

/// Joins lines, free and sharing, to pixels and their coverage, scaled by `gains` once these are known; evened out if asked
/// for: only where nothing is painted.
pub fn join(
    parts: &[Option<Lines>; 2],
    strip: &Strip,
    shares: &[Share],
    gains: Option<&Gains>,
    is_evened: bool,
    (radiance, coverage): (&mut [[f32; 3]], &mut [f32]),
) {
    strip.each_row(parts, |row, free, sharing| {
        let here = row * strip.width + strip.columns.start..row * strip.width + strip.columns.end;
        let mut row_of = RowToJoin {
            free,
            sharing,
            shares: &shares[here.clone()],
            radiance: &mut radiance[here.clone()],
            coverage: &mut coverage[here],
            is_evened,
        };
        let scaled = if is_evened { Scaled::All } else { Scaled::Sharing };
        match gains.map(|gains| gains.of_row(strip.first + row, scaled)) {
            Some(of_row) => with_widest_instructions(
                #[inline(always)]
                || row_of.join(|x| of_row.at(strip.columns.start + x)),
            ),
            None => with_widest_instructions(
                #[inline(always)]
                || row_of.join(|_| [1.0; 4]),
            ),
        }
    });
}

/// Some pixels of a row.
struct RowToJoin<'a> {
    free: &'a [[f32; 4]],
    sharing: &'a [[f32; 4]],
    shares: &'a [Share],
    radiance: &'a mut [[f32; 3]],
    coverage: &'a mut [f32],
    is_evened: bool,
}

impl RowToJoin<'_> {
    #[inline(always)]
    fn join(&mut self, gain: impl Fn(usize) -> [f32; 4]) {
        let lines = self.free.iter().zip(self.sharing).zip(self.shares);
        let pixels = self.radiance.iter_mut().zip(&mut *self.coverage);
        for (x, (((free, sharing), share), (radiance, coverage))) in lines.zip(pixels).enumerate() {
            let gain = gain(x);
            let mut light = [0.0; 4];
            for c in 0..4 {
                let shared = share.partial * sharing[c];
                light[c] = if self.is_evened {
                    share.even * (free[c] + shared) * gain[c]
                } else {
                    free[c] + shared * gain[c]
                };
            }
            *radiance = [light[0], light[1], light[2]];
            *coverage = light[3];
        }
    }
}

/// A coverage of 1.
const ONE: u32 = 1 << 22;

/// More than any pixel is covered by a standard picture.
const MOST: f32 = ((1u32 << 26) - 1) as f32;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_is_shared() {
        assert_eq!(Share::of(0.25, 0.5), Share { partial: 1.5, even: 1.0 });
        assert_eq!(Share::of(0.0, 0.01).partial, 8.0);
        assert_eq!(Share::of(0.5, 0.0), Share::NONE, "a hole is no ripple");
        let evened = Share::of(1.005, 0.5);
        assert!(evened.partial == 0.0 && (evened.even * 1.005 - 1.0).abs() < 1e-6, "{evened:?}");
    }
}
