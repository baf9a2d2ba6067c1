//! Where the slices of a stack are placed: where the error is.
//!
//! Whatever can be sharp is nearly so at some slice. Half way between two slices, their cross-fade is compared with the picture there:
//! each slice is as far from the one before it as both allow.
//!
//! Of three slices one is whole; its neighbours on both sides are differences from it, which take a third of its bytes. So no more than two
//! pictures are decoded to show one. Whole ones are better than the others, which inherit what they keep of them. The neighbour before a whole
//! slice is placed as a whole one first, and becomes a difference once that is known, if it is still as good.

use crate::encoding::{EncodedPicture, USUAL_QUALITY, encode_difference, encode_picture};
use crate::error::WebPageError;
use crate::page::Slice;
use crate::screen_picture::ScreenPicture;
use crate::slice_spacing::SliceSpacing;
use numerics::mean_square_of_psnr;

/// How good the slices of a stack are to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacementOptions {
    /// Minimum PSNR of each slice against the picture at its distance, dB.
    pub rest_psnr: f64,
    /// PSNR that a cross-fade half way between two slices should have against the picture there, dB.
    pub midway_psnr: f64,
    /// The shortest step between slices, as a share of the step without errors of cross-fades. Cross-fades of steps this short are kept as
    /// they are.
    pub shortest_step: f64,
    /// Bytes that the slices may take together.
    pub most_bytes: u64,
}

/// Measured PSNRs, dB.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct PsnrSummary {
    /// The lowest.
    pub lowest: f64,
    /// The mean.
    pub mean: f64,
}

impl PsnrSummary {
    /// `None` without values.
    fn of(values: &[f64]) -> Option<Self> {
        let lowest = values.iter().copied().reduce(f64::min)?;
        Some(Self { lowest, mean: values.iter().sum::<f64>() / values.len() as f64 })
    }
}

/// The slices of a stack, and how good they are.
#[derive(Clone, Debug)]
pub struct PlacedSlices {
    /// The slices, from the farthest to the nearest.
    pub slices: Vec<Slice>,
    /// Of the slices at rest.
    pub at_rest: PsnrSummary,
    /// Of the cross-fades half way between slices; `None` for a single slice.
    pub midway: Option<PsnrSummary>,
}

impl PlacedSlices {
    /// Bytes of all pictures.
    pub fn bytes(&self) -> u64 {
        self.slices.iter().map(|slice| slice.webp.len() as u64).sum()
    }
}

/// Draws the slices of a stack, from the farthest to the nearest: each as far from the one before it as `spacing` and the error of their
/// cross-fade allow. `draw` draws the picture at a distance; all have one size.
///
/// # Errors
/// `draw` fails, the encoder refuses a picture, or the slices would take more than [`PlacementOptions::most_bytes`].
pub fn place_slices<E: From<WebPageError>>(
    spacing: &SliceSpacing,
    options: &PlacementOptions,
    mut draw: impl FnMut(f64) -> Result<ScreenPicture, E>,
) -> Result<PlacedSlices, E> {
    let farthest = spacing.range.farthest;
    let first = encode_picture(&draw(farthest)?, options.rest_psnr + GAIN_OF_WHOLE, USUAL_QUALITY)?;
    let mut placed = Placed::new(farthest, first, spacing.opening, options)?;
    for end in spacing.ends() {
        while placed.last.inverse_distance < end {
            let limit = spacing.next(placed.last.inverse_distance, end);
            placed.advance(limit, options, &mut draw)?;
        }
    }
    let no_distance = WebPageError::Inconsistent("a stack has no slice");
    Ok(PlacedSlices {
        at_rest: PsnrSummary::of(&placed.rest_psnrs).ok_or(no_distance)?,
        midway: PsnrSummary::of(&placed.midway_psnrs),
        slices: placed.slices,
    })
}

/// By how much whole slices are better than is asked, dB: with 0 or 2 dB, or two differences on each side, the demo takes more bytes.
const GAIN_OF_WHOLE: f64 = 1.0;
/// The share of the bytes of such a slice that it takes without the gain, about.
const SHARE_WITHOUT_GAIN: f64 = 0.86;
/// A longer step is tried where it is likely to be longer by this factor.
const WORTHWHILE: f64 = 1.15;
/// The share of the error allowed that a step aims at.
const AIM: f64 = 0.95;

/// A slice that may follow the last one.
struct Candidate {
    inverse_distance: f64,
    /// See [`Slice::base`].
    base: Option<usize>,
    encoded: EncodedPicture,
    picture: ScreenPicture,
    /// The picture half way to it.
    midway: ScreenPicture,
    /// Of the cross-fade there.
    midway_psnr: f64,
}

/// The slice that was placed last.
struct LastSlice {
    inverse_distance: f64,
    decoded: ScreenPicture,
    psnr: f64,
    quality: u8,
}

/// A whole slice that is to become the difference from the next one.
struct Pending {
    picture: ScreenPicture,
    /// The slice before it, decoded, and the picture half way from there.
    before: ScreenPicture,
    midway: ScreenPicture,
}

/// The slices that are placed.
struct Placed {
    /// The distance whose slice must be whole.
    opening: f64,
    slices: Vec<Slice>,
    bytes: u64,
    rest_psnrs: Vec<f64>,
    midway_psnrs: Vec<f64>,
    last: LastSlice,
    /// What the last slice is to become.
    pending: Option<Pending>,
}

impl Placed {
    fn new(
        inverse_distance: f64,
        first: EncodedPicture,
        opening: f64,
        options: &PlacementOptions,
    ) -> Result<Self, WebPageError> {
        let EncodedPicture { webp, psnr, quality, decoded } = first;
        let last = LastSlice { inverse_distance, decoded, psnr, quality };
        let (slices, rest_psnrs, midway_psnrs) = Default::default();
        let mut placed = Self { opening, slices, bytes: 0, rest_psnrs, midway_psnrs, last, pending: None };
        placed.push(Slice { inverse_distance, base: None, webp }, psnr, options)?;
        Ok(placed)
    }

    /// Whether the next slice, at a distance, is to become the difference from the one after it, if it is whole.
    fn may_become_difference(&self, inverse_distance: f64) -> bool {
        let follows_difference = self.slices.last().is_some_and(|last| last.base.is_some());
        follows_difference && self.pending.is_none() && inverse_distance != self.opening
    }

    fn keep(&mut self, mut best: Candidate, options: &PlacementOptions) -> Result<(), WebPageError> {
        let may_become_difference = self.may_become_difference(best.inverse_distance);
        let pending = self.pending.take();
        if let Some(pending) = &pending {
            self.make_difference(pending, &mut best, options)?;
        }
        let Candidate { inverse_distance, base, encoded, picture, midway, midway_psnr } = best;
        let EncodedPicture { webp, psnr, quality, decoded } = encoded;
        let before =
            std::mem::replace(&mut self.last, LastSlice { inverse_distance, decoded, psnr, quality });
        if may_become_difference && base.is_none() {
            self.pending = Some(Pending { picture, before: before.decoded, midway });
        }
        self.midway_psnrs.push(midway_psnr);
        self.push(Slice { inverse_distance, base, webp }, psnr, options)
    }

    /// Makes the last slice the difference from `next`, which follows it, unless it would be larger or worse.
    fn make_difference(
        &mut self,
        pending: &Pending,
        next: &mut Candidate,
        options: &PlacementOptions,
    ) -> Result<(), WebPageError> {
        let (min_psnr, whole) = (options.rest_psnr, &next.encoded.decoded);
        let difference = encode_difference(&pending.picture, whole, min_psnr, self.last.quality)?;
        let before = pending.before.cross_fade(&difference.decoded).psnr(&pending.midway);
        let after = difference.decoded.cross_fade(whole).psnr(&next.midway);
        let (last, next_index) = (self.slices.len() - 1, self.slices.len());
        let is_as_good = |psnr: f64, before: f64| psnr >= options.midway_psnr || psnr >= before;
        let saved = self.slices[last].webp.len().checked_sub(difference.webp.len());
        let (Some(saved), true) = (saved, difference.psnr >= min_psnr) else { return Ok(()) };
        if is_as_good(before, self.midway_psnrs[last - 1]) && is_as_good(after, next.midway_psnr) {
            self.bytes -= saved as u64;
            self.rest_psnrs[last] = difference.psnr;
            self.midway_psnrs[last - 1] = before;
            next.midway_psnr = after;
            let slice = &mut self.slices[last];
            (slice.base, slice.webp) = (Some(next_index), difference.webp);
        }
        Ok(())
    }

    fn push(&mut self, slice: Slice, psnr: f64, options: &PlacementOptions) -> Result<(), WebPageError> {
        self.bytes += slice.webp.len() as u64;
        if self.bytes > options.most_bytes {
            return Err(WebPageError::TooLarge);
        }
        self.rest_psnrs.push(psnr);
        self.slices.push(slice);
        Ok(())
    }

    /// How far the last two slices are apart, if there are two.
    fn last_step(&self) -> Option<f64> {
        let [before, last] = self.slices.last_chunk()?;
        Some(last.inverse_distance - before.inverse_distance)
    }

    /// Places the next slice, at most at `limit`: with the longest step whose cross-fade is good enough, roughly.
    fn advance<E: From<WebPageError>>(
        &mut self,
        limit: f64,
        options: &PlacementOptions,
        draw: &mut impl FnMut(f64) -> Result<ScreenPicture, E>,
    ) -> Result<(), E> {
        let start = self.last.inverse_distance;
        let longest = limit - start;
        let shortest = longest * options.shortest_step;
        let mut step = self.last_step().map_or(longest, |step| longest.min(step));
        let mut good: Option<Candidate> = None;
        let mut was_too_long = false;
        let best = loop {
            let is_between = start + step > start && start + step < limit;
            let distance = if is_between { start + step } else { limit };
            let candidate = self.candidate(distance, options, draw)?;
            let is_good = candidate.midway_psnr >= options.midway_psnr;
            if !is_good && let Some(good) = good.take() {
                break good;
            }
            let ideal = step * self.lengthening(&candidate, options);
            if !is_good && step > shortest {
                was_too_long = true;
                step = ideal.min(0.9 * step).max(shortest);
            } else if is_good && ideal > WORTHWHILE * step && is_between && !was_too_long {
                good = Some(candidate);
                step = ideal.min(longest);
            } else {
                break candidate;
            }
        };
        Ok(self.keep(best, options)?)
    }

    /// By what factor the step to a candidate is likely to become as long as is allowed. The error of a cross-fade is that of the coding,
    /// half of both slices' since they are independent, and what a Taylor series leaves after its linear part: its mean square grows as the
    /// fourth power of the step.
    fn lengthening(&self, candidate: &Candidate, options: &PlacementOptions) -> f64 {
        let [last, next] = [self.last.psnr, candidate.encoded.psnr].map(mean_square_of_psnr);
        let coding = 0.25 * (last + next);
        let beyond_coding =
            |psnr: f64, share: f64| (share * mean_square_of_psnr(psnr) - coding).max(1e-3 * coding);
        let allowed = beyond_coding(options.midway_psnr, AIM);
        (allowed / beyond_coding(candidate.midway_psnr, 1.0)).powf(0.25)
    }

    /// The slice at a distance beyond the last.
    fn candidate<E: From<WebPageError>>(
        &self,
        inverse_distance: f64,
        options: &PlacementOptions,
        draw: &mut impl FnMut(f64) -> Result<ScreenPicture, E>,
    ) -> Result<Candidate, E> {
        let picture = draw(inverse_distance)?;
        let (base, encoded) = self.encode(inverse_distance, &picture, options.rest_psnr)?;
        let midway = draw(self.last.inverse_distance.midpoint(inverse_distance))?;
        let midway_psnr = self.last.decoded.cross_fade(&encoded.decoded).psnr(&midway);
        Ok(Candidate { inverse_distance, base, encoded, picture, midway, midway_psnr })
    }

    /// The slice beyond the last, as the difference from that if it is whole and stays so: then its index comes with it. A slice that becomes
    /// a difference needs a whole one after it.
    fn encode(
        &self,
        inverse_distance: f64,
        picture: &ScreenPicture,
        min_psnr: f64,
    ) -> Result<(Option<usize>, EncodedPicture), WebPageError> {
        let last = self.slices.last().filter(|last| last.base.is_none() && self.pending.is_none());
        if let Some(last) = last.filter(|_| inverse_distance != self.opening) {
            let difference = encode_difference(picture, &self.last.decoded, min_psnr, self.last.quality)?;
            let whole_bytes = SHARE_WITHOUT_GAIN * last.webp.len() as f64;
            if difference.psnr >= min_psnr && (difference.webp.len() as f64) < whole_bytes {
                return Ok((Some(self.slices.len() - 1), difference));
            }
        }
        let gain = if self.may_become_difference(inverse_distance) { 0.0 } else { GAIN_OF_WHOLE };
        Ok((None, encode_picture(picture, min_psnr + gain, self.last.quality)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pixel_map::DistanceRange;

    const OPTIONS: PlacementOptions = PlacementOptions {
        rest_psnr: 45.0,
        midway_psnr: 42.0,
        shortest_step: 1.0 / 32.0,
        most_bytes: u64::MAX,
    };

    /// A bar whose brightness follows a function of the distance.
    fn bar(level: f64) -> ScreenPicture {
        let pixel = |k: u32| if (16..48).contains(&(k % 64)) { [level.round() as u8; 3] } else { [20; 3] };
        ScreenPicture::new([64, 32], (0..64 * 32).map(pixel).collect()).unwrap()
    }

    /// All distances from 0 to 1 by thousandths but those of a gap are sharp.
    fn sharp_but_in(gap: std::ops::Range<f64>) -> Vec<f64> {
        (0..=1000).map(|k| f64::from(k) / 1000.0).filter(|distance| !gap.contains(distance)).collect()
    }

    const UNIT: DistanceRange = DistanceRange { farthest: 0.0, nearest: 1.0 };

    fn distances(placed: &PlacedSlices) -> Vec<f64> {
        placed.slices.iter().map(|slice| slice.inverse_distance).collect()
    }

    #[test]
    fn whatever_is_sharp_is_within_reach_of_a_slice() {
        let sharp = sharp_but_in(0.4..0.8);
        let spacing = SliceSpacing { sharp: &sharp, range: UNIT, opening: 0.3, reach: 0.05 };
        // All pictures are equal: only what is sharp counts.
        let placed = place_slices(&spacing, &OPTIONS, |_| Ok::<_, WebPageError>(bar(100.0))).unwrap();
        let distances = distances(&placed);
        assert!(distances.windows(2).all(|pair| pair[0] < pair[1]), "{distances:?}");
        assert!([0.0, 0.3, 1.0].iter().all(|needed| distances.contains(needed)), "{distances:?}");
        let miss = |u: &f64| distances.iter().map(|d| (d - u).abs()).fold(f64::INFINITY, f64::min);
        assert!(sharp.iter().map(miss).fold(0.0, f64::max) <= 0.05 + 1e-12, "{distances:?}");
        let in_gap = distances.iter().filter(|d| (0.46..0.8).contains(*d)).count();
        assert!(in_gap == 0 && distances.len() <= 9, "{distances:?}");
        assert_eq!(spacing.least_slices(100), Some(distances.len()));
        assert_eq!(spacing.least_slices(5), None);
        assert_eq!(SliceSpacing { reach: 1e-300, ..spacing }.least_slices(100), None);
    }

    #[test]
    fn slices_gather_where_the_picture_bends() {
        // Linear up to 0.5, so that cross-fades are right; then bent.
        let level = |u: f64| 40.0 + 100.0 * u + if u > 0.5 { 400.0 * (u - 0.5).powi(2) } else { 0.0 };
        let draw = |u: f64| Ok::<_, WebPageError>(bar(level(u)));
        let spacing = SliceSpacing { sharp: &[], range: UNIT, opening: 0.5, reach: 0.1 };
        let placed = place_slices(&spacing, &OPTIONS, draw).unwrap();
        let many = distances(&placed);
        assert!(many.windows(2).all(|pair| pair[0] < pair[1]), "{many:?}");
        assert_eq!(many[..2], [0.0, 0.5], "{many:?}");
        assert!(many.len() > 4, "{many:?}");
        assert!(placed.at_rest.lowest >= 45.0 && placed.at_rest.mean >= placed.at_rest.lowest);
        let midway = placed.midway.unwrap();
        assert!(midway.lowest >= 42.0, "{midway:?}");
        let bases: Vec<_> = placed.slices.iter().map(|slice| slice.base).collect();
        let is_whole = |index: usize| bases[index].is_none();
        assert!(bases.iter().flatten().all(|&base| is_whole(base)), "{bases:?}");
        assert!(bases[1].is_none(), "the opening slice is whole: {bases:?}");
        assert_eq!(placed.bytes(), placed.slices.iter().map(|slice| slice.webp.len() as u64).sum::<u64>());

        let few = PlacementOptions { shortest_step: 1.0, ..OPTIONS };
        let coarse = place_slices(&spacing, &few, draw).unwrap();
        assert_eq!(distances(&coarse), [0.0, 0.5, 1.0]);
        assert!(coarse.midway.unwrap().lowest < 42.0, "the error is measured, not assumed");
    }

    #[test]
    fn steps_become_longer_where_the_picture_straightens() {
        // Bent up to 0.5, then linear.
        let level = |u: f64| 40.0 + 60.0 * u + if u < 0.5 { 500.0 * (u - 0.5).powi(2) } else { 0.0 };
        let draw = |u: f64| Ok::<_, WebPageError>(bar(level(u)));
        let spacing = SliceSpacing { sharp: &[], range: UNIT, opening: 1.0, reach: 0.1 };
        let placed = place_slices(&spacing, &OPTIONS, draw).unwrap();
        let steps: Vec<_> = distances(&placed).windows(2).map(|pair| pair[1] - pair[0]).collect();
        let [first, longest] = [steps[0], steps.iter().copied().fold(0.0, f64::max)];
        assert!(first < 0.2 && longest > 0.4, "{steps:?}");
    }

    #[test]
    fn limits_and_errors_end_it() {
        let options = PlacementOptions { most_bytes: 100, ..OPTIONS };
        let draw = |_| Ok::<_, WebPageError>(bar(100.0));
        let sharp = sharp_but_in(0.0..0.0);
        let spacing = SliceSpacing { sharp: &sharp, range: UNIT, opening: 0.3, reach: 0.1 };
        assert_eq!(place_slices(&spacing, &options, draw).unwrap_err(), WebPageError::TooLarge);
        let stopped = place_slices(&spacing, &OPTIONS, |_| Err(WebPageError::Size(0, 0)));
        assert_eq!(stopped.unwrap_err(), WebPageError::Size(0, 0));
        let range = DistanceRange { farthest: 0.5, nearest: 0.5 };
        let single = SliceSpacing { sharp: &[0.5], range, opening: 0.5, reach: 0.1 };
        let single = place_slices(&single, &OPTIONS, draw).unwrap();
        assert_eq!((single.slices.len(), single.midway), (1, None));
    }
}
