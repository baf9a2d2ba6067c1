//! The sensor: integer sums a pixel, so that their order does not matter.

use glam::{DVec2, Vec3};
use lens::{Camera, Picture};
use std::sync::atomic::{AtomicBool, AtomicI64, Ordering};

/// Radiance to integers: round(L·2ᵉ).
#[derive(Clone, Copy, Debug)]
pub(super) struct Quantiser {
    exponent: i32,
}

/// Bits of an i64 that a sum may fill.
const SUM_BITS: i32 = 62;
/// A pixel's mean radiance is at first expected to stay below 2 to this.
const RADIANCE_BITS: i32 = 24;
/// How many bits are given up when it does not.
const COARSER_BITS: i32 = 24;

impl Quantiser {
    /// For `samples` samples a pixel of mean radiance up to 2²⁴: the step is 2⁻²⁸ at 1024 samples, and every
    /// further bit of radiance that turns up costs a bit (see [`Self::coarser`]).
    pub fn for_samples(samples: u32) -> Self {
        let sample_bits = (u32::BITS - samples.leading_zeros()) as i32;
        Self { exponent: SUM_BITS - RADIANCE_BITS - sample_bits }
    }

    /// For radiance 2²⁴ times as large. Sums of any f32 radiances fit after a few of these.
    pub fn coarser(self) -> Self {
        Self { exponent: self.exponent - COARSER_BITS }
    }

    fn scale(self) -> f64 {
        f64::from(self.exponent).exp2()
    }
}

/// A sum of quantised samples.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sum {
    light: [i64; 3],
    count: i64,
}

impl Sum {
    /// One sample.
    pub fn of(light: [i64; 3]) -> Self {
        Self { light, count: 1 }
    }

    /// Light that comes without a sample of the camera.
    pub fn of_light(light: [i64; 3]) -> Self {
        Self { light, count: 0 }
    }

    /// Adds one sample. Saturates, which [`Sensor::add`] then sees as overflow.
    pub fn add(&mut self, light: [i64; 3]) {
        (0..3).for_each(|c| self.light[c] = self.light[c].saturating_add(light[c]));
        self.count += 1;
    }
}

/// The frame's pixels, written from all threads.
pub(super) struct Sensor {
    width: u32,
    height: u32,
    quantiser: Quantiser,
    /// Red, green, blue and count a pixel.
    pixels: Vec<[AtomicI64; 4]>,
    overflowed: AtomicBool,
}

impl Sensor {
    pub fn new(camera: &Camera, quantiser: Quantiser) -> Self {
        let mut pixels = Vec::new();
        pixels.resize_with(camera.width as usize * camera.height as usize, Default::default);
        Self {
            width: camera.width,
            height: camera.height,
            quantiser,
            pixels,
            overflowed: AtomicBool::new(false),
        }
    }

    /// Width and height, px.
    pub fn size(&self) -> (i64, i64) {
        (i64::from(self.width), i64::from(self.height))
    }

    /// The pixel at a position of the frame; `None` outside of it.
    pub fn pixel(&self, position: DVec2) -> Option<usize> {
        let inside = position.x >= 0.0
            && position.y >= 0.0
            && position.x < f64::from(self.width)
            && position.y < f64::from(self.height);
        inside.then(|| position.y as usize * self.width as usize + position.x as usize)
    }

    /// Whether a position is in the frame or at most `band` px outside of it.
    pub fn is_within(&self, position: DVec2, band: f64) -> bool {
        let size = DVec2::new(f64::from(self.width), f64::from(self.height));
        position.cmpge(DVec2::splat(-band)).all() && position.cmplt(size + band).all()
    }

    /// The integers of a radiance. Negative or undefined channels are 0, infinite ones the largest f32.
    pub fn quantise(&self, radiance: Vec3) -> [i64; 3] {
        let scale = self.quantiser.scale();
        radiance.to_array().map(|c| (f64::from(c.clamp(0.0, f32::MAX)) * scale).round() as i64)
    }

    /// Adds a sum to a pixel. All terms are 0 or more, so whether the total overflows does not depend on
    /// their order.
    pub fn add(&self, pixel: usize, sum: Sum) {
        let terms = [sum.light[0], sum.light[1], sum.light[2], sum.count];
        for (total, term) in self.pixels[pixel].iter().zip(terms) {
            let before = total.fetch_add(term, Ordering::Relaxed);
            if before.checked_add(term).is_none_or(|after| after == i64::MAX) {
                self.overflowed.store(true, Ordering::Relaxed);
            }
        }
    }

    /// The picture of `samples` samples a pixel; `None` if a sum overflowed.
    pub fn develop(&self, samples: u32) -> Option<Picture> {
        if self.overflowed.load(Ordering::Relaxed) {
            return None;
        }
        let mut picture = Picture::black(self.width, self.height);
        let light = 1.0 / (self.quantiser.scale() * f64::from(samples));
        for (k, sums) in self.pixels.iter().enumerate() {
            let [r, g, b, count] = sums.each_ref().map(|sum| sum.load(Ordering::Relaxed) as f64);
            picture.radiance[k] = [r, g, b].map(|sum| (sum * light) as f32);
            picture.coverage[k] = (count / f64::from(samples)) as f32;
        }
        Some(picture)
    }
}
