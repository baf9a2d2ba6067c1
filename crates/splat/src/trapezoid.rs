//! A box seen through a box: the one-dimensional profile of a splat.
//!
//! The cross section of a splat is the sample's footprint (a box) convolved with a run of the aperture (another box): a
//! trapezoid of unit mass. Neither width may be zero, but either may be as small as it likes.

/// Two boxes convolved, of unit mass.
#[derive(Clone, Copy, Debug)]
pub struct Trapezoid {
    /// Where the rising ramp starts.
    rise: f64,
    /// Where the falling ramp starts.
    fall: f64,
    /// Length of either ramp: the shorter box.
    ramp: f64,
}

impl Trapezoid {
    /// Boxes of half-widths `a` and `b` (one of them above 0) centred at `center`.
    pub fn new(center: f64, a: f64, b: f64) -> Self {
        let (long, short) = (2.0 * a.max(b), 2.0 * a.min(b));
        Self { rise: center - (long + short) / 2.0, fall: center + (long - short) / 2.0, ramp: short }
    }

    /// Height of its plateau, 1/length.
    pub fn height(&self) -> f64 {
        1.0 / (self.fall - self.rise)
    }

    /// The pixels that it touches: `first..end`.
    pub fn pixels(&self) -> std::ops::Range<i64> {
        self.rise.floor() as i64..(self.fall + self.ramp).ceil() as i64
    }

    /// Its integral over the pixel [i, i + 1].
    pub fn over_pixel(&self, i: i64) -> f64 {
        let x = i as f64;
        let integral =
            |start: f64| ramp_integral(x + 1.0 - start, self.ramp) - ramp_integral(x - start, self.ramp);
        (integral(self.rise) - integral(self.fall)) * self.height()
    }

    /// The rising edge as differences: tap k is how much more of a plateau of height 1 pixel `first + k` holds than the
    /// pixel before it. The taps sum to 1. Returns `first`.
    pub fn rising(&self, taps: &mut Taps) -> i64 {
        edge(self.rise, self.ramp, taps)
    }

    /// The falling edge, as [`Self::rising`].
    pub fn falling(&self, taps: &mut Taps) -> i64 {
        edge(self.fall, self.ramp, taps)
    }
}

/// Differences of an edge, in order of pixels.
#[derive(Clone, Debug)]
pub struct Taps {
    values: [f64; Self::MOST],
    count: usize,
}

impl Taps {
    /// Longest ramp, px, and the pixels at its ends. Footprints are at most 16 px and the shorter box is the ramp.
    const MOST: usize = 24;

    /// No taps yet.
    pub fn new() -> Self {
        Self { values: [0.0; Self::MOST], count: 0 }
    }

    /// The taps.
    pub fn as_slice(&self) -> &[f64] {
        &self.values[..self.count]
    }
}

fn edge(start: f64, ramp: f64, taps: &mut Taps) -> i64 {
    let first = start.floor();
    let count = ((start + ramp).floor() - first) as usize + 2;
    taps.count = count.min(Taps::MOST);
    let mut before = 0.0;
    let mut integral = 0.0;
    for (k, tap) in taps.values[..taps.count].iter_mut().enumerate() {
        let next = ramp_integral(first + k as f64 + 1.0 - start, ramp);
        let mean = next - integral;
        *tap = mean - before;
        (before, integral) = (mean, next);
    }
    first as i64
}

/// ∫ clamp(x/ramp, 0, 1): the integral of a ramp that starts at 0.
#[inline(always)]
fn ramp_integral(x: f64, ramp: f64) -> f64 {
    if x <= 0.0 {
        0.0
    } else if x < ramp {
        x * x / (2.0 * ramp)
    } else {
        x - ramp / 2.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn taps_add_up_to_the_profile() {
        for (center, a, b) in [
            (5.3, 0.5, 0.0),
            (5.5, 0.5, 0.0),
            (7.1, 0.5, 3.2),
            (9.0, 4.0, 0.125),
            (6.2, 1e-9, 0.4),
            (12.0, 4.0, 4.0),
        ] {
            let profile = Trapezoid::new(center, a, b);
            let mut differences = [0.0; 40];
            let mut taps = Taps::new();
            let first = profile.rising(&mut taps) as usize;
            taps.as_slice()
                .iter()
                .enumerate()
                .for_each(|(k, t)| differences[first + k] += t * profile.height());
            let first = profile.falling(&mut taps) as usize;
            taps.as_slice()
                .iter()
                .enumerate()
                .for_each(|(k, t)| differences[first + k] -= t * profile.height());
            let (mut value, mut total, mut moment) = (0.0, 0.0, 0.0);
            for (i, difference) in differences.iter().enumerate() {
                value += difference;
                assert!((value - profile.over_pixel(i as i64)).abs() < 1e-7, "{center} {a} {b} at {i}");
                total += value;
                moment += value * (i as f64 + 0.5);
            }
            assert!((total - 1.0).abs() < 1e-7, "{center} {a} {b}: {total}");
            // The mean is kept to within what sampling by pixels allows: exactly, for box-integrated profiles of ≥ 1 px.
            assert!((moment - center).abs() < 0.5 && profile.pixels().contains(&(center as i64)));
        }
    }
}
