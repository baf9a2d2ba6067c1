//! Where the slices of a stack are placed: where the error is.
//!
//! Whatever can be sharp is nearly so at some slice: across distances at which nothing is, there are none yet. Half way between two
//! slices, their cross-fade is compared with the picture there; where it is not good enough, that picture becomes a slice, and both halves are
//! examined in turn.

use crate::encoding::{EncodedPicture, USUAL_QUALITY, encode_picture};
use crate::error::WebPageError;
use crate::page::Slice;
use crate::pixel_map::DistanceRange;
use crate::screen_picture::ScreenPicture;

/// How good the slices of a stack are to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacementOptions {
    /// Minimum PSNR of each slice against the picture at its distance, dB.
    pub rest_psnr: f64,
    /// PSNR that a cross-fade half way between two slices should have against the picture there, dB.
    pub midway_psnr: f64,
    /// How often a step may be halved. Cross-fades of steps this small are kept as they are.
    pub most_halvings: u32,
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

/// Reciprocal distances, ascending, of the slices that a stack needs before any error is measured: the ends of `range`, `opening` (in
/// it), and as few others as bring each of `sharp`, the ascending distances in the range at which something is sharp, within `reach` (> 0,
/// 1/length) of one. `None` if they are more than `most`.
pub fn slice_distances(
    sharp: &[f64],
    range: DistanceRange,
    opening: f64,
    reach: f64,
    most: usize,
) -> Option<Vec<f64>> {
    let mut distances = vec![range.farthest];
    let mut uncovered = sharp.iter().copied().peekable();
    for end in [opening, range.nearest] {
        while let Some(distance) = uncovered.next_if(|&distance| distance + reach < end) {
            if distances.last().is_none_or(|last| distance > last + reach) {
                distances.push(distance + reach);
            }
            if distances.len() > most {
                return None;
            }
        }
        if distances.last() != Some(&end) {
            distances.push(end);
        }
    }
    (distances.len() <= most).then_some(distances)
}

/// A slice that is still to be measured against its neighbour.
struct PendingSlice {
    inverse_distance: f64,
    /// Its picture, if it was drawn already.
    encoded: Option<EncodedPicture>,
    /// How often the step was halved that leads to it.
    halvings: u32,
}

/// Draws a stack with slices at `distances` (1/s, ascending, at least one) and wherever else a cross-fade asks for one. `draw` draws the
/// picture at a distance; all have one size.
///
/// # Errors
/// `draw` fails, the encoder refuses a picture, or the slices would take more than [`PlacementOptions::most_bytes`].
pub fn place_slices<E: From<WebPageError>>(
    distances: &[f64],
    options: &PlacementOptions,
    mut draw: impl FnMut(f64) -> Result<ScreenPicture, E>,
) -> Result<PlacedSlices, E> {
    let pending = |&inverse_distance| PendingSlice { inverse_distance, encoded: None, halvings: 0 };
    let mut pending: Vec<_> = distances.iter().rev().map(pending).collect();
    let mut placed = Placed::default();
    while let Some(next) = pending.pop() {
        let encoded = match next.encoded {
            Some(encoded) => encoded,
            None => placed.encode(&draw(next.inverse_distance)?, options)?,
        };
        let Some((last_distance, last)) = &placed.last else {
            placed.push(next.inverse_distance, encoded, options)?;
            continue;
        };
        let midway_distance = last_distance.midpoint(next.inverse_distance);
        let midway = draw(midway_distance)?;
        let psnr = last.cross_fade(&encoded.decoded).psnr(&midway);
        if psnr < options.midway_psnr && next.halvings < options.most_halvings {
            let halvings = next.halvings + 1;
            let middle = Some(placed.encode(&midway, options)?);
            pending.push(PendingSlice { encoded: Some(encoded), halvings, ..next });
            pending.push(PendingSlice { inverse_distance: midway_distance, encoded: middle, halvings });
            continue;
        }
        placed.midway_psnrs.push(psnr);
        placed.push(next.inverse_distance, encoded, options)?;
    }
    let no_distance = WebPageError::Inconsistent("a stack has no slice");
    Ok(PlacedSlices {
        at_rest: PsnrSummary::of(&placed.rest_psnrs).ok_or(no_distance)?,
        midway: PsnrSummary::of(&placed.midway_psnrs),
        slices: placed.slices,
    })
}

/// The slices that are placed.
#[derive(Default)]
struct Placed {
    slices: Vec<Slice>,
    bytes: u64,
    rest_psnrs: Vec<f64>,
    midway_psnrs: Vec<f64>,
    /// Distance and picture of the last one.
    last: Option<(f64, ScreenPicture)>,
    last_quality: Option<u8>,
}

impl Placed {
    fn encode(
        &mut self,
        picture: &ScreenPicture,
        options: &PlacementOptions,
    ) -> Result<EncodedPicture, WebPageError> {
        let encoded = encode_picture(picture, options.rest_psnr, self.last_quality.unwrap_or(USUAL_QUALITY))?;
        self.last_quality = Some(encoded.quality);
        Ok(encoded)
    }

    fn push(
        &mut self,
        inverse_distance: f64,
        encoded: EncodedPicture,
        options: &PlacementOptions,
    ) -> Result<(), WebPageError> {
        self.bytes += encoded.webp.len() as u64;
        if self.bytes > options.most_bytes {
            return Err(WebPageError::TooLarge);
        }
        self.rest_psnrs.push(encoded.psnr);
        self.slices.push(Slice { inverse_distance, webp: encoded.webp });
        self.last = Some((inverse_distance, encoded.decoded));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OPTIONS: PlacementOptions =
        PlacementOptions { rest_psnr: 45.0, midway_psnr: 42.0, most_halvings: 5, most_bytes: u64::MAX };

    /// A bar whose brightness follows a function of the distance.
    fn bar(level: f64) -> ScreenPicture {
        let pixel = |k: u32| if (16..48).contains(&(k % 64)) { [level.round() as u8; 3] } else { [20; 3] };
        ScreenPicture::new([64, 32], (0..64 * 32).map(pixel).collect()).unwrap()
    }

    #[test]
    fn whatever_is_sharp_is_within_reach_of_a_slice() {
        let range = DistanceRange { farthest: 0.0, nearest: 1.0 };
        let sharp: Vec<f64> =
            (0..=1000).map(|k| f64::from(k) / 1000.0).filter(|u| !(0.4..0.8).contains(u)).collect();
        let (opening, reach) = (0.3, 0.05);
        let distances = slice_distances(&sharp, range, opening, reach, 100).unwrap();
        assert!(distances.windows(2).all(|pair| pair[0] < pair[1]), "{distances:?}");
        assert!([0.0, opening, 1.0].iter().all(|needed| distances.contains(needed)), "{distances:?}");
        let miss = |u: &f64| distances.iter().map(|d| (d - u).abs()).fold(f64::INFINITY, f64::min);
        assert!(sharp.iter().map(miss).fold(0.0, f64::max) <= reach + 1e-12, "{distances:?}");
        let in_gap = distances.iter().filter(|d| (0.46..0.8).contains(*d)).count();
        assert!(in_gap == 0 && distances.len() <= 9, "{distances:?}");
        assert_eq!(slice_distances(&sharp, range, opening, reach, 5), None);
        assert_eq!(slice_distances(&sharp, range, opening, 1e-300, 100), None);
    }

    #[test]
    fn a_flat_range_has_one_slice_and_a_pinhole_three() {
        let flat = DistanceRange { farthest: 0.5, nearest: 0.5 };
        assert_eq!(slice_distances(&[0.5; 7], flat, 0.5, 0.1, 100).unwrap(), [0.5]);
        let range = DistanceRange { farthest: 0.0, nearest: 1.0 };
        assert_eq!(slice_distances(&[0.1, 0.7], range, 0.2, f64::INFINITY, 100).unwrap(), [0.0, 0.2, 1.0]);
        assert_eq!(slice_distances(&[], range, 1.0, 0.1, 100).unwrap(), [0.0, 1.0]);
    }

    #[test]
    fn slices_gather_where_the_picture_bends() {
        // Linear up to 0.5, so that cross-fades are right; then bent.
        let level = |u: f64| 40.0 + 100.0 * u + if u > 0.5 { 400.0 * (u - 0.5).powi(2) } else { 0.0 };
        let draw = |u: f64| Ok::<_, WebPageError>(bar(level(u)));
        let placed = place_slices(&[0.0, 0.5, 1.0], &OPTIONS, draw).unwrap();
        let distances: Vec<_> = placed.slices.iter().map(|slice| slice.inverse_distance).collect();
        assert!(distances.windows(2).all(|pair| pair[0] < pair[1]), "{distances:?}");
        assert_eq!(distances[..2], [0.0, 0.5], "{distances:?}");
        assert!(distances.len() > 4, "{distances:?}");
        assert!(placed.at_rest.lowest >= 45.0 && placed.at_rest.mean >= placed.at_rest.lowest);
        assert!(placed.midway.unwrap().lowest >= 42.0);
        assert_eq!(placed.bytes(), placed.slices.iter().map(|slice| slice.webp.len() as u64).sum::<u64>());

        let few = PlacementOptions { most_halvings: 0, ..OPTIONS };
        let coarse = place_slices(&[0.0, 0.5, 1.0], &few, draw).unwrap();
        assert_eq!(coarse.slices.len(), 3);
        assert!(coarse.midway.unwrap().lowest < 42.0, "the error is measured, not assumed");
    }

    #[test]
    fn limits_and_errors_end_it() {
        let options = PlacementOptions { most_bytes: 100, ..OPTIONS };
        let draw = |_| Ok::<_, WebPageError>(bar(100.0));
        let distances = [0.0, 0.2, 0.4, 0.6];
        assert_eq!(place_slices(&distances, &options, draw).unwrap_err(), WebPageError::TooLarge);
        let stopped = place_slices(&distances, &OPTIONS, |_| Err(WebPageError::Size(0, 0)));
        assert_eq!(stopped.unwrap_err(), WebPageError::Size(0, 0));
        let single = place_slices(&[0.5], &OPTIONS, draw).unwrap();
        assert_eq!((single.slices.len(), single.midway), (1, None));
    }
}
