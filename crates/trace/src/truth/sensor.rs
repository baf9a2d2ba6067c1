//! The sensor: integer sums a pixel, so that their order does not matter.

use super::filter::ReconstructionFilter;
use super::options::Region;
use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicI64, Ordering};

/// Numbers to integers: round(x·2ᵉ).
#[derive(Clone, Copy, Debug)]
struct Quantiser {
    /// e of radiance.
    light: i32,
    /// e of coverage.
    coverage: i32,
}

/// Bits of an i64 that a sum may fill.
const SUM_BITS: i32 = 62;
/// A pixel's mean radiance is at first expected to stay below 2 to this.
const RADIANCE_BITS: i32 = 24;
/// And its mean coverage.
const COVERAGE_BITS: i32 = 16;
/// How many bits are given up when it does not.
const COARSER_BITS: i32 = 24;

impl Quantiser {
    /// For passes of `samples` samples a pixel with mean radiance up to 2²⁴: the step is 2⁻³³ at 32 samples,
    /// and every further bit of radiance that turns up costs a bit (see [`Self::coarser`]).
    fn for_samples(samples: u32) -> Self {
        let sample_bits = (u32::BITS - samples.leading_zeros()) as i32;
        let rest = SUM_BITS - sample_bits;
        Self { light: rest - RADIANCE_BITS, coverage: rest - COVERAGE_BITS }
    }

    /// For sums 2²⁴ times as large. Sums of any f32 radiances fit after a few of these.
    fn coarser(self) -> Self {
        Self { light: self.light - COARSER_BITS, coverage: self.coverage - COARSER_BITS }
    }
}

/// A sum of quantised samples: red, green, blue, the coverage of green, that of red and of blue.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Sum([i64; 6]);

impl Sum {
    /// Adds another sum. Saturates, which [`Sensor::add`] then sees as overflow.
    pub fn add(&mut self, other: Sum) {
        (0..6).for_each(|c| self.0[c] = self.0[c].saturating_add(other.0[c]));
    }
}

/// The region's pixels, written from all threads.
pub(super) struct Sensor {
    region: Region,
    filter: ReconstructionFilter,
    quantiser: Quantiser,
    /// Red, green, blue and coverage a pixel.
    pixels: Vec<[AtomicI64; 4]>,
    /// The coverage of red and blue a pixel, where it is not that of green.
    colours: Option<Vec<[AtomicI64; 2]>>,
    overflowed: AtomicBool,
}

impl Sensor {
    /// A black sensor for `region`, for at most `samples` samples a pixel in each pass.
    /// `has_fringe`: colours land apart, each with a coverage of its own.
    pub fn new(region: Region, filter: ReconstructionFilter, samples: u32, has_fringe: bool) -> Self {
        let mut pixels = Vec::new();
        pixels.resize_with(region.pixels(), Default::default);
        let colours = has_fringe.then(|| (0..region.pixels()).map(|_| Default::default()).collect());
        let quantiser = Quantiser::for_samples(samples);
        Self { region, filter, quantiser, pixels, colours, overflowed: AtomicBool::new(false) }
    }

    /// The rectangle of the picture, px, whose pixels it has.
    pub fn region(&self) -> Region {
        self.region
    }

    /// The positions of the frame where light counts, px: the region and as far around it as the filter reaches.
    pub fn window(&self) -> [DVec2; 2] {
        let Region { x, y, width, height } = self.region;
        let low = DVec2::new(f64::from(x), f64::from(y));
        let beyond = self.filter.radius() - 0.5;
        [low - beyond, low + DVec2::new(f64::from(width), f64::from(height)) + beyond]
    }

    /// Whether every sample belongs to the pixel that it lands in and to no other.
    pub fn is_own_pixel(&self) -> bool {
        self.filter.is_own_pixel()
    }

    /// The pixel at a position of the frame; `None` outside of the region, and for what is not a number.
    pub fn pixel(&self, position: DVec2) -> Option<usize> {
        let whole = position.floor();
        if whole.is_nan() { None } else { self.pixel_at(whole.x as i64, whole.y as i64) }
    }

    /// Whether light that lands at a position, px, counts for any pixel.
    pub fn covers(&self, position: DVec2) -> bool {
        let [low, high] = self.window();
        position.cmpge(low).all() && position.cmplt(high).all()
    }

    fn pixel_at(&self, column: i64, row: i64) -> Option<usize> {
        let Region { x, y, width, height } = self.region;
        let (column, row) = (column - i64::from(x), row - i64::from(y));
        let inside = (0..i64::from(width)).contains(&column) && (0..i64::from(height)).contains(&row);
        inside.then(|| row as usize * width as usize + column as usize)
    }

    /// The integers of a sample. Negative or undefined channels of `radiance` are 0, infinite ones the largest
    /// f32; `weight` ≥ 0 is what it weighs, in samples, and `coverage` how much of it covers in each colour.
    pub fn quantise(&self, radiance: Vec3, weight: f64, coverage: DVec3) -> Sum {
        let light = weight * f64::from(self.quantiser.light).exp2();
        let [r, g, b] =
            radiance.to_array().map(|c| (f64::from(c.clamp(0.0, f32::MAX)) * light).round() as i64);
        let scale = f64::from(self.quantiser.coverage).exp2();
        let [red, green, blue] = coverage.to_array().map(|share| (share * weight * scale).round() as i64);
        Sum([r, g, b, green, red, blue])
    }

    /// Adds a sample that lands at `position`, px, through the filter: linear RGB radiance times `weight`, and
    /// coverage.
    pub fn expose(&self, position: DVec2, radiance: Vec3, weight: f64, coverage: DVec3) {
        if self.is_own_pixel() {
            if let Some(pixel) = self.pixel(position) {
                self.add(pixel, self.quantise(radiance, weight, coverage));
            }
            return;
        }
        for (column, row, share) in self.filter.weights(position) {
            if let Some(pixel) = self.pixel_at(column, row) {
                self.add(pixel, self.quantise(radiance, weight * share, coverage));
            }
        }
    }

    /// Adds a sum to a pixel. All terms are 0 or more, so whether the total overflows does not depend on
    /// their order.
    pub fn add(&self, pixel: usize, sum: Sum) {
        let colours = self.colours.iter().flat_map(|colours| &colours[pixel]);
        for (total, term) in self.pixels[pixel].iter().chain(colours).zip(sum.0) {
            let before = total.fetch_add(term, Ordering::Relaxed);
            if before.checked_add(term).is_none_or(|after| after == i64::MAX) {
                self.overflowed.store(true, Ordering::Relaxed);
            }
        }
    }

    /// Makes the sensor black again.
    pub fn clear(&mut self) {
        self.pixels.par_iter_mut().for_each(|sums| *sums = Default::default());
        self.colours.iter_mut().flatten().for_each(|sums| *sums = Default::default());
        self.overflowed = AtomicBool::new(false);
    }

    /// If a sum has overflowed since it was black, counts in coarser steps from now on.
    pub fn coarsen_if_overflowed(&mut self) -> bool {
        let overflowed = *self.overflowed.get_mut();
        if overflowed {
            self.quantiser = self.quantiser.coarser();
        }
        overflowed
    }

    /// The mean of `samples` samples in every pixel, row by row: red, green, blue (linear), coverage.
    pub fn means(&self, samples: u32) -> impl IndexedParallelIterator<Item = [f64; 4]> + '_ {
        let step = |exponent: i32| f64::from(-exponent).exp2() / f64::from(samples);
        let (light, coverage) = (step(self.quantiser.light), step(self.quantiser.coverage));
        self.pixels.par_iter().map(move |sums| {
            let [r, g, b, covered] = sums.each_ref().map(|sum| sum.load(Ordering::Relaxed) as f64);
            [r * light, g * light, b * light, covered * coverage]
        })
    }

    /// The mean coverage of red and blue in every pixel; `None` where it is that of green.
    pub fn colour_means(&self, samples: u32) -> Option<impl IndexedParallelIterator<Item = [f64; 2]> + '_> {
        let step = f64::from(-self.quantiser.coverage).exp2() / f64::from(samples);
        let mean = move |sum: &AtomicI64| sum.load(Ordering::Relaxed) as f64 * step;
        let colours = self.colours.as_ref()?;
        Some(colours.par_iter().map(move |sums| sums.each_ref().map(mean)))
    }
}
