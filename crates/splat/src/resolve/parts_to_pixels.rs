//! The parts of a row's pixels, joined to a picture: what is free, and what shares the rest, scaled by its gains.

use crate::resolve::balance::RowGains;
use crate::resolve::knots::{SPACING, SharedSums};
use crate::resolve::partition::{Parts, Share};
use crate::resolve::{BLACK, Light};
use numerics::with_widest_simd;

impl Parts<'_> {
    /// Joins them to pixels, scaled by `gains` if given; evened out if requested: only where nothing is painted.
    pub fn join(self, shares: &[Share], gains: Option<&RowGains>, is_evened: bool, pixels: Pixels<'_>) {
        let first = pixels.first;
        let mut row = RowToJoin { parts: self, shares, pixels, is_evened };
        match gains {
            Some(gains) => with_widest_simd(
                #[inline(always)]
                || row.join(|x| gains.at(first + x)),
            ),
            None => with_widest_simd(
                #[inline(always)]
                || row.join(|_| [1.0; 4]),
            ),
        }
    }

    /// Sets the pixels of a whole row to what shares, scaled by `gains`, and a sum for each span of [`SPACING`] pixels to what
    /// they hold.
    pub fn share(self, shares: &[Share], gains: &RowGains, pixels: Pixels<'_>, sums: &mut [SharedSums]) {
        let pixels = pixels.radiance.chunks_mut(SPACING).zip(pixels.coverage.chunks_mut(SPACING));
        let lights = self.sharing.chunks(SPACING).zip(shares.chunks(SPACING));
        with_widest_simd(
            #[inline(always)]
            || {
                for (span, ((pixels, lights), sums)) in pixels.zip(lights).zip(sums).enumerate() {
                    *sums = share_span(lights, pixels, |x| gains.at(span * SPACING + x));
                }
            },
        );
    }

    /// Joins what is free to pixels that were set to what shares, scaled by `rest` too.
    pub fn join_shared(self, rest: [f32; 3], pixels: Pixels<'_>) {
        with_widest_simd(
            #[inline(always)]
            || {
                for ((radiance, coverage), free) in pixels.zip_pixels().zip(self.free) {
                    for c in 0..3 {
                        radiance[c] = free[c] + radiance[c] * rest[c];
                    }
                    *coverage += free[3];
                }
            },
        );
    }
}

/// Sets some pixels to what shares, scaled. Returns their sums before and after that.
#[inline(always)]
fn share_span(
    (sharing, shares): (&[Light], &[Share]),
    (radiance, coverage): (&mut [[f32; 3]], &mut [f32]),
    gain: impl Fn(usize) -> [f32; 4],
) -> SharedSums {
    let mut sums = [SharedSums::default(); SharedSums::TURNS];
    let pixels = radiance.iter_mut().zip(coverage);
    for (x, (((radiance, coverage), sharing), share)) in pixels.zip(sharing).zip(shares).enumerate() {
        let (gain, mut scaled) = (gain(x), BLACK);
        for c in 0..4 {
            scaled[c] = share.partial * sharing[c] * gain[c];
        }
        sums[x % SharedSums::TURNS].add(sharing, &scaled);
        (*radiance, *coverage) = ([scaled[0], scaled[1], scaled[2]], scaled[3]);
    }
    SharedSums::from_turns(sums)
}

/// Some pixels of a row of a picture.
pub struct Pixels<'a> {
    /// The first one's column.
    pub first: usize,
    /// Linear RGB.
    pub radiance: &'a mut [[f32; 3]],
    /// Coverage.
    pub coverage: &'a mut [f32],
}

impl<'a> Pixels<'a> {
    #[inline(always)]
    fn zip_pixels(self) -> impl Iterator<Item = (&'a mut [f32; 3], &'a mut f32)> {
        self.radiance.iter_mut().zip(self.coverage)
    }
}

/// Some pixels of a row.
struct RowToJoin<'a> {
    parts: Parts<'a>,
    shares: &'a [Share],
    pixels: Pixels<'a>,
    is_evened: bool,
}

impl RowToJoin<'_> {
    #[inline(always)]
    fn join(&mut self, gain: impl Fn(usize) -> [f32; 4]) {
        let lines = self.parts.free.iter().zip(self.parts.sharing).zip(self.shares);
        let pixels = self.pixels.radiance.iter_mut().zip(&mut *self.pixels.coverage);
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
