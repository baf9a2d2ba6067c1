//! The image of the aperture that one sample throws on the picture.

use crate::accumulator::{Band, Rectangle};
use crate::kernel::{Kernel, Piece};
use glam::DVec2;
use salf::{Sample, Visibility};
use std::ops::Range;

/// A sample's aperture image: its footprint, thrown by every point of the aperture that it sees.
pub struct ApertureImage<'a> {
    /// The sample.
    pub sample: &'a Sample,
    /// The lens's aperture.
    pub kernel: &'a Kernel,
    /// Radius of the baked aperture's image, px; negative (turned by 180°) for near defocus.
    pub radius_px: f64,
}

/// A change of weight over the aperture, as a share of the weight, that is not followed.
const SMALLEST_TILT: f64 = 0.004;

impl ApertureImage<'_> {
    /// The pixel rows it may touch.
    pub fn rows(&self) -> Range<i64> {
        let center = self.sample.center.y as f64;
        let half = self.radius_px.abs() + self.sample.half_size.y as f64;
        (center - half).floor() as i64..(center + half).ceil() as i64 + 1
    }

    /// Adds (`sign` 1) it to a band, or takes it away (−1); `light` is the value of each channel.
    pub fn deposit<const C: usize>(&self, band: &mut Band<C>, light: &[f64; C], sign: i64) {
        let Self { sample, kernel, radius_px } = *self;
        let center = sample.center.as_dvec2();
        let footprint = sample.half_size.as_dvec2();
        let (weight, tilt) = (sample.weight as f64, sample.tilt.as_dvec2());
        let mut throw = |piece: Piece, weight: f64| {
            let rectangle = Rectangle {
                // Pixel rows go down, v goes up.
                center: center + piece.center * DVec2::new(radius_px, -radius_px),
                half_size: piece.half_size * radius_px.abs(),
                footprint,
            };
            let mass = weight * piece.share;
            band.deposit(&rectangle, &light.map(|value| value * mass), sign);
        };
        let weight_at = |u: DVec2| (weight + tilt.dot(u)).max(0.0);
        match &sample.visibility {
            Visibility::Cells(words) => {
                kernel.visible_pieces(words, radius_px, weight_at, |piece| throw(piece, 1.0));
            }
            Visibility::Open => {
                let change = tilt.abs().element_sum() / weight;
                if change < SMALLEST_TILT || radius_px.abs() < 0.5 {
                    kernel.pieces(radius_px, f64::INFINITY, |piece| throw(piece, weight));
                } else {
                    // Along a row the weight is followed in steps of an eighth of itself.
                    let longest = 0.125 * weight / tilt.x.abs();
                    kernel.pieces(radius_px, longest, |piece| throw(piece, weight_at(piece.center)));
                }
            }
        }
    }
}
